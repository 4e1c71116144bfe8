// Work that nobody waits for any more is stopped between chunks. A thread that makes something for somebody says, for the time that
// it takes, how to find out whether that is still wanted; readers ask before each chunk. Other threads are never stopped.
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
  // `check` throws what is to end the work, such as Unwanted. It is called often, by the thread that made this object.
  explicit Wanted(std::function<void()> check) : check_(std::move(check)), outer_(std::exchange(current(), this)) {}
  ~Wanted() { current() = outer_; }
  Wanted(const Wanted&) = delete;

  static void stop_if_not() {
    if (const Wanted* w = current()) w->check_();
  }

 private:
  static Wanted*& current() {
    thread_local Wanted* innermost = nullptr;
    return innermost;
  }
  const std::function<void()> check_;
  Wanted* const outer_;
};

}  // namespace teracell::inline store
