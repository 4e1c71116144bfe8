// Keeps the values that were asked for last, up to a number of bytes. Threads may share it.
#pragma once
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "store/base/cache_counts.hpp"

namespace teracell::inline store {

template <class Key, class Value, class Hash = std::hash<Key>>
class LruCache {
 public:
  explicit LruCache(size_t bytes) : most_(bytes) {}

  std::shared_ptr<const Value> find(const Key& key) {  // null when it is not here
    std::lock_guard lock(mutex_);
    const auto it = places_.find(key);
    ++(it == places_.end() ? misses_ : hits_);
    if (it == places_.end()) return nullptr;
    entries_.splice(entries_.begin(), entries_, it->second);
    return it->second->value;
  }

  // `bytes` is the memory that the value takes. The value stays until the next one pushes it out, even if it is larger than
  // the cache: a page that is read chunk by chunk must not be decoded for each chunk.
  void add(const Key& key, std::shared_ptr<const Value> value, size_t bytes) {
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

  void erase(const Key& key) {
    std::lock_guard lock(mutex_);
    const auto it = places_.find(key);
    if (it == places_.end()) return;
    bytes_ -= it->second->bytes;
    entries_.erase(it->second);
    places_.erase(it);
  }

  CacheCounts counts() const {
    std::lock_guard lock(mutex_);
    return {hits_, misses_, bytes_, entries_.size(), most_};
  }

 private:
  struct Entry {
    Key key;
    std::shared_ptr<const Value> value;
    size_t bytes;
  };
  const size_t most_;
  mutable std::mutex mutex_;
  uint64_t hits_ = 0, misses_ = 0;
  size_t bytes_ = 0;
  std::list<Entry> entries_;  // the most recent first
  std::unordered_map<Key, typename std::list<Entry>::iterator, Hash> places_;
};

}  // namespace teracell::store
