// Keeps the values that were asked for last, up to a number of bytes, and makes a value only once, even if several threads ask for it at
// the same time. Threads may share it.
#pragma once
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <utility>

#include "store/base/wanted.hpp"

namespace teracell::inline store {

struct CacheCounts {
  size_t bytes = 0, limit = 0;
  uint64_t hits = 0, misses = 0;  // requests for values that were there, and for values that were not
  size_t entries = 0;
};

template <class Key, class Value, class Hash = std::hash<Key>>
class LruCache {
 public:
  using Pointer = std::shared_ptr<const Value>;
  explicit LruCache(size_t bytes) : most_(bytes) {}

  // A number of its own, as a part of keys, for each who shares the cache.
  uint64_t new_owner() {
    std::lock_guard lock(mutex_);
    return owners_++;
  }

  Pointer find(const Key& key) {  // null when it is not here
    std::lock_guard lock(mutex_);
    Pointer value = touched(key);
    ++(value ? hits_ : misses_);
    return value;
  }

  // The same, but it counts nothing: a caller that uses the value calls hit().
  Pointer peek(const Key& key) {
    std::lock_guard lock(mutex_);
    return touched(key);
  }
  void hit() {
    std::lock_guard lock(mutex_);
    ++hits_;
  }

  // `bytes` is the memory that the value takes. The value stays until the next one pushes it out, even if it is larger than
  // the cache: a page that is read chunk by chunk must not be decoded for each chunk.
  void add(const Key& key, Pointer value, size_t bytes) {
    std::lock_guard lock(mutex_);
    if (!places_.contains(key)) keep(key, std::move(value), bytes);  // or else another thread was faster
  }

  // make() returns {value, the bytes of memory that it takes}. While one thread is in make(), others that want the same value
  // wait. If make() throws, all of them throw the same, and the next caller tries again; after Unwanted, one of those that wait
  // makes the value. A value larger than the cache is not kept. Only a value that was here counts as a hit, not one that was waited
  // for.
  template <class Make>
  Pointer get(const Key& key, Make&& make) {
    std::unique_lock lock(mutex_);
    if (Pointer value = touched(key)) {
      ++hits_;
      return value;
    }
    ++misses_;
    for (auto it = making_.find(key); it != making_.end(); it = making_.find(key)) {
      const std::shared_ptr<Making> other = it->second;
      made_.wait(lock, [&] { return other->ended; });
      if (other->error) std::rethrow_exception(other->error);
      if (other->value) return other->value;
      if (Pointer value = touched(key)) return value;  // of one that waited as well
    }
    const auto mine = making_[key] = std::make_shared<Making>();
    lock.unlock();
    std::pair<Pointer, size_t> made;
    std::exception_ptr error;
    bool given_up = false;
    try {
      made = make();
    } catch (const Unwanted&) {
      given_up = true;
      error = std::current_exception();
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    mine->ended = true;
    mine->value = made.first;
    if (!given_up) mine->error = error;
    making_.erase(key);
    made_.notify_all();
    if (error) std::rethrow_exception(error);
    const size_t bytes = made.second + kOverhead;
    if (bytes <= most_ && !places_.contains(key)) keep(key, made.first, bytes);
    return made.first;
  }

  void erase(const Key& key) {
    std::lock_guard lock(mutex_);
    const auto it = places_.find(key);
    if (it == places_.end()) return;
    bytes_ -= it->second->bytes;
    entries_.erase(it->second);
    places_.erase(it);
  }

  void clear() {
    std::lock_guard lock(mutex_);
    places_.clear(), entries_.clear();
    bytes_ = 0;
  }

  CacheCounts counts() const {
    std::lock_guard lock(mutex_);
    return {bytes_, most_, hits_, misses_, entries_.size()};
  }

 private:
  struct Entry {
    Key key;
    Pointer value;
    size_t bytes;
  };
  struct Making {
    bool ended = false;
    Pointer value;             // neither this nor an error: what was making it was stopped by Unwanted
    std::exception_ptr error;
  };
  // The memory that a value of get() takes besides its own: its entry, and the nodes in list and map, as malloc rounds them.
  static constexpr size_t kOverhead = sizeof(Entry) + sizeof(Key) + 160;

  Pointer touched(const Key& key) {
    const auto it = places_.find(key);
    if (it == places_.end()) return nullptr;
    entries_.splice(entries_.begin(), entries_, it->second);
    return it->second->value;
  }

  void keep(const Key& key, Pointer value, size_t bytes) {
    entries_.push_front({key, std::move(value), bytes});
    bytes_ += bytes;
    places_[key] = entries_.begin();
    while (bytes_ > most_ && entries_.size() > 1) {
      bytes_ -= entries_.back().bytes;
      places_.erase(entries_.back().key);
      entries_.pop_back();
    }
  }

  const size_t most_;
  mutable std::mutex mutex_;
  std::condition_variable made_;
  uint64_t hits_ = 0, misses_ = 0, owners_ = 0;
  size_t bytes_ = 0;
  std::list<Entry> entries_;  // the most recent first
  std::unordered_map<Key, typename std::list<Entry>::iterator, Hash> places_;
  std::unordered_map<Key, std::shared_ptr<Making>, Hash> making_;
};

}  // namespace teracell::store
