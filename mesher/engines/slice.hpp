// The slicing algorithm: planes cut the surface, scan lines cut the contours. See slice.cpp.
#pragma once
#include <optional>

#include "mesher/engines/engine.hpp"
#include "mesher/engines/height.hpp"
#include "mesher/engines/rows.hpp"

namespace teracell::mesher {

class SliceEngine : public Engine {
 public:
  void cast(const Tile& tile, std::span<const SceneFacet* const> facets, Crossings& out) override;

 private:
  struct Cut {  // a facet that some plane of the tile cuts
    const SceneFacet* facet;
    FacetRows rows;
    std::optional<FacetHeight> height;  // set once a scan line meets the facet
  };
  struct Segment {  // of a contour: where the plane cuts the facet
    Cut* cut;
    FacetRows::Rays rays;
  };
  void sort_cuts(const Tile& tile, std::span<const SceneFacet* const> facets);
  void cut_plane(const Tile& tile, uint32_t row);
  void scan_contours(const Tile& tile, uint32_t row, Crossings& out);

  std::vector<Cut> cuts_;
  std::vector<uint32_t> first_;      // for each row, and the end: where its cuts begin in sorted_
  std::vector<uint32_t> sorted_;     // indices of the cuts, by their first row
  std::vector<uint32_t> active_;     // indices of the cuts that the current plane may meet
  std::vector<Segment> contours_;    // of the current plane
  std::vector<uint32_t> next_, cells_;
};

}  // namespace teracell::mesher
