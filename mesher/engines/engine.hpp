// The interface of all engines. An engine finds the crossings of the rays of one tile with the facets that may meet the tile.
#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "mesher/surface/facet.hpp"
#include "store/base/populate.hpp"
#include "store/grid/grid.hpp"

namespace teracell::mesher {

// A facet of the scene: its vertices in the coordinates of the grid, the layer that it belongs to (compose.hpp), and where it is wanted the
// number of its patch (patches.hpp).
struct SceneFacet {
  Facet facet;
  uint32_t layer;
  uint32_t patch;  // without a value of its own: that would touch each page of a new piece of a FacetStore
};
static_assert(sizeof(SceneFacet) == 80);
// Added to the patch of a facet that is not in its body's file but closes it.
inline constexpr uint32_t kAddedFacet = uint32_t{1} << 31;
// Added to the layer of a facet that repeats another one (closing.hpp): it counts for nothing, and no engine may see it.
inline constexpr uint32_t kIgnored = uint32_t{1} << 30;

// A rectangle of rays. Ray (i, j) passes through (u[i], v[j]) along frame.w; its cells are those of `axis`.
struct Tile {
  RayFrame frame;
  std::vector<double> u, v;
  const Axis* axis;
  uint32_t rays() const { return static_cast<uint32_t>(u.size() * v.size()); }
};

// A crossing: from `cell` on, the sample points of the ray lie above the facet. It is packed into an integer, so that sorting
// the integers sorts by cell.
struct Crossing {
  // Set at both ends of a stretch that belongs to a body although no facet is crossed there (marks.hpp).
  static constexpr uint64_t kMark = uint64_t{1} << 31;
  static uint64_t pack(uint64_t cell, uint32_t layer, bool up) { return cell << 32 | uint64_t{layer} << 1 | up; }
  static uint32_t cell(uint64_t c) { return static_cast<uint32_t>(c >> 32); }
  static uint32_t layer(uint64_t c) { return static_cast<uint32_t>(c & (kMark - 1)) >> 1; }
  static bool is_mark(uint64_t c) { return (c & kMark) != 0; }
  static int step(uint64_t c) { return c & 1 ? 1 : -1; }  // of the winding number
};

// The crossings of a tile's rays, by ray (v * nu + u), in any order within a ray. A crossing below the first sample point has
// cell 0, and one above the last sample point has the number of cells. So every ray has all its crossings of a closed surface.
struct Crossings {
  std::vector<uint32_t> begin;  // where each ray's crossings begin in `all`, and where the last ones end
  std::vector<uint64_t> all;
  std::span<const uint64_t> of_ray(uint32_t ray) const { return {all.data() + begin[ray], begin[ray + 1] - begin[ray]}; }
};

// The crossings of a tile's rays, plane by plane: of each ray the one that was found first, then of each the one that was found second, and so on.
// Rays side by side mostly cross the same facets in the same order, so whole vectors are written and read.
struct CrossingPlanes {
  static constexpr size_t kMost = 255, kMostPlaces = size_t{1} << 22;  // at most so many crossings of a ray, and places of all planes, fit
  static constexpr size_t kMore = 8;                                   // places behind the last ray, which have no meaning
  static constexpr uint32_t kUp = uint32_t{1} << 30;                   // more than cells that an axis may have
  std::vector<uint8_t> counts;                                         // of each ray (v * nu + u), its crossings
  size_t stride = 0;                                                   // from a plane to the next
  UnfilledVector<uint32_t> cells;                                      // of crossing k of a ray, at k * stride + ray; + kUp, if it goes up
  std::optional<uint32_t> layer_of_all;                                // if all crossings have one layer; else that of each stands in `layers`
  UnfilledVector<uint32_t> layers;

  // Empties the planes for so many rays.
  void reset(size_t rays, std::optional<uint32_t> one_layer) {
    stride = rays + kMore;
    counts.assign(stride, 0);
    layer_of_all = one_layer;
    if (!layer_of_all && layers.size() < cells.size()) layers.resize(cells.size());
    planes_ = std::min(cells.size() / stride, most());
  }
  size_t planes() const { return planes_; }  // that there is room for
  size_t most() const { return std::min(kMost, kMostPlaces / stride); }
  // Adds a crossing to a ray. Returns false if it doesn't fit.
  bool add(size_t ray, uint32_t cell_and_up, uint32_t of_layer) {
    const size_t k = counts[ray];
    if (k == most()) return false;
    if (k == planes_) {
      planes_ = std::min(2 * planes_ + 2, most());
      cells.resize(planes_ * stride);
      if (!layer_of_all) layers.resize(planes_ * stride);
    }
    ++counts[ray];
    cells[k * stride + ray] = cell_and_up;
    if (!layer_of_all) layers[k * stride + ray] = of_layer;
    return true;
  }
  uint64_t crossing(size_t ray, uint32_t k) const {
    const size_t at = k * stride + ray;
    return Crossing::pack(cells[at] & ~kUp, layer_of_all ? *layer_of_all : layers[at], (cells[at] & kUp) != 0);
  }
  // Appends the crossings of a ray to others.
  void append(size_t ray, std::vector<uint64_t>& out) const {
    for (uint32_t k = 0; k < counts[ray]; ++k) out.push_back(crossing(ray, k));
  }

 private:
  size_t planes_ = 0;
};

// Throws InputError when there are more crossings than a tile may hold. Every cast() calls it before it holds many more than that.
void check_crossings(const Tile& tile, uint64_t crossings);

// Not to be shared by threads: each thread has an engine of its own, with its own scratch memory.
class Engine {
 public:
  virtual ~Engine() = default;
  // `facets` hold all facets that meet the tile, and may hold others. REQUIRES: the tile has rays.
  virtual void cast(const Tile& tile, std::span<const SceneFacet* const> facets, Crossings& out) = 0;
  // The same, plane by plane, for engines that can and tiles whose rays have no more crossings than fit. For others it returns false, and `out` has
  // no meaning.
  virtual bool cast_planes(const Tile&, std::span<const SceneFacet* const>, CrossingPlanes&) { return false; }
  // Whether the engine was made for all facets of the scene and searches them for every tile, so that cast() ignores its facets.
  // Such an engine shows what that search costs: call cast() for every tile, also for those that no facet meets.
  virtual bool searches_scene() const { return false; }
  // How often doubles were not accurate enough and exact arithmetic decided.
  uint64_t exact_decisions() const { return exact_decisions_; }

 protected:
  uint64_t exact_decisions_ = 0;
};

// Makes engines, one for each thread. What the engines share lives as long as the maker or any of the engines. Threads may call
// it at the same time.
using EngineMaker = std::function<std::unique_ptr<Engine>()>;

// Returns all facets of the scene. Only engines that search the scene call it.
using AllFacets = std::function<std::vector<const SceneFacet*>()>;

// What an engine's file defines. engines.hpp lists all of them.
struct EngineKind {
  const char* name;  // of the option --engine
  bool searches_scene;  // whether the maker calls `all_facets`
  // A maker of engines for rays of `frame`. It calls `all_facets` at most once, before it returns; the facets outlive the engines.
  EngineMaker (*maker)(const RayFrame& frame, const AllFacets& all_facets);
};

}  // namespace teracell::mesher
