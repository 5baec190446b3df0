#include "library/quadratic_program.h"

#ifdef MJCF_PDG_HAVE_DAQP
#include <daqp/api.h>

#include <vector>
#endif

namespace mjcf_pdg::bench {

#ifdef MJCF_PDG_HAVE_DAQP

QpOutcome SolveByDaqp(const Eigen::MatrixXd& G, const Eigen::VectorXd& y,
                      const Eigen::VectorXd& gap) {
  const int n = static_cast<int>(G.rows()), m = static_cast<int>(G.cols());
  Eigen::MatrixXd H = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd A = G;  // the columns of G are the rows of DAQP's matrix, which is row-major
  Eigen::VectorXd f = y, lower = -gap, upper = Eigen::VectorXd::Constant(m, 1e30);
  std::vector<int> sense(m, 0);
  DAQPProblem problem{};
  problem.n = n;
  problem.m = m;
  problem.H = H.data();
  problem.f = f.data();
  problem.A = A.data();
  problem.bupper = upper.data();
  problem.blower = lower.data();
  problem.sense = sense.data();
  DAQPSettings settings;
  daqp_default_settings(&settings);
  QpOutcome outcome;
  outcome.built = true;
  outcome.z.resize(n);
  Eigen::VectorXd multipliers(m);
  DAQPResult result{};
  result.x = outcome.z.data();
  result.lam = multipliers.data();
  daqp_quadprog(&result, &problem, &settings);
  outcome.solved = result.exitflag > 0;
  outcome.seconds = result.solve_time;
  outcome.setup_seconds = result.setup_time;
  return outcome;
}

#else

QpOutcome SolveByDaqp(const Eigen::MatrixXd&, const Eigen::VectorXd&, const Eigen::VectorXd&) {
  return {};
}

#endif

}  // namespace mjcf_pdg::bench
