// Work that several threads do and one takes in order: the loop that meshing, slices and verification share.
#pragma once
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace teracell {

// next() -> std::optional<Job> is called by one thread at a time, in order. make(job, worker) -> Result runs on `threads`
// threads, with worker in [0, threads). take(Result) runs on the calling thread in the order of the jobs. The results that
// wait for an earlier one are bounded: a thread that is `ahead` * threads jobs ahead sleeps. An exception of any of the
// three ends the loop and is thrown here. Of several exceptions it is that of the earliest job, so errors don't depend on
// timing.
template <class Next, class Make, class Take>
void in_order(int threads, Next next, Make make, Take take, uint64_t ahead = 2) {
  if (threads <= 1) {
    while (auto job = next()) take(make(std::move(*job), 0));
    return;
  }
  using Job = typename decltype(next())::value_type;
  using Result = decltype(make(std::declval<Job>(), 0));
  struct Slot {
    std::optional<Result> result;
    std::exception_ptr error;
    bool done = false;
  };
  // Job i has slot i modulo their number until it is taken. All slots are made here, so that a thread does nothing outside a
  // try that may throw.
  std::vector<Slot> slots(ahead * static_cast<uint64_t>(threads));
  std::mutex mutex;
  std::condition_variable changed;
  uint64_t started = 0, taken = 0;
  bool exhausted = false, stop = false;
  std::mutex next_mutex;  // of its own: results are handed over while next() takes long

  const auto work = [&](int worker) {
    for (;;) {
      std::optional<Job> job;
      Slot* slot;
      {
        std::lock_guard in_next(next_mutex);
        {
          std::unique_lock lock(mutex);
          changed.wait(lock, [&] { return stop || exhausted || started < taken + slots.size(); });
          if (stop || exhausted) return;
          slot = &slots[started % slots.size()];
        }
        try {
          job = next();
        } catch (...) {
          slot->error = std::current_exception();
        }
        std::lock_guard lock(mutex);
        if (!job) exhausted = true;
        if (!job && !slot->error) {
          changed.notify_all();
          return;
        }
        ++started;
      }
      if (job) {
        try {
          slot->result.emplace(make(std::move(*job), worker));
        } catch (...) {
          slot->error = std::current_exception();
        }
      }
      std::lock_guard lock(mutex);
      slot->done = true;
      changed.notify_all();
    }
  };
  std::vector<std::jthread> pool;
  struct Stop {  // before the threads are joined, also when take() throws
    std::mutex& mutex;
    std::condition_variable& changed;
    bool& stop;
    ~Stop() {
      std::lock_guard lock(mutex);
      stop = true;
      changed.notify_all();
    }
  } at_exit{mutex, changed, stop};
  for (int i = 0; i < threads; ++i) pool.emplace_back(work, i);
  for (;;) {
    Slot& slot = slots[taken % slots.size()];
    {
      std::unique_lock lock(mutex);
      changed.wait(lock, [&] { return slot.done || (exhausted && taken == started); });
      if (!slot.done) break;
    }
    if (slot.error) std::rethrow_exception(slot.error);
    take(std::move(*slot.result));
    slot.result.reset();
    std::lock_guard lock(mutex);
    slot.done = false;
    ++taken;
    changed.notify_all();
  }
}

}  // namespace teracell
