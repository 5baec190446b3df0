// DAQP beside our active-set method. For library_bench alone.
#ifndef MJCF_PDG_BENCH_LIBRARY_QUADRATIC_PROGRAM_H_
#define MJCF_PDG_BENCH_LIBRARY_QUADRATIC_PROGRAM_H_

#include <Eigen/Dense>

namespace mjcf_pdg::bench {

// min ½‖y + z‖² subject to Gᵀz >= -gap (lcp.h without elasticity).
struct QpOutcome {
  bool built = false;   // the library is there
  bool solved = false;  // false: infeasible, or given up
  double seconds = 0.0, setup_seconds = 0.0;
  Eigen::VectorXd z;
};
QpOutcome SolveByDaqp(const Eigen::MatrixXd& G, const Eigen::VectorXd& y,
                      const Eigen::VectorXd& gap);

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_LIBRARY_QUADRATIC_PROGRAM_H_
