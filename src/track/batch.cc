// Many rows: over several solvers, or as the frames of a trajectory, told in order.
#include <algorithm>
#include <string>
#include <vector>

#include "base/in_order.h"
#include "mjcf_pdg/pdg.h"
#include "mjcf_pdg/trajectory.h"
#include "track/frame_solver.h"
#include "track/smoother.h"

namespace mjcf_pdg {
namespace {

struct Row {
  std::size_t index = 0;
  Result result;
};

using Done = std::function<bool(std::size_t, const Result&)>;

// How many rows `q` has. A bad one is told before any work.
std::size_t CountRows(const Scene& scene, std::span<const double> q) {
  const auto nq = static_cast<std::size_t>(scene.nq());
  if (q.size() % nq != 0) {
    throw Error("the rows have " + std::to_string(q.size()) + " values, no multiple of the " +
                std::to_string(nq) + " that the model needs");
  }
  const std::size_t rows = q.size() / nq;
  for (std::size_t row = 0; row < rows; ++row) {
    try {
      scene.CheckConfiguration(q.subspan(row * nq, nq));
    } catch (const Error& error) {
      throw Error("row " + std::to_string(row) + ": " + error.what());
    }
  }
  return rows;
}

void SolveOneByOne(FrameSolver& solver, const std::vector<Frame>& frames,
                   const std::function<bool()>& go_on, const Done& done) {
  Result result;
  for (std::size_t k = 0; k < frames.size() && go_on(); ++k) {
    solver.Solve(frames[k], result);
    if (!done(k, result)) return;
  }
}

}  // namespace

void SolveTrajectory(const Scene& scene, const TrajectoryOptions& options,
                     std::span<const double> q, const Done& done) {
  Options of_frames = options.options;
  of_frames.trajectory = true;
  const std::size_t rows = CountRows(scene, q), nq = static_cast<std::size_t>(scene.nq());
  std::vector<Frame> frames(rows);
  for (std::size_t k = 0; k < rows; ++k) {
    const auto row = q.subspan(k * nq, nq);
    frames[k] = {{row.begin(), row.end()}, {of_frames.mocap_pos, of_frames.mocap_quat}};
  }
  const std::function<bool()> go_on = options.go_on ? options.go_on : [] { return true; };
  CheckSmooth(options.smooth, of_frames);
  if (options.smooth == 0.0) {
    FrameSolver solver(scene, of_frames);
    return SolveOneByOne(solver, frames, go_on, done);
  }
  std::vector<Result> results;
  Smoother smoother(scene, of_frames, options.smooth, frames);
  if (!smoother.Run(go_on, results)) return;
  for (std::size_t k = 0; k < rows && done(k, results[k]); ++k) continue;
}

void SolveBatch(const Scene& scene, const Options& options, std::span<const double> q, int threads,
                const Done& done) {
  if (threads < 1) throw Error("the number of threads must be at least 1");
  if (options.trajectory) return SolveTrajectory(scene, {.options = options}, q, done);
  const std::size_t rows = CountRows(scene, q), nq = static_cast<std::size_t>(scene.nq());
  const std::size_t count = std::clamp<std::size_t>(rows, 1, static_cast<std::size_t>(threads));
  std::vector<Solver> solvers;  // made here: what they refuse is told before any row
  for (std::size_t t = 0; t < count; ++t) solvers.emplace_back(scene, options);
  std::size_t next = 0;
  const auto take = [&](Row& row) {
    row.index = next;
    return next++ < rows;
  };
  const auto work = [&](std::size_t thread, Row& row) {
    solvers[thread].Solve(q.subspan(row.index * nq, nq), row.result);
  };
  const auto tell = [&](std::size_t index, const Row& row) { return done(index, row.result); };
  InOrder<Row>(count).Run(take, work, tell);
}

}  // namespace mjcf_pdg
