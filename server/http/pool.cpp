#include "server/http/pool.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "store/base/error.hpp"

namespace teracell::server {
namespace {

constexpr int kMostInARow = 8;  // cheap pieces of work before a dear one, on a single thread

}  // namespace

Pool::Pool(int threads) : several_(threads > 1) {
  const int more = threads / 2;
  lane(Cost::kCheap).most = static_cast<size_t>(threads);
  lane(Cost::kDear).most = static_cast<size_t>(std::max(1, threads - 1));
  lane(Cost::kSeen).most = static_cast<size_t>(more);
  try {
    for (int i = 0; i < threads + more; ++i) threads_.emplace_back([this] { work(); });
  } catch (const std::system_error& e) {
    const size_t started = threads_.size();
    join();
    throw IoError(fmt::format("can't start thread {} of {}: {}", started + 1, threads + more, e.code().message()));
  }
}

void Pool::post(const void* client, Cost cost, std::function<void()> work) {
  std::list<const void*> turn{client};  // made first: work that was queued without a turn would never be done
  std::lock_guard lock(mutex_);
  Lane& to = lane(several_ || cost != Cost::kSeen ? cost : Cost::kCheap);
  auto& queue = to.queues[client];
  queue.push_back(std::move(work));
  if (queue.size() == 1) to.turns.splice(to.turns.end(), turn);
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

// Cheap work goes first, except that each of the other lanes may always have one thread where there are several.
Pool::Lane* Pool::next() {
  Lane &cheap = lane(Cost::kCheap), &dear = lane(Cost::kDear);
  const auto can_run = [](const Lane& l) { return !l.empty() && l.running < l.most; };
  if (several_) {
    for (const Cost cost : {Cost::kDear, Cost::kSeen})
      if (Lane& l = lane(cost); can_run(l) && l.running == 0) return &l;
    for (const Cost cost : {Cost::kCheap, Cost::kSeen, Cost::kDear})
      if (Lane& l = lane(cost); can_run(l)) return &l;
    return nullptr;
  }
  if (can_run(dear) && (cheap.empty() || cheap_in_a_row_ >= kMostInARow)) {
    cheap_in_a_row_ = 0;
    return &dear;
  }
  if (!can_run(cheap)) return nullptr;
  ++cheap_in_a_row_;
  return &cheap;
}

bool Pool::has_waiting() const {
  return std::ranges::any_of(lanes_, [](const Lane& l) { return !l.empty(); });
}

void Pool::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    Lane* from = next();
    if (!from) {
      if (stopping_ && !has_waiting()) return;
      changed_.wait(lock);
      continue;
    }
    std::function<void()> task = from->take();
    ++from->running;
    lock.unlock();
    try {
      task();
    } catch (...) {  // there was no memory to say what went wrong
    }
    task = nullptr;  // before others may take what it holds for free
    lock.lock();
    --from->running;
    if (has_waiting() || stopping_) changed_.notify_all();  // a thread may have waited for this lane
  }
}

}  // namespace teracell::server
