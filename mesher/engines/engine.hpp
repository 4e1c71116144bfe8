// What every engine does: find the crossings of the rays of one tile with the facets that may meet it.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "mesher/surface/facet.hpp"
#include "store/grid.hpp"

namespace teracell {

// A facet of the scene: its vertices in the grid's coordinates and the layer that it counts for (compose.hpp).
struct SceneFacet {
  Facet facet;
  uint32_t layer;
};
// Added to a layer: the facet counts for nothing, no engine may see it. It repeats another one (closing.hpp).
inline constexpr uint32_t kIgnored = uint32_t{1} << 30;

// A rectangle of rays. Ray (i, j) passes through u[i], v[j] along frame.w; its cells are those of `axis`.
struct Tile {
  Frame frame;
  std::vector<double> u, v;
  const Axis* axis;
  uint32_t rays() const { return static_cast<uint32_t>(u.size() * v.size()); }
};

// A crossing: from cell `cell` on, the sample points of the ray lie beyond the facet. Packed so that sorting by value
// sorts by cell.
struct Crossing {
  // Of the ends of a stretch that is a body's though no facet is crossed there (marks.hpp).
  static constexpr uint64_t kMark = uint64_t{1} << 31;
  static uint64_t pack(uint64_t cell, uint32_t layer, bool up) { return cell << 32 | uint64_t{layer} << 1 | up; }
  static uint32_t cell(uint64_t c) { return static_cast<uint32_t>(c >> 32); }
  static uint32_t layer(uint64_t c) { return static_cast<uint32_t>(c & (kMark - 1)) >> 1; }
  static bool is_mark(uint64_t c) { return (c & kMark) != 0; }
  static int step(uint64_t c) { return c & 1 ? 1 : -1; }  // to the winding number
};

// The crossings of a tile's rays, by ray (v * nu + u), within a ray in any order. Those below the first sample point
// have cell 0, those above the last one the number of cells: a closed surface is complete on every ray.
struct Crossings {
  std::vector<uint32_t> begin;  // rays + 1
  std::vector<uint64_t> all;
};

// Throws InputError when there are more than a tile may hold; every engine asks before it makes room for them.
void check_crossings(const Tile& tile, uint64_t crossings);

// Not thread-safe: each thread has its own engine, with its own scratch memory.
class Engine {
 public:
  virtual ~Engine() = default;
  // `facets` may hold more than those that meet the tile. REQUIRES: the tile has rays.
  virtual void cast(const Tile& tile, std::span<const SceneFacet* const> facets, Crossings& out) = 0;
  // Whether the engine was made for the whole scene and searches that for every tile, so that cast() needs no facets.
  // Its cost against their number is what it is there for: cast it at every tile, at those that no facet meets too.
  virtual bool searches_scene() const { return false; }
  // How often doubles could not decide and exact arithmetic did.
  uint64_t exact_decisions() const { return exact_decisions_; }

 protected:
  uint64_t exact_decisions_ = 0;
};

}  // namespace teracell
