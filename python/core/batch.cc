// Many configurations over several threads, while Python hears Ctrl-C and shows progress.
#include "batch.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "answers.h"
#include "arrays.h"
#include "library_call.h"
#include "mjcf_pdg/pdg.h"
#include "mjcf_pdg/trajectory.h"
#include "model.h"
#include "options.h"

namespace mjcf_pdg::python {
namespace {

// How often Python is asked whether Ctrl-C was pressed.
constexpr auto kAttention = std::chrono::milliseconds(50);

// The fields of all results, row by row.
class Columns {
 public:
  Columns(std::size_t rows, std::size_t nq) : rows_(rows), nq_(nq) {
    q_.resize(rows * nq);
    for (auto* column : {&sigma_, &rms_, &sigma_lower_bound_, &depth_in_, &min_distance_,
                         &limit_excess_in_, &equality_residual_in_, &equality_residual_,
                         &tendon_excess_in_, &tendon_excess_, &seconds_}) {
      column->resize(rows);
    }
    for (auto* column : {&iterations_, &queries_}) column->resize(rows);
    for (auto* column : {&certified_, &proven_}) column->resize(rows);
    for (auto* column : {&status_, &start_, &cause_, &reason_}) column->resize(rows);
  }

  void Set(std::size_t row, const Result& result) {
    std::copy(result.q.begin(), result.q.end(),
              q_.begin() + static_cast<std::ptrdiff_t>(row * nq_));
    status_[row] = NameOf(result.status);
    sigma_[row] = result.sigma;
    rms_[row] = std::sqrt(result.sigma);
    sigma_lower_bound_[row] = result.sigma_lower_bound;
    depth_in_[row] = result.depth_in;
    min_distance_[row] = result.min_distance;
    limit_excess_in_[row] = result.limit_excess_in;
    equality_residual_in_[row] = result.equality_residual_in;
    equality_residual_[row] = result.equality_residual;
    tendon_excess_in_[row] = result.tendon_excess_in;
    tendon_excess_[row] = result.tendon_excess;
    certified_[row] = result.certified;
    proven_[row] = IsProven(result);
    start_[row] = result.start;
    cause_[row] = NameOf(result.cause);
    reason_[row] = result.reason;
    iterations_[row] = result.stats.iterations;
    queries_[row] = result.stats.collision_queries;
    seconds_[row] = result.stats.seconds;
  }

  // Empties the columns.
  nb::dict Take() {
    nb::dict d;
    d["status"] = Texts(status_);
    d["q"] = Array(std::move(q_), {rows_, nq_});
    d["sigma"] = Array(std::move(sigma_));
    d["rms"] = Array(std::move(rms_));
    d["sigma_lower_bound"] = Array(std::move(sigma_lower_bound_));
    d["depth_in"] = Array(std::move(depth_in_));
    d["min_distance"] = Array(std::move(min_distance_));
    d["limit_excess_in"] = Array(std::move(limit_excess_in_));
    d["equality_residual_in"] = Array(std::move(equality_residual_in_));
    d["equality_residual"] = Array(std::move(equality_residual_));
    d["tendon_excess_in"] = Array(std::move(tendon_excess_in_));
    d["tendon_excess"] = Array(std::move(tendon_excess_));
    d["certified"] = Array(std::move(certified_)).attr("view")("bool");
    d["proven"] = Array(std::move(proven_)).attr("view")("bool");
    d["start"] = Texts(start_);
    d["cause"] = Texts(cause_);
    d["reason"] = Texts(reason_);
    d["iterations"] = Array(std::move(iterations_));
    d["queries"] = Array(std::move(queries_));
    d["seconds"] = Array(std::move(seconds_));
    return d;
  }

 private:
  static nb::object Texts(const std::vector<std::string>& texts) {
    nb::list list;
    for (const std::string& text : texts) list.append(Text(text));
    return nb::module_::import_("numpy").attr("array")(list, "str");
  }

  std::size_t rows_, nq_;
  std::vector<double> q_, sigma_, rms_, sigma_lower_bound_, depth_in_, min_distance_,
      limit_excess_in_, equality_residual_in_, equality_residual_, tendon_excess_in_,
      tendon_excess_, seconds_;
  std::vector<std::int64_t> iterations_, queries_;
  std::vector<std::uint8_t> certified_, proven_;  // std::vector<bool> has no array inside
  std::vector<std::string> status_, start_, cause_, reason_;
};

// A function that runs in a thread of its own, while the calling thread looks after Python.
class Background {
 public:
  template <typename Function>
  explicit Background(const Function& function)
      : thread_([this, function] {
          std::exception_ptr failure;
          try {
            function();
          } catch (...) {
            failure = std::current_exception();
          }
          const std::lock_guard<std::mutex> lock(mutex_);
          failure_ = failure;
          ended_ = true;
          changed_.notify_all();
        }) {}

  // True if it has ended, false if `time` has passed.
  bool WaitFor(std::chrono::milliseconds time) {
    std::unique_lock<std::mutex> lock(mutex_);
    return changed_.wait_for(lock, time, [this] { return ended_; });
  }

  // Waits until it has ended. Throws what it has thrown.
  void Join() {
    thread_.join();
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ended_ = false;
  std::exception_ptr failure_;
  std::jthread thread_;  // last: it uses what is above
};

}  // namespace

nb::dict SolveRows(nb::handle model, nb::handle qpos, int threads, nb::object progress,
                   const nb::kwargs& given) {
  Asked asked = CommandLineDefaults();
  asked.options.report_contacts = false;  // rows have no place for them
  ReadOptions(given, kNorm | kVerify | kSolve | kRows, asked);
  if (asked.smooth != 0.0 && !asked.options.trajectory) throw Error("smooth needs trajectory");
  const Model scene = ReadModel(model, asked.scene);
  std::vector<double> q;
  const std::size_t rows = ReadConfigurations(qpos, "qpos", scene.scene.nq(), q);
  Columns columns(rows, static_cast<std::size_t>(scene.scene.nq()));
  std::atomic<std::size_t> told = 0;
  std::atomic<bool> stop = false;
  const auto take_note = [&](std::size_t row, const Result& result) {
    columns.Set(row, result);
    ++told;
    return !stop;
  };
  const ErrorsThrow errors;
  const TrajectoryOptions frames{asked.options, asked.smooth, [&] { return !stop; }};
  Background solving([&] {
    if (asked.options.trajectory) {
      SolveTrajectory(scene.scene, frames, q, take_note);
    } else {
      SolveBatch(scene.scene, asked.options, q, threads, take_note);
    }
  });
  const auto wait = [&] {
    const nb::gil_scoped_release release;
    return solving.WaitFor(kAttention);
  };
  try {
    while (!wait()) {
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
      if (!progress.is_none()) progress(told.load());
    }
  } catch (...) {
    stop = true;
    const nb::gil_scoped_release release;
    while (!solving.WaitFor(kAttention)) continue;
    throw;
  }
  solving.Join();
  if (!progress.is_none()) progress(told.load());
  nb::dict fields = columns.Take();
  fields["q_in"] = Array(std::move(q), {rows, static_cast<std::size_t>(scene.scene.nq())});
  return fields;
}

}  // namespace mjcf_pdg::python
