// The quadratic program of a step solved by DAQP, which library_bench compares with our active-set
// method.
#ifndef MJCF_PDG_BENCH_LIBRARY_QUADRATIC_PROGRAM_H_
#define MJCF_PDG_BENCH_LIBRARY_QUADRATIC_PROGRAM_H_

#include <Eigen/Dense>

namespace mjcf_pdg::bench {

struct QpOutcome {
  bool built = false;   // this program was built with DAQP; if not, nothing else is set
  bool solved = false;  // false: infeasible, or given up
  double seconds = 0.0, setup_seconds = 0.0;  // of solving, and of setting up before that [s]
  Eigen::VectorXd z;                          // n entries
};
// Minimizes ½‖y + z‖² subject to Gᵀz >= -gap: the problem of optimize/lcp.h with no elastic rows. G
// is n × m, y has n entries, gap has m.
QpOutcome SolveByDaqp(const Eigen::MatrixXd& G, const Eigen::VectorXd& y,
                      const Eigen::VectorXd& gap);

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_LIBRARY_QUADRATIC_PROGRAM_H_
