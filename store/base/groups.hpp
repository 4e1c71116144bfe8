// Things that are joined into groups: a union-find.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace teracell::inline store {

// Things have numbers from 0 on. The least one of a group stands for it. Not thread-safe.
class Groups {
 public:
  explicit Groups(size_t things = 0) : parent_(things) { std::iota(parent_.begin(), parent_.end(), 0); }
  uint32_t size() const { return static_cast<uint32_t>(parent_.size()); }  // things
  void reserve(uint64_t things) { parent_.reserve(things); }
  // One more thing, which is a group of its own. Returns its number.
  uint32_t add() {
    parent_.push_back(size());
    return parent_.back();
  }
  uint32_t of(uint32_t thing) {
    while (parent_[thing] != thing) thing = parent_[thing] = parent_[parent_[thing]];
    return thing;
  }
  void join(uint32_t a, uint32_t b) {
    a = of(a), b = of(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }
  // The same for three things. Their parents mostly stand for groups. Then all is written anew, also where nothing changes: which of them are joined
  // for the first time, no processor could foresee.
  void join(uint32_t a, uint32_t b, uint32_t c) {
    uint32_t i = parent_[a], j = parent_[b], k = parent_[c];
    if (((parent_[i] ^ i) | (parent_[j] ^ j) | (parent_[k] ^ k)) != 0) [[unlikely]]
      i = of(a), j = of(b), k = of(c);
    const uint32_t least = std::min(std::min(i, j), k);
    parent_[i] = parent_[j] = parent_[k] = least;
    parent_[a] = parent_[b] = parent_[c] = least;
  }
  bool stands_for_one(uint32_t thing) const { return parent_[thing] == thing; }
  // How many groups there are.
  uint64_t count() const {
    uint64_t groups = 0;
    for (uint32_t thing = 0; thing < size(); ++thing) groups += stands_for_one(thing);
    return groups;
  }

 private:
  std::vector<uint32_t> parent_;
};

}  // namespace teracell::store
