// What was asked for last, up to a number of bytes. Threads may share it.
#pragma once
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>

namespace teracell {

template <class Value>
class LruCache {
 public:
  explicit LruCache(size_t bytes) : most_(bytes) {}

  std::shared_ptr<const Value> find(uint64_t key) {  // null when it is not here
    std::lock_guard lock(mutex_);
    const auto it = places_.find(key);
    if (it == places_.end()) return nullptr;
    entries_.splice(entries_.begin(), entries_, it->second);
    return it->second->value;
  }

  // `bytes` is the memory that the value takes. It stays until others push it out, though it alone be more than the cache
  // should hold: who reads a page chunk by chunk must not decode it for each.
  void add(uint64_t key, std::shared_ptr<const Value> value, size_t bytes) {
    std::lock_guard lock(mutex_);
    if (places_.contains(key)) return;  // another thread was faster
    entries_.push_front({key, std::move(value), bytes});
    bytes_ += bytes;
    places_[key] = entries_.begin();
    while (bytes_ > most_ && entries_.size() > 1) {
      bytes_ -= entries_.back().bytes;
      places_.erase(entries_.back().key);
      entries_.pop_back();
    }
  }

  size_t bytes() const {
    std::lock_guard lock(mutex_);
    return bytes_;
  }

 private:
  struct Entry {
    uint64_t key;
    std::shared_ptr<const Value> value;
    size_t bytes;
  };
  const size_t most_;
  mutable std::mutex mutex_;
  size_t bytes_ = 0;
  std::list<Entry> entries_;  // most recent first
  std::unordered_map<uint64_t, typename std::list<Entry>::iterator> places_;
};

}  // namespace teracell
