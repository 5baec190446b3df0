#include "apps/solve/solve_rows.h"

#include <utility>
#include <vector>

#include "apps/console/interrupt.h"
#include "base/in_order.h"
#include "track/frame_solver.h"
#include "track/smoother.h"

namespace mjcf_pdg::app {
namespace {

Frame FrameOf(const Configuration& row) { return {row.q, {row.mocap_pos, row.mocap_quat}}; }

// Frames of a trajectory follow each other.
void SolveFrames(const Scene& scene, const Options& options, const NextRow& next,
                 const TellRow& tell) {
  FrameSolver solver(scene, options);
  SolvedRow item;
  while (!Interrupted() && next(item.row)) {
    solver.Solve(FrameOf(item.row), item.result);
    tell(item);
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
  for (std::size_t k = 0; k < rows.size(); ++k) {
    tell({std::move(rows[k]), std::move(results[k]), {}});
  }
}

}  // namespace

void Watch(SolvedRow*& solved, Solver& solver) {
  solver.SetObserver([&solved](const Iteration& it) {
    solved->iterations.push_back({it.start,
                                  it.descent,
                                  it.step,
                                  {it.q.begin(), it.q.end()},
                                  it.sigma,
                                  it.violation,
                                  it.free,
                                  {it.rows.begin(), it.rows.end()}});
  });
}

void SolveRows(const Scene& scene, const RowOptions& how, const NextRow& next,
               const TellRow& tell) {
  if (how.smooth > 0.0) return SolveTogether(scene, how, next, tell);
  if (how.options.trajectory) return SolveFrames(scene, how.options, next, tell);
  std::vector<Solver> solvers;  // made here: what they refuse is told before any row
  std::vector<SolvedRow*> current(how.threads);
  for (std::size_t t = 0; t < how.threads; ++t) {
    solvers.emplace_back(scene, how.options);
    if (how.watched) Watch(current[t], solvers[t]);
  }
  InOrder<SolvedRow>(how.threads)
      .Run([&](SolvedRow& item) { return !Interrupted() && next(item.row); },
           [&](std::size_t thread, SolvedRow& item) {
             current[thread] = &item;
             item.iterations.clear();
             solvers[thread].SetMocap(item.row.mocap_pos, item.row.mocap_quat);
             solvers[thread].Solve(item.row.q, item.result);
           },
           [&](std::size_t, const SolvedRow& item) {
             tell(item);
             return true;
           });
}

}  // namespace mjcf_pdg::app
