// Finds the links of a tile: where, between the sample points of two neighbouring cells with different labels, the one label ends and the other
// begins. The facets are met by the lines through sample points along all three axes, exactly as engines meet them. What is inside at one end
// of a link is known from the tile's own rays, and what is inside behind it from the facets that it crosses. So a tile needs no other one,
// except where cells may belong to bodies that their sample points are not inside of: then it casts the next rays as well.
//
// After M. Bouzidi, M. Firdaouss, P. Lallemand, "Momentum transfer of a Boltzmann-lattice fluid with boundaries" (2001), whose wall distances
// these are; that they are decided exactly is ours.
#pragma once
#include <functional>

#include "mesher/compose/compose.hpp"
#include "mesher/compose/layer_sums.hpp"
#include "mesher/thin/blocks.hpp"
#include "mesher/thin/lines.hpp"
#include "mesher/thin/marker.hpp"
#include "store/channels/links.hpp"

namespace teracell::mesher {

// Not thread-safe.
class LinkFinder {
 public:
  // Keeps references.
  LinkFinder(const Scene& scene, const std::vector<Layer>& layers, const Labels& labels, const Metadata& meta);
  LinkFinder(const LinkFinder&) = delete;

  // The cells of a tile, which is as long as the grid along the rays: their crossings, as the composer leaves them, and their runs.
  struct Cells {
    Box box;
    const Crossings* crossings;
    const RayBlock* runs;
  };
  // The links of the tile's cells with their upper neighbours, in segments of so many cells along the rays, so that memory does not follow
  // their length: calls put(segment, links) in order for segments that may have any; the links are valid during the call. `facets` are those
  // that may matter to the tile.
  using PutLinks = std::function<void(uint32_t segment, const ChunkLinks& links)>;
  void find(const Cells& tile, std::span<const SceneFacet* const> facets, Engine& engine, uint32_t segment_cells, const PutLinks& put);
  uint64_t exact_decisions() const { return exact_decisions_ + marker_.exact_decisions(); }

 private:
  // A facet lies between a cell and the cell `upper` above it on a line: sub-position `k` is the first one above the facet. Or, with kNoFacet,
  // these two cells are to be looked at although no facet may be there.
  struct Crosser {
    uint32_t line, upper, k, facet : 31, up : 1;
  };
  static constexpr uint32_t kNoFacet = ~uint32_t{0} >> 1;
  // A tile, or the rays beside it.
  struct Strip {
    Crossings crossings;
    RayBlock runs;
    Cells cells;
  };
  struct Place {
    const Cells* cells;
    uint32_t ray, w;
  };
  // Goes along a ray: what the sample point of a cell is inside of, and the marks that the cell has.
  struct Walk {
    size_t next = 0;  // crossing
    LayerSums solids;
    std::vector<std::pair<uint32_t, int>> marks;  // by body
  };

  void find_along_rays(const Box& segment, std::span<const SceneFacet* const> facets);
  void find_across(int axis, const Box& segment, const Box& block, std::span<const SceneFacet* const> facets);
  void collect(int axis, const Box& block, std::span<const SceneFacet* const> facets);
  void collect_differences(int axis, const Box& block);
  void sort_by_line(size_t lines);
  void link_up(int axis, const Box& block, uint64_t first_line, std::vector<Link>& out);
  bool look_at(int axis, const Box& block, const Crosser& crosser, Link& link) const;
  bool look_closely(int axis, const Box& block, std::span<const Crosser> crossers, Link& link);
  void change_labels(int axis, Label from, Label to, std::span<const Crosser> crossers, Link& link);
  uint32_t patch_of(std::span<const Crosser> crossers, uint32_t k, uint32_t owner) const;

  void cast_strip(int d, std::span<const SceneFacet* const> facets, Engine& engine);
  Place place_of(const Index3& cell) const;
  const Walk& walk_to(int axis, const Place& place);
  uint32_t owner_at(int axis, const Place& place);
  Label label_of(uint32_t owner) const { return owner == kNoBody ? 0 : labels_.of_body[owner]; }
  bool is_sheet(uint32_t body) const { return scene_.bodies[body].kind == Kind::kSheet; }
  bool is_stronger(uint32_t a, uint32_t b) const { return a != kNoBody && (b == kNoBody || labels_.rank[a] < labels_.rank[b]); }
  int step_of(int axis, const Crosser& c) const;

  const Scene& scene_;
  const Labels& labels_;
  const Grid& grid_;
  const RayFrame rays_;
  const bool has_marks_;  // cells may belong to bodies that their sample points are not inside of
  std::vector<uint32_t> only_patch_;  // of each body that has one patch alone; kNoPatch of the others
  std::array<FacetLines, 3> lines_;
  BlocksAlongRays segments_, blocks_;
  Marker marker_;
  Composer composer_;
  uint64_t exact_decisions_ = 0;

  // Of the tile.
  const Cells* tile_ = nullptr;
  std::array<Strip, 2> strips_;  // the next rays along u and along v; used if has_marks_
  std::array<std::vector<Walk>, 3> walks_;  // for links along each axis: those of the tile's rays, then of the strips'
  ChunkLinks links_;                        // of a segment
  // Of a block, along an axis.
  std::span<const SceneFacet* const> active_;
  Index3 stride_{};  // of the numbers of lines
  std::vector<Crosser> found_, crossers_;
  std::vector<uint32_t> begin_;  // of each line's crossers
  // Of a pair of cells.
  LayerSums point_;
};

}  // namespace teracell::mesher
