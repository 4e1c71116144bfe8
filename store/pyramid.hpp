// The pyramid: a coarse cell's set is the union of the sets below it (FORMAT.md, "Grid, rays, levels, chunks"). Pure.
#pragma once
#include "store/run.hpp"

namespace teracell {

// Chunks form a tree across the rays: those of level L + 2 have kFanOut x kFanOut children each, the chunks of level L.
inline constexpr uint32_t kFanOut = 4, kChildren = kFanOut * kFanOut;

// Merges 2^shift x 2^shift rays, and 2^shift cells along them, into one; the last ones of each axis may be partial.
// REQUIRES: shift is 1 (one level) or 2 (two).
Chunk coarsen(const Chunk& fine, int shift);

}  // namespace teracell
