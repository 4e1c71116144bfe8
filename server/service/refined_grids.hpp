// Grids that are refined in some way, made ready for the places that were asked for and kept for the next ones.
#pragma once
#include <chrono>
#include <shared_mutex>

#include "server/service/grid_list.hpp"
#include "store/base/lru_cache.hpp"
#include "store/base/wanted.hpp"
#include "store/refine/leaves.hpp"

namespace teracell::server {

// Threads share it.
class RefinedGrid {
 public:
  // What does not fit into `memory` bytes goes to a temporary file. Throws UsageError, IoError.
  RefinedGrid(std::shared_ptr<const ServedGrid> grid, const Refinement& refinement, size_t memory)
      : grid_(std::move(grid)), leaves_(grid_->reader(), refinement, temporary_folder(), memory) {}

  // f(leaves), which are prepared for a box of level-0 cells. Who is not wanted any more waits no longer for others.
  template <class F>
  auto with(const Box& box, F&& f) const {
    for (;;) {
      {
        const auto lock = locked<std::shared_lock<std::shared_timed_mutex>>();
        if (leaves_.is_prepared(box)) return f(std::as_const(leaves_));
      }
      const auto lock = locked<std::unique_lock<std::shared_timed_mutex>>();
      leaves_.prepare(box, 1, [](double) { Wanted::stop_if_not(); });
    }
  }

 private:
  template <class Lock>
  Lock locked() const {
    Lock lock(mutex_, std::defer_lock);
    if (lock.try_lock()) return lock;  // a page, which has no clock, waits for nobody
    // By the system's clock: the sanitizer of races knows nothing of locks that wait by the steady one, and called what they guard a race.
    while (!lock.try_lock_until(std::chrono::system_clock::now() + std::chrono::milliseconds(50))) Wanted::stop_if_not();
    return lock;
  }

  const std::shared_ptr<const ServedGrid> grid_;  // before what refers to it
  mutable std::shared_timed_mutex mutex_;  // others read while nothing is prepared
  mutable Leaves leaves_;
};

using RefinedGrids = LruCache<std::string, RefinedGrid>;  // the key: ServedGrid::number, M,N, and the wishes as the client wrote them

}  // namespace teracell::server
