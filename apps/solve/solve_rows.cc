#include "apps/solve/solve_rows.h"

#include <utility>
#include <vector>

#include "apps/console/interrupt.h"
#include "base/in_order.h"
#include "track/frame_solver.h"
#include "track/smoother.h"

namespace mjcf_pdg::app {
namespace {

struct Item {
  Configuration row;
  Result result;
};

Frame FrameOf(const Configuration& row) { return {row.q, {row.mocap_pos, row.mocap_quat}}; }

// Frames of a trajectory follow each other.
void SolveFrames(const Scene& scene, const Options& options, const NextRow& next,
                 const TellRow& tell) {
  FrameSolver solver(scene, options);
  Item item;
  while (!Interrupted() && next(item.row)) {
    solver.Solve(FrameOf(item.row), item.result);
    tell(item.row, item.result);
  }
}

// All frames are read before the first is told.
void SolveTogether(const Scene& scene, const RowOptions& how, const NextRow& next,
                   const TellRow& tell) {
  std::vector<Configuration> rows;
  std::vector<Frame> frames;
  for (Configuration row; !Interrupted() && next(row); row = {}) {
    frames.push_back(FrameOf(row));
    rows.push_back(std::move(row));
  }
  std::vector<Result> results;
  if (!Smoother(scene, how.options, how.smooth, frames).Run([] { return !Interrupted(); }, results))
    return;
  for (std::size_t k = 0; k < rows.size(); ++k) tell(rows[k], results[k]);
}

}  // namespace

void SolveRows(const Scene& scene, const RowOptions& how, const NextRow& next,
               const TellRow& tell) {
  if (how.smooth > 0.0) return SolveTogether(scene, how, next, tell);
  if (how.options.trajectory) return SolveFrames(scene, how.options, next, tell);
  std::vector<Solver> solvers;  // made here: what they refuse is told before any row
  for (std::size_t t = 0; t < how.threads; ++t) solvers.emplace_back(scene, how.options);
  InOrder<Item>(how.threads)
      .Run([&](Item& item) { return !Interrupted() && next(item.row); },
           [&](std::size_t thread, Item& item) {
             solvers[thread].SetMocap(item.row.mocap_pos, item.row.mocap_quat);
             solvers[thread].Solve(item.row.q, item.result);
           },
           [&](std::size_t, const Item& item) {
             tell(item.row, item.result);
             return true;
           });
}

}  // namespace mjcf_pdg::app
