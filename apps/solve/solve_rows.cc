#include "apps/solve/solve_rows.h"

#include <vector>

#include "apps/console/interrupt.h"
#include "base/in_order.h"

namespace mjcf_pdg::app {
namespace {

struct Item {
  Configuration row;
  Result result;
};

}  // namespace

void SolveRows(const Scene& scene, const Options& options, std::size_t threads, const NextRow& next,
               const std::function<void(const Configuration&, const Result&)>& tell) {
  // Frames of a trajectory follow each other.
  const std::size_t count = options.trajectory ? 1 : threads;
  std::vector<Solver> solvers;  // made here: what they refuse is told before any row
  for (std::size_t t = 0; t < count; ++t) solvers.emplace_back(scene, options);
  InOrder<Item>(count).Run([&](Item& item) { return !Interrupted() && next(item.row); },
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
