// Solves rows over several threads as they come, told in order.
#ifndef MJCF_PDG_APPS_SOLVE_SOLVE_ROWS_H_
#define MJCF_PDG_APPS_SOLVE_SOLVE_ROWS_H_

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "apps/input/configurations.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {

// Fills in the next row; false if there is none.
using NextRow = std::function<bool(Configuration&)>;

// An Iteration (mjcf_pdg/observer.h) that is kept.
struct KeptIteration {
  std::string start;
  int descent = 0, step = 0;
  std::vector<double> q;
  double sigma = 0.0, violation = 0.0;
  bool free = false;
  std::vector<ObservedRow> rows;
};

struct SolvedRow {
  Configuration row;
  Result result;
  std::vector<KeptIteration> iterations;  // with RowOptions::watched, but not of a trajectory
};

// Is given each row with its result.
using TellRow = std::function<void(const SolvedRow&)>;

struct RowOptions {
  const Options& options;
  std::size_t threads = 1;
  double smooth = 0.0;   // TrajectoryOptions::smooth
  bool watched = false;  // fills SolvedRow::iterations
};

// Solves the rows that `next` gives, over `threads` solvers (one for frames of a trajectory).
// `tell` is called in the order of the rows. Both are called by one thread at a time. Ends between
// two rows when interrupted, or when `next` throws: rows before are told, then it is thrown on.
// With RowOptions::smooth a row is told when all are solved; where that is interrupted, or a row is
// bad, none is.
void SolveRows(const Scene& scene, const RowOptions& how, const NextRow& next, const TellRow& tell);

// Lets `solver` append the iterations of its solves to those of `*solved`, which may change from
// solve to solve. Both must outlive that.
void Watch(SolvedRow*& solved, Solver& solver);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_SOLVE_SOLVE_ROWS_H_
