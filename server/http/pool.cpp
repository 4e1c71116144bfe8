#include "server/http/pool.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "store/error.hpp"

namespace teracell {
namespace {

constexpr int kMostInARow = 8;  // cheap pieces of work before a dear one, on a single thread

}  // namespace

Pool::Pool(int threads) : several_(threads > 1), most_running_(static_cast<size_t>(std::max(1, threads - 1))) {
  try {
    for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { work(); });
  } catch (const std::system_error& e) {
    const size_t started = threads_.size();
    join();
    throw IoError(fmt::format("can't start thread {} of {}: {}", started + 1, threads, e.code().message()));
  }
}

void Pool::post(const void* client, Cost cost, std::function<void()> work) {
  std::list<const void*> turn{client};  // made first: work that was queued without a turn would never be done
  std::lock_guard lock(mutex_);
  Lane& lane = lanes_[cost];
  auto& queue = lane.queues[client];
  queue.push_back(std::move(work));
  if (queue.size() == 1) lane.turns.splice(lane.turns.end(), turn);
  changed_.notify_one();
}

void Pool::join() {
  {
    std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  threads_.clear();
}

std::function<void()> Pool::Lane::take() {
  const auto it = queues.find(turns.front());
  std::function<void()> work = std::move(it->second.front());
  it->second.pop_front();
  if (it->second.empty()) {
    queues.erase(it);
    turns.pop_front();
  } else {
    turns.splice(turns.end(), turns, turns.begin());
  }
  return work;
}

// Cheap work goes first, except that dear work may always have one thread where there are several.
Pool::Lane* Pool::next() {
  Lane &cheap = lanes_[kCheap], &dear = lanes_[kDear];
  const bool dear_may_run = !dear.empty() && dear.running < most_running_;
  const bool dear_has_turn = several_ ? dear.running == 0 : cheap_in_a_row_ >= kMostInARow;
  if (dear_may_run && (cheap.empty() || dear_has_turn)) {
    cheap_in_a_row_ = 0;
    return &dear;
  }
  if (cheap.empty()) return nullptr;
  ++cheap_in_a_row_;
  return &cheap;
}

void Pool::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    Lane* lane = next();
    if (!lane) {
      if (stopping_ && lanes_[kDear].empty()) return;
      changed_.wait(lock);
      continue;
    }
    std::function<void()> task = lane->take();
    ++lane->running;
    lock.unlock();
    try {
      task();
    } catch (...) {  // there was no memory to say what went wrong
    }
    task = nullptr;  // before others may take what it holds for free
    lock.lock();
    --lane->running;
    if (!lanes_[kDear].empty() || stopping_) changed_.notify_all();  // a thread may have waited for this lane
  }
}

}  // namespace teracell
