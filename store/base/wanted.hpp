// Work that nobody waits for any more is stopped between chunks. A thread that makes something for somebody says, for the time that
// it takes, how to find out whether that is still wanted; readers ask before each chunk. A signal stops a command in the same way. Other
// threads are never stopped.
#pragma once
#include <functional>
#include <utility>

#include "store/base/error.hpp"

namespace teracell::inline store {

// What is being made is not wanted any more. LruCache lets others that wait for the same value make it themselves.
struct Unwanted : Error {
  using Error::Error;
};

// Bytes that are needed will be there later: the same work is to be done again then. Who has many parts to do goes on with the others first,
// so that whoever fetches bytes learns of all that are missing at once.
struct Later : Unwanted {
  using Unwanted::Unwanted;
};

class Wanted {
 public:
  // Who asks: the thread that made this object alone, or the threads of in_order() as well, that work for it meanwhile.
  enum class Asked { kHere, kByWorkers };
  // `check` throws what is to end the work, such as Unwanted or Interrupted. It is called often; kByWorkers: by several threads at once.
  explicit Wanted(std::function<void()> check, Asked asked = Asked::kHere)
      : check_(std::move(check)), asked_(asked), outer_(std::exchange(current(), this)) {}
  ~Wanted() { current() = outer_; }
  Wanted(const Wanted&) = delete;

  static void stop_if_not() {
    if (const Wanted* w = current()) w->check_();
  }

  // What threads ask that work for the calling one; null: nothing.
  static const Wanted* of_workers() {
    const Wanted* w = current();
    while (w && w->asked_ == Asked::kHere) w = w->outer_;
    return w;
  }
  // For a thread that ends before `wanted` does.
  static void work_for(const Wanted* wanted) { current() = wanted; }

 private:
  static const Wanted*& current() {
    thread_local const Wanted* innermost = nullptr;
    return innermost;
  }
  const std::function<void()> check_;
  const Asked asked_;
  const Wanted* const outer_;
};

}  // namespace teracell::store
