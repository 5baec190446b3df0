// Many rows over several solvers, told in order.
#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg {
namespace {

// Results per thread that may wait for a slow row before them: enough that one row a hundred times
// slower than the others stops nobody, little enough to hold in memory.
constexpr std::size_t kWaitingPerThread = 128;

// What the threads share. Row k is solved into slot k modulo the number of slots.
class Batch {
 public:
  Batch(std::size_t rows, std::size_t threads,
        const std::function<bool(std::size_t, const Result&)>& done)
      : rows_(rows), slots_(kWaitingPerThread * threads), ready_(slots_.size(), 0), done_(done) {}

  // The next row to solve, false if there is none; waits while its slot is taken.
  bool Take(std::size_t& row) {
    std::unique_lock<std::mutex> lock(mutex_);
    wait_.wait(lock, [this] { return ended_ || next_ == rows_ || next_ < told_ + slots_.size(); });
    if (ended_ || next_ == rows_) return false;
    row = next_++;
    return true;
  }

  Result& Slot(std::size_t row) { return slots_[row % slots_.size()]; }

  // The row is solved: tells it and those that waited for it, unless another thread is telling.
  void Finish(std::size_t row) {
    std::unique_lock<std::mutex> lock(mutex_);
    ready_[row % slots_.size()] = 1;
    if (telling_) return;
    telling_ = true;
    while (!ended_ && told_ < rows_ && ready_[told_ % slots_.size()]) {
      const std::size_t telling = told_;
      lock.unlock();
      const bool goes_on = Tell(telling);
      lock.lock();
      ready_[telling % slots_.size()] = 0;
      ++told_;
      ended_ |= !goes_on;
      wait_.notify_all();
    }
    telling_ = false;
  }

  void Fail(std::exception_ptr failure) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!failure_) failure_ = failure;
    ended_ = true;
    wait_.notify_all();
  }

  void RethrowFailure() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  bool Tell(std::size_t row) {
    try {
      return done_(row, Slot(row));
    } catch (...) {
      Fail(std::current_exception());
      return false;
    }
  }

  const std::size_t rows_;
  std::vector<Result> slots_;
  std::vector<char> ready_;
  const std::function<bool(std::size_t, const Result&)>& done_;
  std::mutex mutex_;
  std::condition_variable wait_;
  std::size_t next_ = 0, told_ = 0;
  bool telling_ = false, ended_ = false;
  std::exception_ptr failure_;
};

void SolveRows(Solver& solver, std::span<const double> q, std::size_t nq, Batch& batch) {
  std::size_t row = 0;
  try {
    while (batch.Take(row)) {
      solver.Solve(q.subspan(row * nq, nq), batch.Slot(row));
      batch.Finish(row);
    }
  } catch (...) {
    batch.Fail(std::current_exception());
  }
}

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
  Batch batch(rows, count, done);
  {
    std::vector<std::jthread> others;
    for (std::size_t t = 1; t < count; ++t) {
      others.emplace_back([&, t] { SolveRows(solvers[t], q, nq, batch); });
    }
    SolveRows(solvers[0], q, nq, batch);
  }
  batch.RethrowFailure();
}

}  // namespace mjcf_pdg
