// Does something once, however many threads ask for it. std::call_once does the same, but must not throw in a program that links libgcc statically,
// as packages for other systems do: glibc unwinds through pthread_once() with the shared libgcc, and where two of them meet, the program aborts.
#pragma once
#include <atomic>
#include <mutex>

namespace teracell::inline store {

class Once {
 public:
  // Calls f() unless it has been called; others wait for it meanwhile. When it throws, so does this, and the next call tries again.
  template <class F>
  void operator()(F&& f) {
    if (done_.load(std::memory_order_acquire)) return;
    std::lock_guard lock(mutex_);
    if (done_.load(std::memory_order_relaxed)) return;
    f();
    done_.store(true, std::memory_order_release);
  }

 private:
  std::mutex mutex_;
  std::atomic<bool> done_ = false;
};

}  // namespace teracell::store
