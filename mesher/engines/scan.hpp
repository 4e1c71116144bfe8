// Scan conversion: the default engine. See scan.cpp.
#pragma once
#include "mesher/engines/engine.hpp"

namespace teracell::mesher {

class ScanEngine : public Engine {
 public:
  void cast(const Tile& tile, std::span<const SceneFacet* const> facets, Crossings& out) override;

 private:
  struct Span {  // rays [from, to) of a row that cross a facet
    uint32_t facet, row, from, to;
    bool up;
  };
  void find_spans(const Tile& tile, std::span<const SceneFacet* const> facets);
  void find_heights(const Tile& tile, std::span<const SceneFacet* const> facets, Crossings& out);

  std::vector<Span> spans_;
  std::vector<int32_t> counts_;
  std::vector<uint32_t> next_, cells_;
};

}  // namespace teracell::mesher
