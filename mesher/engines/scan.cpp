// The default engine: scan conversion of each facet's projection over the rays of a tile.
//
// For each facet and row of rays, two edges are intersected with the row (rows.hpp). Between them every ray crosses the facet,
// at a height that is linear along the row (height.hpp).
//
// There are two passes. The first finds the spans of rays and counts them in a difference array, so that the second can write
// every crossing directly to its ray. On nefertiti at 10^12 cells (26 x 26 rays per facet), a crossing takes about 3.5 ns, half
// of it for the scattered write.
//
// After S. Patil, B. Ravi, "Voxel-based representation, display and thickness analysis of intricate shapes" (2005) and the
// division-free ray casting of T. Ma, T. Ma, L. Hao (MSAM 2020); the error bounds are ours.
#include "mesher/engines/engines.hpp"
#include "mesher/engines/height.hpp"
#include "mesher/engines/rows.hpp"

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
  [[gnu::noinline]] void decide(std::span<const Span> spans, const Tile& tile, const SceneFacet& facet, const FacetHeight& height, Crossings& out);

  std::vector<Span> spans_;  // the first found_ of them
  size_t found_ = 0;
  std::vector<double> u_, v_;  // of the tile, and some more of the last
  std::vector<int32_t> counts_;
  std::vector<uint32_t> next_, cells_;
  std::vector<uint64_t> of_row_;
};

void ScanEngine::cast(const Tile& tile, std::span<const SceneFacet* const> facets, Crossings& out) {
  const uint32_t nu = static_cast<uint32_t>(tile.u.size());
  find_spans(tile, facets);
  // counts_ holds, for each ray and the end of each row, how many spans begin there minus how many end.
  out.begin.resize(tile.rays() + 1);
  uint64_t total = 0;
  for (size_t row = 0; row < tile.v.size(); ++row) {
    int covering = 0;
    for (uint32_t i = 0; i < nu; ++i) {
      covering += counts_[row * (nu + 1) + i];
      out.begin[row * nu + i] = static_cast<uint32_t>(total);
      total += covering;
    }
  }
  check_crossings(tile, total);
  out.begin.back() = static_cast<uint32_t>(total);
  out.all.resize(total);
  next_.assign(out.begin.begin(), out.begin.end() - 1);
  find_heights(tile, facets, out);
}

void ScanEngine::find_spans(const Tile& tile, std::span<const SceneFacet* const> facets) {
  constexpr uint32_t kBlock = 8;  // rows at once
  const RayFinder rays(tile.u), rows(tile.v);
  const size_t stride = tile.u.size() + 1;
  counts_.assign(stride * rows.size(), 0);
  v_.assign(tile.v.begin(), tile.v.end());
  v_.resize(tile.v.size() + kBlock, tile.v.back());
  size_t found = 0;
  on_vector_unit([&, v = v_.data(), counts = counts_.data()]() TERACELL_IN_LINE {
    for (uint32_t index = 0; index < facets.size(); ++index) {
      // Facets come in the order of their heights and lie scattered in memory. Without prefetching, waiting for them took a quarter
      // of the time of this loop.
      constexpr uint32_t kAhead = 8;
      if (index + kAhead < facets.size()) {
        const Facet& coming = facets[index + kAhead]->facet;
        __builtin_prefetch(&coming.vertex[0]);
        __builtin_prefetch(&coming.vertex[2][2]);
      }
      const FacetRows facet(facets[index]->facet, tile.frame, rows);
      const uint32_t end = facet.end();
      if (facet.begin() == end) continue;
      if (spans_.size() < found + tile.v.size()) spans_.resize(2 * (found + tile.v.size()));
      Span* next = spans_.data() + found;
      // Nearly half of the rows of small facets have no ray. They are written over, without a branch.
      const auto add = [&](uint32_t row, const FacetRows::Rays& met) TERACELL_IN_LINE {
        *next = {index, row, met.from, met.to, met.up};
        next += met.from != met.to;
        int32_t* const count = counts + row * stride;
        ++count[met.from];
        --count[met.to];
      };
      const double close = 0.5 - facet.slack(rays);
      for (uint32_t row = facet.begin(); row < end; row += kBlock) {
        uint64_t a[kBlock], b[kBlock];
        const uint32_t count = std::min(end - row, kBlock);
        const double far = count <= kBlock / 2 ? facet.edges<kBlock / 2>(v + row, rays, a, b) : facet.edges<kBlock>(v + row, rays, a, b);
        if (far < close)
          for (uint32_t i = 0; i < count; ++i)
            add(row + i, {static_cast<uint32_t>(std::min(a[i], b[i])), static_cast<uint32_t>(std::max(a[i], b[i])), (a[i] < b[i]) != facet.odd()});
        else
          for (uint32_t i = 0; i < count; ++i) add(row + i, facet.at(row + i, v[row + i], rays, exact_decisions_));
      }
      found = static_cast<size_t>(next - spans_.data());
    }
  });
  found_ = found;
}

void ScanEngine::find_heights(const Tile& tile, std::span<const SceneFacet* const> facets, Crossings& out) {
  const size_t nu = tile.u.size();
  u_.assign(tile.u.begin(), tile.u.end());
  u_.resize(nu + FacetHeight::kBlock, tile.u.back());
  cells_.resize(nu);
  of_row_.resize(nu + FacetHeight::kBlock);
  on_vector_unit([&, nu, all = out.all.data(), next = next_.data(), of_row = of_row_.data()]() TERACELL_IN_LINE {
    for (size_t first = 0, s; first < found_; first = s) {
      const uint32_t index = spans_[first].facet;
      const SceneFacet& facet = *facets[index];
      const FacetHeight height(facet.facet, tile.frame, *tile.axis);
      const bool plain = height.is_plain();
      FacetHeight::Far far{};
      for (s = first; s < found_ && spans_[s].facet == index; ++s) {
        const Span& span = spans_[s];
        const uint32_t size = span.to - span.from;
        const uint64_t rest = Crossing::pack(0, facet.layer, span.up);
        if (plain) height.plain_crossings(u_.data() + span.from, size, tile.v[span.row], rest, of_row, far);
        uint32_t* const place = next + span.row * nu + span.from;
        for (uint32_t i = 0; i < size; ++i) all[place[i]++] = of_row[i];
      }
      if (!plain || height.is_close(far)) decide({spans_.data() + first, s - first}, tile, facet, height, out);
    }
  });
}

// Writes over the crossings of a facet, which are the last ones that its rays have so far, what exact arithmetic decides where doubles can't.
void ScanEngine::decide(std::span<const Span> spans, const Tile& tile, const SceneFacet& facet, const FacetHeight& height, Crossings& out) {
  for (const Span& span : spans) {
    const std::span<const double> u(tile.u.data() + span.from, span.to - span.from);
    height.first_cells(u, tile.v[span.row], cells_.data(), exact_decisions_);
    const uint32_t* const behind = next_.data() + span.row * tile.u.size() + span.from;
    const uint64_t rest = Crossing::pack(0, facet.layer, span.up);
    for (uint32_t i = 0; i < u.size(); ++i) out.all[behind[i] - 1] = uint64_t{cells_[i]} << 32 | rest;
  }
}

namespace {

EngineMaker scan_maker(const RayFrame&, const AllFacets&) {
  return [] { return std::make_unique<ScanEngine>(); };
}

}  // namespace

const EngineKind kScanEngine = {"scan", false, scan_maker};

}  // namespace teracell::mesher
