// The slicing algorithm: planes cut the surface, scan lines cut the contours. See slice.cpp.
#pragma once
#include <optional>

#include "mesher/engines/engine.hpp"
#include "mesher/engines/height.hpp"
#include "mesher/engines/rows.hpp"

namespace teracell {

class SliceEngine : public Engine {
 public:
  void cast(const Tile& tile, std::span<const SceneFacet* const> facets, Crossings& out) override;

 private:
  struct Cut {  // a facet that some plane of the tile cuts
    const SceneFacet* facet;
    FacetRows rows;
    std::optional<FacetHeight> height;  // once a scan line meets it
  };
  struct Segment {  // of a contour: where the plane cuts the facet
    Cut* cut;
    FacetRows::Rays rays;
  };
  void sort_cuts(const Tile& tile, std::span<const SceneFacet* const> facets);
  void cut_plane(const Tile& tile, uint32_t row);
  void scan_contours(const Tile& tile, uint32_t row, Crossings& out);

  std::vector<Cut> cuts_;
  std::vector<uint32_t> first_;      // of each row and the end: where its cuts start in sorted_
  std::vector<uint32_t> sorted_;     // numbers of cuts, by the first row
  std::vector<uint32_t> active_;     // numbers of the cuts that the present plane may meet
  std::vector<Segment> contours_;    // of the present plane
  std::vector<uint32_t> next_, cells_;
};

}  // namespace teracell
