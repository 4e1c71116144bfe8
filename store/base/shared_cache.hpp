// Makes a value only once, even if several threads ask for it at the same time, and keeps values up to a number of bytes.
// Threads share it.
#pragma once
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <utility>

#include "store/base/cache_counts.hpp"
#include "store/base/wanted.hpp"

namespace teracell::inline store {

template <class Key, class Value, class Hash = std::hash<Key>>
class SharedCache {
 public:
  using Pointer = std::shared_ptr<const Value>;
  explicit SharedCache(size_t bytes) : most_(bytes) {}

  // Null when the value is not here, or is still being made. Counts nothing: a caller that uses the value calls hit().
  Pointer find(const Key& key) {
    std::lock_guard lock(mutex_);
    const auto it = entries_.find(key);
    if (it == entries_.end() || !it->second || !it->second->value) return nullptr;
    touch(it->second);
    return it->second->value;
  }
  void hit() { ++hits_; }

  // make() returns {value, the bytes of memory that it takes}. While one thread is in make(), others that want the same value
  // wait. If make() throws, all of them throw the same, and the next caller tries again; after Unwanted, one of those that wait
  // makes the value. A value larger than the cache is not kept. Only a value that was here counts as a hit, not one that was waited
  // for.
  template <class Make>
  Pointer get(const Key& key, Make&& make) {
    std::unique_lock lock(mutex_);
    std::shared_ptr<Entry> entry;
    for (bool first = true;; first = false) {
      std::shared_ptr<Entry>& place = entries_[key];
      const bool mine = !place;
      if (mine) place = std::make_shared<Entry>(Entry{key});
      entry = place;
      if (first) ++(entry->value ? hits_ : misses_);
      if (mine) break;
      made_.wait(lock, [&] { return entry->value || entry->error || entry->given_up; });
      if (entry->error) std::rethrow_exception(entry->error);
      if (entry->given_up) continue;
      touch(entry);
      return entry->value;
    }
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
    made_.notify_all();
    if (error) {
      if (given_up) entry->given_up = true;
      else entry->error = error;
      entries_.erase(key);
      std::rethrow_exception(error);
    }
    entry->value = made.first;
    entry->bytes = made.second + kOverhead;
    if (entry->bytes > most_) {
      entries_.erase(key);
      return entry->value;
    }
    recent_.push_front(entry);
    entry->place = recent_.begin();
    entry->listed = true;
    bytes_ += entry->bytes;
    while (bytes_ > most_) {
      const std::shared_ptr<Entry> oldest = recent_.back();
      recent_.pop_back();
      oldest->listed = false;
      bytes_ -= oldest->bytes;
      entries_.erase(oldest->key);
    }
    return entry->value;
  }

  CacheCounts counts() const {
    std::lock_guard lock(mutex_);
    return {hits_, misses_, bytes_, recent_.size(), most_};
  }

 private:
  struct Entry {
    Key key;
    Pointer value;
    std::exception_ptr error;
    bool given_up = false;  // what was making it was stopped by Unwanted
    size_t bytes = 0;
    bool listed = false;
    typename std::list<std::shared_ptr<Entry>>::iterator place{};
  };
  // The memory that an entry takes besides its value: itself, and its nodes in list and map, as malloc rounds them.
  static constexpr size_t kOverhead = sizeof(Entry) + sizeof(Key) + 160;

  void touch(const std::shared_ptr<Entry>& entry) {
    if (entry->listed) recent_.splice(recent_.begin(), recent_, entry->place);
  }

  const size_t most_;
  mutable std::mutex mutex_;
  std::condition_variable made_;
  std::unordered_map<Key, std::shared_ptr<Entry>, Hash> entries_;
  std::list<std::shared_ptr<Entry>> recent_;  // those that are made, the most recent first
  std::atomic<uint64_t> hits_ = 0, misses_ = 0;
  size_t bytes_ = 0;
};

}  // namespace teracell::store
