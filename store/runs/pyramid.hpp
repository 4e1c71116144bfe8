// The pyramid: a coarse cell's set is the union of the sets below it (FORMAT.md, "Grid, rays, levels, chunks"). Pure.
#pragma once
#include <memory>

#include "store/runs/run.hpp"

namespace teracell::inline store {

// Chunks form a tree across the rays: those of level L + 2 have kFanOut x kFanOut children each, the chunks of level L.
inline constexpr int kFanOutBits = 2;
inline constexpr uint32_t kFanOut = 1 << kFanOutBits, kChildren = kFanOut * kFanOut;

// The order of the tree, for chunks of level 2: a key has a digit in base kChildren for each level, the highest first: the place of
// the node among its parent's children, which are numbered row by row. Chunks side by side have consecutive keys, except at the grid's edge.
uint64_t tree_key(uint32_t cu, uint32_t cv);

// A stretch of the tree: the chunks of level 2 with keys from `first` on and below `end`, and all that is above and below them.
struct TreeRange {
  uint64_t first = 0, end = ~uint64_t{0};
  // Of node (cu, cv), `height` levels of the tree above the chunks of level 2: whether all of it, or any of it, is in this stretch.
  bool has_all(int height, uint32_t cu, uint32_t cv) const;
  bool has_any(int height, uint32_t cu, uint32_t cv) const;
  friend bool operator==(const TreeRange&, const TreeRange&) = default;
};

// Merges 2^shift x 2^shift rays, and 2^shift cells along them, into one; the last ones of each axis may be partial.
// REQUIRES: shift is 1 (one level) or 2 (two).
Chunk coarsen(const Chunk& fine, int shift);

// The same again and again, with memory that is used anew: for a grid's many chunks. Not thread-safe.
class Coarsener {
 public:
  Coarsener();
  ~Coarsener();
  Chunk coarsen(const Chunk& fine, int shift);

 private:
  class Ray;
  std::unique_ptr<Ray> ray_;
};

}  // namespace teracell::store
