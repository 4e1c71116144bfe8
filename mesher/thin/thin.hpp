// Finds what is lost between sample points. On a line through sample points, an *interval* lies between two neighbouring ones. A
// stretch of a body is lost in an interval when some sub-position (tally.hpp) is inside the body and neither end of the interval
// is. A gap in a material is lost when both ends have the material and some sub-position is in no body. Only intervals that facets
// cross at least twice can lose anything. They are found by casting the facets along all three axes. The crossings of the tile's
// own rays tell what is inside at one end of an interval, and the interval's crossings what is inside at the other. So no tile
// needs another one.
//
// A body that keeps its thin parts gets the cell that holds the first sub-position of a lost stretch. So a plate thinner than a
// cell has no hole where it crosses the lines. A part that crosses no line stays lost.
#pragma once
#include "mesher/compose/layer_sums.hpp"
#include "mesher/scene/labels.hpp"
#include "mesher/thin/blocks.hpp"
#include "mesher/thin/lines.hpp"
#include "mesher/thin/marks.hpp"
#include "mesher/thin/tally.hpp"

namespace teracell::mesher {

// Not thread-safe.
class ThinParts {
 public:
  // Keeps references. Examines bodies with Thin::kKeep; with `count_all` all solids, and gaps as well.
  ThinParts(const Scene& scene, const Labels& labels, const Grid& grid, int ray_axis, bool count_all);
  ThinParts(const ThinParts&) = delete;
  static bool wanted(const SceneBody& body, bool count_all) { return body.kind == Kind::kSolid && (count_all || body.thin == Thin::kKeep); }
  // Examines the intervals in and beside a tile, which is as long as the grid along the rays. An interval is tallied by the tile
  // of its lower cell. `facets` are those of solids that may lie there, `crossings` those of the tile's rays.
  void find(const Box& tile, std::span<const SceneFacet* const> facets, const Crossings& crossings, Marks& marks, Tallies& tallies);
  uint64_t exact_decisions() const { return exact_decisions_; }

 private:
  // A facet crosses an interval of the block; k: the first sub-position above it.
  struct Crosser {
    uint32_t interval, facet, k;
    bool up;
    friend auto operator<=>(const Crosser&, const Crosser&) = default;
  };
  // In an interval: at sub-position k the layer's sum changes by `step`.
  struct Step {
    uint32_t k, layer;
    int step;
  };
  // Where the first stretch of sub-positions begins, and where the widest one begins and how wide it is.
  struct Stretches {
    uint32_t first = 0, from = 0, widest = 0;
  };

  void find_along(int axis, const Box& cells);
  void look_at(int axis, const Index3& upper, std::span<const Crosser> crossers);
  void sum_crossings(const Index3& cell);
  uint32_t material(const LayerSums& sums) const;
  template <class Is>
  Stretches stretches(Is&& is);
  void keep(int axis, const Index3& lower, uint32_t k, uint32_t body);
  uint32_t ray_of(const Index3& cell) const;

  const Scene& scene_;
  const Labels& labels_;
  const Grid& grid_;
  const RayFrame rays_;
  const bool count_all_;
  std::array<FacetLines, 3> lines_;
  uint64_t exact_decisions_ = 0;

  // Of the tile.
  Box tile_;
  const Crossings* crossings_ = nullptr;
  Marks* marks_ = nullptr;
  Tallies* tallies_ = nullptr;
  BlocksAlongRays blocks_;
  // Of a block.
  std::span<const SceneFacet* const> active_;
  // Of a block, along an axis.
  std::vector<uint64_t> once_, twice_;  // bit: the interval is crossed
  std::vector<Crosser> crossers_;
  // Of an interval.
  LayerSums lower_, upper_, sums_;
  std::vector<Step> steps_;
  std::vector<uint32_t> bodies_;
};

}  // namespace teracell::mesher
