// The facets of a surface by their vertices: how many different ones there are, and which lie on each other.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "mesher/closing/vertex_hash.hpp"
#include "store/base/populate.hpp"

namespace teracell::mesher {

// Facets are equal when their three vertices are, in any order. Of equal ones, those are opposite whose orientation is not that of the first one;
// a facet that has a vertex twice has no orientation. A hash table with open addressing and without erasure. Memory: 16 to 64 bytes per facet, or
// 1 MiB for a sample, and 2 while it is thinned out. Not thread-safe.
class FacetSet {
 public:
  // Reserves memory, so that the table need not grow. REQUIRES: the set is empty.
  void expect(uint64_t facets);
  void add(const std::array<VertexHash, 3>& facet) {
    ++added_;
    const uint64_t key = key_of(facet);
    if (key > most_) return;
    if (2 * (count_ + kWaiting) > table_.size()) grow();
    __builtin_prefetch(&table_[place_of(key)]);
    uint64_t& waiting = waiting_[turn_++ % kWaiting];
    if (waiting != 0) insert(waiting);
    waiting = key;
  }
  // From now on only a sample of the facets is held, those that were added included: all of a small surface, some 33,000 to 65,000 of a large
  // one. They are chosen by a hash of their vertices, so that the sample holds all facets that are equal, or none of them.
  void keep_sample();
  bool is_sample() const { return sample_; }
  // Empties the set. It stays a sample if it is one.
  void clear();

  uint64_t duplicates();  // facets that are equal to an earlier one. REQUIRES: all are held
  uint64_t opposite();    // those of them that are opposite. REQUIRES: all are held
  // Whether any of the sample's facets are opposite, also where all are held. The answer does not depend on the order of the facets.
  bool sample_has_opposites();

 private:
  static constexpr size_t kWaiting = 16, kLeastTable = 2 * kWaiting, kMost = (size_t{1} << 16) - kWaiting;
  // The lowest bit is the orientation. 0 marks a free place.
  static uint64_t key_of(const std::array<VertexHash, 3>& v) {
    const uint64_t a = v[0].low, b = v[1].low, c = v[2].low;
    const uint64_t turns = uint64_t{FacetKey::is_odd(v)} & uint64_t{a != b} & uint64_t{b != c} & uint64_t{a != c};
    const uint64_t key = (FacetKey::low_of(v) & ~uint64_t{1}) | turns;
    return key | uint64_t{key < 2} << 1;
  }
  size_t place_of(uint64_t key) const { return key >> 1 & (table_.size() - 1); }
  void insert(uint64_t key);
  void take_waiting();
  void grow();
  void rehash(size_t size);
  uint64_t end_of_sample() const;
  void drop_beyond_sample();

  std::vector<uint64_t, Populated<uint64_t>> table_;
  // A facet goes into the table some calls later, when its place has reached the cache. On a large mesh nearly every look-up misses the cache, and
  // waiting for memory took most of the time.
  std::array<uint64_t, kWaiting> waiting_{};
  uint64_t turn_ = 0, added_ = 0, count_ = 0, opposite_ = 0;  // count_: in the table
  uint64_t least_opposite_ = ~uint64_t{0};                    // the least key of which facets are opposite
  bool sample_ = false;
  uint64_t most_ = ~uint64_t{0};  // the sample holds all keys up to this one, which ends in ones: the orientation doesn't matter
};

}  // namespace teracell::mesher
