#include "apps/solve_rows.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>

#include "apps/progress.h"

namespace mjcf_pdg::app {
namespace {

// One thread's solver, made again only when a row puts the mocap bodies somewhere else.
class Worker {
 public:
  Worker(const Scene& scene, const Options& options) : scene_(scene), options_(options) {}

  Result Solve(const Configuration& row) {
    const bool moved = options_.mocap_pos != row.mocap_pos || options_.mocap_quat != row.mocap_quat;
    if (!solver_ || moved) {
      options_ = WithMocap(options_, row);
      solver_ = std::make_unique<Solver>(scene_, options_);
    }
    return solver_->Solve(row.q);
  }

 private:
  const Scene& scene_;
  Options options_;
  std::unique_ptr<Solver> solver_;
};

}  // namespace

Options WithMocap(const Options& options, const Configuration& row) {
  Options with = options;
  with.mocap_pos = row.mocap_pos;
  with.mocap_quat = row.mocap_quat;
  return with;
}

std::vector<Result> SolveRows(const Scene& scene, const Options& options,
                              const std::vector<Configuration>& rows, std::size_t threads) {
  std::vector<Result> results(rows.size());
  Progress progress("solving", rows.size());
  std::atomic<std::size_t> next{0};
  std::mutex failure_mutex;
  std::exception_ptr failure;
  auto work = [&] {
    try {
      Worker worker(scene, options);
      for (std::size_t i = next++; i < rows.size(); i = next++) {
        results[i] = worker.Solve(rows[i]);
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
    // Frames of a trajectory follow each other.
    const std::size_t count = options.trajectory ? 1 : std::min(threads, rows.size());
    for (std::size_t t = 1; t < count; ++t) others.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
  return results;
}

}  // namespace mjcf_pdg::app
