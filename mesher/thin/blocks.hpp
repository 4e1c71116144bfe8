// A tile in blocks along its rays, each with the facets that may cross its lines or intervals.
#pragma once
#include "mesher/tiles/rays.hpp"

namespace teracell::mesher {

// Not thread-safe: it keeps scratch memory.
class BlocksAlongRays {
 public:
  // Calls f(cells, facets) for the blocks of `cells` that have facets. A block has `length` cells along the rays. With `neighbours`, facets matter to
  // the cells beside those that they cross. The facets of `facets` that are wanted(facet) come in the same order in each block.
  template <class Wanted, class F>
  void for_each(const Grid& grid, const Box& cells, int w, std::span<const SceneFacet* const> facets, int64_t length, bool neighbours,
                Wanted&& wanted, F&& f) {
    const RayBounds finder(grid.axis[w]);
    reaches_.clear(), active_.clear();
    for (const SceneFacet* facet : facets) {
      if (!wanted(*facet)) continue;
      const auto& [a, b, c] = facet->facet.vertex;
      const int64_t first = finder.first(std::min(std::min(a[w], b[w]), c[w])), last = finder.last(std::max(std::max(a[w], b[w]), c[w]));
      const Reach reach{std::max(first - neighbours, cells.lo[w]), last + 1 + neighbours, facet};
      if (reach.end > cells.lo[w] && reach.first < cells.hi[w]) reaches_.push_back(reach);
    }
    std::ranges::stable_sort(reaches_, {}, &Reach::first);
    const int64_t begin = cells.lo[w], end = cells.hi[w];
    auto next = reaches_.begin();
    for (int64_t from = begin; from < end; from += length) {
      std::erase_if(active_, [&](const Reach& r) { return r.end <= from; });
      if (active_.empty()) {
        if (next == reaches_.end()) return;
        from = std::max(from, begin + (next->first - begin) / length * length);
      }
      for (; next != reaches_.end() && next->first < from + length; ++next) active_.push_back(*next);
      Box block = cells;
      block.lo[w] = from, block.hi[w] = std::min(from + length, end);
      if (block.empty()) continue;
      facets_.clear();
      for (const Reach& r : active_) facets_.push_back(r.facet);
      f(block, std::span<const SceneFacet* const>(facets_));
    }
  }

 private:
  // A facet, and the cells along the rays whose intervals or lines it may cross: [first, end).
  struct Reach {
    int64_t first, end;
    const SceneFacet* facet;
  };
  std::vector<Reach> reaches_, active_;
  std::vector<const SceneFacet*> facets_;
};

}  // namespace teracell::mesher
