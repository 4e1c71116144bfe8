// Scan conversion: the default engine. See scan.cpp.
#pragma once
#include "mesher/engine.hpp"

namespace teracell {

class ScanEngine : public Engine {
 public:
  void cast(const Tile& tile, std::span<const SceneFacet* const> facets, Crossings& out) override;

 private:
  class Edge;
  struct Plane;
  struct Span {  // rays [from, to) of a row that cross a facet
    uint32_t facet, row, from, to;
    bool up;  // the facet turns left in (u, v): its sign for the winding number
  };
  void find_spans(const Tile& tile, std::span<const SceneFacet* const> facets);
  void find_heights(const Tile& tile, std::span<const SceneFacet* const> facets, Crossings& out);
  void cells_of_span(const Tile& tile, const Facet& facet, const Plane& plane, const Span& span);

  std::vector<Span> spans_;
  std::vector<int32_t> counts_;
  std::vector<uint32_t> next_, cells_;
};

}  // namespace teracell
