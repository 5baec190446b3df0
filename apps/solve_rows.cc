#include "apps/solve_rows.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>

#include "apps/progress.h"

namespace mjcf_pdg::app {

std::vector<Result> SolveRows(const Scene& scene, const Options& options,
                              const std::vector<Configuration>& rows, std::size_t threads) {
  std::vector<Result> results(rows.size());
  Progress progress("solving", rows.size());
  std::atomic<std::size_t> next{0};
  std::mutex failure_mutex;
  std::exception_ptr failure;
  auto work = [&] {
    try {
      Solver solver(scene, options);
      for (std::size_t i = next++; i < rows.size(); i = next++) {
        solver.SetMocap(rows[i].mocap_pos, rows[i].mocap_quat);
        results[i] = solver.Solve(rows[i].q);
        progress.Step();
      }
    } catch (...) {
      const std::lock_guard<std::mutex> lock(failure_mutex);
      if (!failure) failure = std::current_exception();
      next = rows.size();
    }
  };
  {
    std::vector<std::jthread> others;
    // The frames of a trajectory have to be solved one after the other, by one solver.
    const std::size_t count = options.trajectory ? 1 : std::min(threads, rows.size());
    for (std::size_t t = 1; t < count; ++t) others.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
  return results;
}

}  // namespace mjcf_pdg::app
