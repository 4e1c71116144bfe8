// Distinct sequences of numbers, numbered in the order in which they came: patterns of rays, sets of labels. All of them lie in one
// array, since a chunk of a hostile file may have millions.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace teracell::inline store {

// There are usually so few elements that a call of memcmp would cost more.
inline bool same(std::span<const uint32_t> a, std::span<const uint32_t> b) {
  if (a.size() != b.size()) return false;
  for (size_t i = 0; i < a.size(); ++i)
    if (a[i] != b[i]) return false;
  return true;
}

// Not thread-safe.
class SequenceTable {
 public:
  // The number of the sequence. REQUIRES: `numbers` does not lie in this table.
  uint32_t intern(std::span<const uint32_t> numbers);
  std::span<const uint32_t> operator[](uint32_t i) const { return {numbers_.data() + begin_[i], begin_[i + 1] - begin_[i]}; }
  uint32_t size() const { return static_cast<uint32_t>(begin_.size()) - 1; }
  void clear();
  size_t memory() const { return (begin_.capacity() + numbers_.capacity() + table_.capacity()) * 4; }  // bytes on the heap

 private:
  void grow();
  std::vector<uint32_t> begin_{0};
  std::vector<uint32_t> numbers_;
  std::vector<uint32_t> table_;  // open addressing; number of the sequence + 1, 0 is free
};

}  // namespace teracell::store
