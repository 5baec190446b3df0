// Many rows over several solvers, told in order.
#include <algorithm>
#include <string>
#include <vector>

#include "base/in_order.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg {
namespace {

struct Row {
  std::size_t index = 0;
  Result result;
};

}  // namespace

void SolveBatch(const Scene& scene, const Options& options, std::span<const double> q, int threads,
                const std::function<bool(std::size_t, const Result&)>& done) {
  const auto nq = static_cast<std::size_t>(scene.nq());
  if (threads < 1) throw Error("the number of threads must be at least 1");
  if (q.size() % nq != 0) {
    throw Error("the rows have " + std::to_string(q.size()) + " values, no multiple of the " +
                std::to_string(nq) + " that the model needs");
  }
  const std::size_t rows = q.size() / nq;
  for (std::size_t row = 0; row < rows; ++row) {  // a bad row is told before any work
    try {
      scene.CheckConfiguration(q.subspan(row * nq, nq));
    } catch (const Error& error) {
      throw Error("row " + std::to_string(row) + ": " + error.what());
    }
  }
  // Frames of a trajectory follow each other.
  const std::size_t wanted = options.trajectory ? 1 : static_cast<std::size_t>(threads);
  const std::size_t count = std::max<std::size_t>(1, std::min(wanted, rows));
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
