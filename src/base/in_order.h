// Items that several threads work on, taken and told in order: a stream of any length in bounded
// memory.
#ifndef MJCF_PDG_SRC_BASE_IN_ORDER_H_
#define MJCF_PDG_SRC_BASE_IN_ORDER_H_

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace mjcf_pdg {

// What the threads do. `take` fills the next item and returns false if there is none; `work` is
// done by thread `thread`; `tell` sees items in the order in which they were taken and returns
// false to end. Items are reused, so that what they hold is not made anew. `take` and `tell` are
// each called by one thread at a time.
template <typename Item>
class InOrder {
 public:
  // Items per thread that may wait for a slow one before them: enough that one item a hundred times
  // slower than the others stops nobody, few enough to hold in memory.
  static constexpr std::size_t kWaitingPerThread = 128;

  explicit InOrder(std::size_t threads) : threads_(threads), slots_(kWaitingPerThread * threads) {}

  // Returns when `take` has no more items and all are told, or `tell` has ended it. If `take`
  // throws, the items before are still told; the first exception is thrown on.
  template <typename Take, typename Work, typename Tell>
  void Run(const Take& take, const Work& work, const Tell& tell) {
    const auto loop = [&](std::size_t thread) {
      std::size_t k = 0;
      while (TakeNext(take, k)) {
        if (!Guarded([&] { work(thread, slots_[k % slots_.size()].item); })) return;
        Finish(tell, k);
      }
    };
    {
      std::vector<std::jthread> others;
      for (std::size_t t = 1; t < threads_; ++t) others.emplace_back([&loop, t] { loop(t); });
      loop(0);
    }
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  struct Slot {
    Item item;
    bool ready = false;
  };

  template <typename Function>
  bool Guarded(const Function& function) {
    try {
      function();
      return true;
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
      ended_ = true;
      changed_.notify_all();
      return false;
    }
  }

  // Item k goes to slot k modulo the number of slots, and waits until that has been told.
  template <typename Take>
  bool TakeNext(const Take& take, std::size_t& k) {
    const std::lock_guard<std::mutex> taking(take_mutex_);
    {
      std::unique_lock<std::mutex> lock(mutex_);
      changed_.wait(lock, [this] { return ended_ || next_ < told_ + slots_.size(); });
      if (ended_ || drained_) return false;
    }
    try {
      drained_ = !take(slots_[next_ % slots_.size()].item);
    } catch (...) {
      drained_ = true;
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
    }
    if (drained_) return false;
    const std::lock_guard<std::mutex> lock(mutex_);
    k = next_++;
    return true;
  }

  // Item k is done: tells it and those that waited for it, unless another thread is telling.
  template <typename Tell>
  void Finish(const Tell& tell, std::size_t k) {
    std::unique_lock<std::mutex> lock(mutex_);
    slots_[k % slots_.size()].ready = true;
    if (telling_) return;
    telling_ = true;
    while (!ended_ && slots_[told_ % slots_.size()].ready) {
      Slot& slot = slots_[told_ % slots_.size()];
      const std::size_t index = told_;
      lock.unlock();
      bool goes_on = false;
      Guarded([&] { goes_on = tell(index, std::as_const(slot.item)); });
      lock.lock();
      slot.ready = false;
      ++told_;
      ended_ = ended_ || !goes_on;
      changed_.notify_all();
    }
    telling_ = false;
  }

  const std::size_t threads_;
  std::vector<Slot> slots_;
  std::mutex take_mutex_;  // of drained_; held by the thread that takes
  bool drained_ = false;
  std::mutex mutex_;  // of what follows
  std::condition_variable changed_;
  std::size_t next_ = 0, told_ = 0;
  bool telling_ = false, ended_ = false;
  std::exception_ptr failure_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BASE_IN_ORDER_H_
