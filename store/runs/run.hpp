// Runs of a block of rays: the one form of cells in memory, from casting to slices.
//
// A ray has two parts. Its *pattern* is the sequence of sets along it (air, steel, air). Its *changes* are the cells where
// the next set begins. Neighbouring rays nearly always have the same pattern, and then their changes correspond: the codec
// predicts, and the pyramid merges, whole stretches of rays without looking at labels.
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "store/grid/label.hpp"

namespace teracell::inline store {

// The number of the run that has a cell, among runs that begin at 0 and at each change. Counting few changes is faster than searching them.
inline uint32_t run_at(std::span<const uint32_t> changes, uint32_t cell) {
  if (cell == 0) return 0;
  if (changes.size() > 32) return static_cast<uint32_t>(std::ranges::upper_bound(changes, cell) - changes.begin());
  uint32_t run = 0;
  for (const uint32_t change : changes) run += change <= cell;
  return run;
}

// The distinct patterns of a block. Consecutive sets of a pattern differ. Not thread-safe.
class PatternTable : public SequenceTable {
 public:
  std::span<const SetId> sets(uint32_t pattern) const { return (*this)[pattern]; }
  uint32_t changes(uint32_t pattern) const { return static_cast<uint32_t>((*this)[pattern].size()) - 1; }
};

// The rays of a block, u fastest: ray = v * nu + u. All have `length` cells.
struct RayBlock {
  uint32_t nu = 0, nv = 0, length = 0;
  PatternTable patterns;
  std::vector<uint32_t> pattern;    // of each ray
  std::vector<uint32_t> begin{0};   // rays + 1: where a ray's changes start in `at`
  std::vector<uint32_t> at;         // ascending within a ray, in (0, length)

  uint32_t rays() const { return nu * nv; }
  std::span<const uint32_t> changes(uint32_t ray) const { return {at.data() + begin[ray], begin[ray + 1] - begin[ray]}; }
  std::span<const SetId> sets(uint32_t ray) const { return patterns.sets(pattern[ray]); }
  SetId set_at(uint32_t ray, uint32_t cell) const { return sets(ray)[run_at(changes(ray), cell)]; }
  // Whether all cells have one set.
  bool uniform() const { return patterns.size() == 1 && at.empty(); }

  // Empties the block for rays of a new shape; rays are then appended in order.
  void reset(uint32_t new_nu, uint32_t new_nv, uint32_t new_length);
  // Makes room for as many changes, where rays are then written in place: `pattern`, `begin` and `at` hold anything but begin[0].
  void reset_in_place(uint32_t new_nu, uint32_t new_nv, uint32_t new_length, size_t changes);
  // Makes it rays of one set.
  void fill(uint32_t new_nu, uint32_t new_nv, uint32_t new_length, SetId set);
  // Appends a ray. REQUIRES: sets.size() == changes.size() + 1, neighbouring sets differ.
  void append(std::span<const SetId> sets, std::span<const uint32_t> changes) {
    const bool again = !pattern.empty() && same(patterns.sets(pattern.back()), sets);
    pattern.push_back(again ? pattern.back() : patterns.intern(sets));
    at.insert(at.end(), changes.begin(), changes.end());
    begin.push_back(static_cast<uint32_t>(at.size()));
  }

  // Calls f(from, to, set) for the runs of `ray`, in order.
  template <class F>
  void for_each_run(uint32_t ray, F&& f) const {
    const std::span<const SetId> s = sets(ray);
    uint32_t from = 0;
    const uint32_t* end = at.data() + begin[ray];
    for (size_t i = 0; i + 1 < s.size(); ++i) {
      f(from, end[i], s[i]);
      from = end[i];
    }
    f(from, length, s.back());
  }
  // The same for the parts of the runs that lie in the cells [lo, hi). REQUIRES: lo < hi <= length.
  template <class F>
  void for_each_run(uint32_t ray, uint32_t lo, uint32_t hi, F&& f) const {
    const std::span<const uint32_t> ends = changes(ray);
    const std::span<const SetId> s = sets(ray);
    size_t i = run_at(ends, lo);
    for (uint32_t from = lo; from < hi; ++i) {
      const uint32_t to = i < ends.size() ? std::min(ends[i], hi) : hi;
      f(from, to, s[i]);
      from = to;
    }
  }
};

// A block with the table of its ids of sets: it depends on nothing else.
struct Chunk {
  RayBlock rays;
  SetTable sets{1};
  // In bytes, with all that it points to.
  size_t memory() const {
    return sizeof *this + rays.patterns.memory() + (rays.pattern.capacity() + rays.begin.capacity() + rays.at.capacity()) * 4 + sets.memory();
  }
};

// Cuts a block into pieces along its rays. Of neighbouring rays with one pattern it knows between which cells each change lies: most pieces have
// all of a change or nothing of it, for all of these rays. (Looking at each ray of each piece took half of the time of a grid of 10^15 cells.)
class SegmentCutter {
 public:
  // Keeps a reference.
  explicit SegmentCutter(const RayBlock& block);
  // The cells [from, to) of every ray, renumbered from 0.
  RayBlock cut(uint32_t from, uint32_t to) const;

 private:
  struct Stretch {
    uint32_t first, end, pattern;  // rays [first, end)
    size_t extremes;               // where those of its changes begin
  };
  const RayBlock& block_;
  std::vector<Stretch> stretches_;
  std::vector<uint32_t> least_, most_;  // of each change of a stretch; they ascend
};
inline RayBlock cut(const RayBlock& block, uint32_t from, uint32_t to) { return SegmentCutter(block).cut(from, to); }

// A chunk as a part of a larger one, in which its first ray and cell are (u, v) and w.
struct Piece {
  uint32_t u, v, w;
  const Chunk* chunk;
};
// Joins pieces that tile a block without gap or overlap. The result has ids of its own.
Chunk join(std::span<const Piece> pieces, uint32_t labels);

}  // namespace teracell::store
