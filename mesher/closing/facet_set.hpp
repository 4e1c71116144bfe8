// The facets of a surface by their vertices: which of them lie on each other.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mesher/closing/vertex_hash.hpp"
#include "store/base/populate.hpp"

namespace teracell::mesher {

// What a set of facets has found. Facets are equal when their three vertices are, in any order. Of equal ones, those are opposite whose orientation
// is not that of the first one; a facet that has a vertex twice has no orientation.
struct EqualFacets {
  uint64_t duplicates = 0;          // facets that are equal to an earlier one
  uint64_t opposite = 0;            // those of them that are opposite
  bool opposite_in_sample = false;  // whether any facets of the sample are opposite, also where all are held; in whatever order facets come
};

// Memory: 10 to 12 bytes for each facet that was expected; up to 24 for others, and twice as much while the set grows or if most facets are equal; or
// 2 to 3 MB for a sample. Not thread-safe.
//
// Facets are hardly ever equal. So each of them marks one bit, which its hash chooses among 8 to 16 per facet that there is room for, and those whose
// bit another one has marked, too, are looked at in the end. (A hash table of all facets has eight times as many bytes as the bits, and was seldom in
// the cache. Where each of two million facets comes twice, the marks took four times as long as the table.)
class FacetSet {
 public:
  // Reserves memory, so that the set need not grow. REQUIRES: the set is empty.
  void expect(uint64_t facets);
  void add(const std::array<VertexHash, 3>& facet) { add(FacetKey::Lows{facet[0].low, facet[1].low, facet[2].low}); }
  void add(const FacetKey::Lows& facet) {
    if (FacetKey::low_of(facet) <= most_) add(key_of(facet));
  }
  void add(uint64_t key) {
    if (key > most_) return;
    if (keys_.size() == room_) make_room();
    keys_.push_back(key);
    if (sample_) return;
    marks_.prefetch(key);
    if (keys_.size() - marked_ > kWaiting) marks_.add(keys_[marked_++]);
  }
  // What a facet is known by. The lowest bit is the orientation.
  static uint64_t key_of(const FacetKey::Lows& v) {
    const uint64_t turns = uint64_t{FacetKey::is_odd(v)} & uint64_t{v[0] != v[1]} & uint64_t{v[1] != v[2]} & uint64_t{v[0] != v[2]};
    return (FacetKey::low_of(v) & ~uint64_t{1}) | turns;
  }
  // The same for some dozens of facets at once, given by key_of().
  void add(std::span<const uint64_t> keys);
  // From now on only a sample of the facets is held, those that were added included: all of a small surface, some 33,000 to 65,000 of a large
  // one. They are chosen by a hash of their vertices, so that the sample holds all facets that are equal, or none of them.
  void keep_sample();
  bool is_sample() const { return sample_; }
  // The facets of another set. REQUIRES: both are samples.
  void add(const FacetSet& other);
  // Empties the set. It stays a sample if it is one.
  void clear();
  // Of a sample, the numbers of duplicates and of opposite facets mean nothing.
  EqualFacets equal();

 private:
  static constexpr size_t kWaiting = 16, kLeastRoom = 32, kMost = (size_t{1} << 16) - 16, kRoomOfSample = size_t{1} << 17;
  // Two facets that are equal have the same bit.
  class Marks {
   public:
    void clear(uint64_t facets, int first_bit);  // `first_bit`: the lowest bit of a key that chooses its mark
    void prefetch(uint64_t key) const { __builtin_prefetch(&seen_[word_of(key)]); }
    void add(uint64_t key) {
      const size_t word = word_of(key);
      if (seen_[word] & bit_of(key)) again_[word] |= bit_of(key);
      seen_[word] |= bit_of(key);
    }
    void add(std::span<const uint64_t> keys);
    bool is_marked_again(uint64_t key) const { return (again_[word_of(key)] & bit_of(key)) != 0; }

   private:
    size_t word_of(uint64_t key) const { return key >> first_bit_ >> 6 & (seen_.size() - 1); }
    uint64_t bit_of(uint64_t key) const { return uint64_t{1} << (key >> first_bit_ & 63); }
    std::vector<uint64_t, Populated<uint64_t>> seen_, again_;
    int first_bit_ = 1;
  };
  void make_room();
  void make_marks();
  std::vector<uint64_t> perhaps_equal();
  struct Found {
    uint64_t duplicates = 0, opposite = 0, end_of_sample = 0;
    uint64_t least_opposite = ~uint64_t{0};  // key of which facets are opposite
  };
  Found find_equal();
  void thin_out();

  std::vector<uint64_t, Populated<uint64_t>> keys_;  // in order of arrival
  size_t room_ = 0;
  // A key is marked some calls later, when its place has reached the cache.
  Marks marks_;
  size_t marked_ = 0;
  bool sample_ = false;
  uint64_t most_ = ~uint64_t{0};  // the sample holds all keys up to this one, which ends in ones: the orientation doesn't matter
  uint64_t least_opposite_ = ~uint64_t{0};  // as in Found, when the sample was thinned out last
};

}  // namespace teracell::mesher
