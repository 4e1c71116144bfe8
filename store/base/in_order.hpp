// Work that several threads do and one takes in order: the loop that meshing, slices and verification share.
#pragma once
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#ifdef __linux__
#include <pthread.h>
#endif

#include "store/base/background.hpp"
#include "store/base/wanted.hpp"

namespace teracell::inline store {

// Whether the calling thread is to do all of the work: always where no thread can be started, as in a page. Then nothing else is compiled.
inline bool is_alone(int threads) {
#if defined(__wasm__) && !defined(_REENTRANT)
  return true;
#else
  return threads <= 1;
#endif
}

using Aside = std::function<void()>;

// next() -> std::optional<Job> is called by one thread at a time, in order. make(job, worker) -> Result runs on `threads`
// threads, with worker in [0, threads); the calling thread is worker 0. take(Result) runs on the calling thread in the order of the jobs. The
// results that wait for an earlier one are bounded: a thread that is `ahead` * threads jobs ahead sleeps. An exception of any of the
// three ends the loop and is thrown here. Of several exceptions it is that of the earliest job, so errors don't depend on
// timing.
//
// With several threads, each of them calls aside() before it makes a job, one thread at a time and never during next(). If that returns work, the
// thread does it in place of a job. Such work has no result, so nothing waits its turn for it; it must not throw.
//
// If `idle` has a thread, that is the last worker as soon as it has done its own jobs; if the loop ends before, it takes no part. What its own jobs
// throw is not thrown here. next, make and take must not call `idle`. (A new thread beside one that still works would be one more than was asked for.
// On as many cores two of them then shared one, for 10 to 20 ms even after the other core had become free.)
//
// The calling thread takes what is there before it makes the next one, so taking wakes nobody. Rejected: a thread that does nothing but take.
// It was woken for every few results and took a core from a thread that makes: meshing 10^12 cells on two cores took 1.08 times as long.
template <class Next, class Make, class Take>
void in_order(int threads, Next next, Make make, Take take, uint64_t ahead = 2, Background* idle = nullptr,
              const std::function<Aside()>& aside = nullptr) {
  if (is_alone(threads)) {
    while (auto job = next()) take(make(std::move(*job), 0));
    return;
  }
  using Job = typename decltype(next())::value_type;
  using Result = decltype(make(std::declval<Job>(), 0));
  struct Outcome {
    std::optional<Result> result;
    std::exception_ptr error;
    bool done = false;
  };
  // Job i writes into outcome i modulo their number, which stays until it is taken. All outcomes are made here, so that a thread
  // does nothing outside a try that may throw.
  std::vector<Outcome> outcomes(ahead * static_cast<uint64_t>(threads));
  std::mutex mutex;
  std::condition_variable room, ready;  // for the other threads, and for the calling one
  uint64_t started = 0, made = 0, taken = 0;  // made: without a gap
  bool exhausted = false, stop = false;
  const auto is_full = [&] { return started == taken + outcomes.size(); };
  std::mutex next_mutex;  // of its own: results are handed over while next() takes long

  // Makes the next one, or does what there is aside. False if there is none or, on the calling thread, which alone makes room, if there is no room
  // for it.
  const auto make_one = [&](int worker) {
    std::optional<Job> job;
    Outcome* outcome = nullptr;
    {
      std::unique_lock in_next(next_mutex);
      std::exception_ptr error;  // of the job that would be next
      if (aside) {
        {
          std::lock_guard lock(mutex);
          if (stop || exhausted || (worker == 0 && is_full())) return false;
        }
        Aside work;
        try {
          work = aside();
        } catch (...) {
          error = std::current_exception();
        }
        if (work) {
          in_next.unlock();
          work();
          return true;
        }
      }
      for (std::unique_lock lock(mutex); outcome == nullptr;) {
        if (stop || exhausted || (worker == 0 && is_full())) return false;
        if (!is_full()) {
          outcome = &outcomes[started % outcomes.size()];
        } else {  // the calling thread must get past this, and others
          in_next.unlock();
          room.wait(lock, [&] { return stop || exhausted || !is_full(); });
          lock.unlock();
          in_next.lock();
          lock.lock();
        }
      }
      try {
        if (error) std::rethrow_exception(error);
        job = next();
      } catch (...) {
        outcome->error = std::current_exception();
      }
      std::lock_guard lock(mutex);
      if (!job) exhausted = true;
      if (!job && !outcome->error) {
        ready.notify_one();
        room.notify_all();
        return false;
      }
      ++started;
    }
    if (job) {
      try {
        outcome->result.emplace(make(std::move(*job), worker));
      } catch (...) {
        outcome->error = std::current_exception();
      }
    }
    std::lock_guard lock(mutex);
    outcome->done = true;
    while (made < started && outcomes[made % outcomes.size()].done) ++made;
    if (made > taken) ready.notify_one();
    return true;
  };
  const auto work = [&, wanted = Wanted::of_workers()](int worker) {
    Wanted::work_for(wanted);
#ifdef __linux__
    ::pthread_setname_np(::pthread_self(), "worker");  // for top -H, perf and tools/bench/run
#endif
    while (make_one(worker)) {
    }
  };
  std::vector<std::jthread> pool;
  // What becomes of the job for `idle`, which outlives the loop if it has not begun.
  enum Lent : int { kWaits, kWorks, kEnded };
  const auto lent = std::make_shared<std::atomic<int>>(kWaits);
  struct Stop {  // before the threads are joined, also when take() throws
    std::mutex& mutex;
    std::condition_variable& room;
    bool& stop;
    std::atomic<int>& lent;
    ~Stop() {
      {
        std::lock_guard lock(mutex);
        stop = true;
        room.notify_all();
      }
      if (int waits = kWaits; !lent.compare_exchange_strong(waits, kEnded)) lent.wait(kWorks);
    }
  } at_exit{mutex, room, stop, *lent};
  const bool lends = idle != nullptr && idle->has_thread();
  for (int i = 1; i < threads - lends; ++i) pool.emplace_back(work, i);
  if (lends) {
    try {
      idle->run_later([lent, &work, worker = threads - 1] {
        if (int waits = kWaits; !lent->compare_exchange_strong(waits, kWorks)) return;
        work(worker);
        Wanted::work_for(nullptr);
        lent->store(kEnded);
        lent->notify_one();
      });
    } catch (...) {  // a job of its own has thrown; the next call of `idle` throws that again
    }
  }
  for (bool can_make = true;;) {
    uint64_t end;
    {
      std::unique_lock lock(mutex);
      if (!can_make) ready.wait(lock, [&] { return made > taken || (exhausted && made == started); });
      if (made == taken && exhausted && made == started) break;
      end = made;
    }
    while (taken < end) {
      Outcome& outcome = outcomes[taken % outcomes.size()];
      if (outcome.error) std::rethrow_exception(outcome.error);
      take(std::move(*outcome.result));
      outcome.result.reset();
      std::lock_guard lock(mutex);
      outcome.done = false;
      ++taken;
      room.notify_one();
    }
    can_make = make_one(0);
  }
}

}  // namespace teracell::store
