// The default engine: scan conversion of each facet's projection over the rays of a tile.
//
// For each facet and row of rays, two edges are intersected with the row (rows.hpp). Between them every ray crosses the facet,
// at a height that is linear along the row (height.hpp).
//
// There are two passes. The first prepares some facets side by side (facet_lanes.hpp), finds the spans of rays, and counts them in a difference
// array, so that the second can write every crossing directly to its ray. On nefertiti at 10^12 cells (26 x 26 rays per facet),
// a crossing takes about 3.5 ns, half of it for the scattered write. The many rays of sub-samples are cast plane by plane, where rays side by side
// are written as vectors.
//
// After S. Patil, B. Ravi, "Voxel-based representation, display and thickness analysis of intricate shapes" (2005) and the
// division-free ray casting of T. Ma, T. Ma, L. Hao (MSAM 2020); the error bounds are ours.
#include <bit>
#include <optional>

#include "mesher/engines/engines.hpp"
#include "mesher/engines/facet_lanes.hpp"

namespace teracell::mesher {

class ScanEngine : public Engine {
 public:
  void cast(const Tile& tile, std::span<const SceneFacet* const> facets, Crossings& out) override;
  bool cast_planes(const Tile& tile, std::span<const SceneFacet* const> facets, CrossingPlanes& out) override;

 private:
  struct Span {  // rays [from, to) of a row that cross a facet, in two words as LaneRows::rays_of() writes them
    uint64_t of, rays;
    static uint64_t pack(uint32_t facet, uint32_t row, bool up) { return uint64_t{facet} << 32 | row << 1 | up; }
    uint32_t facet() const { return static_cast<uint32_t>(of >> 32); }
    uint32_t row() const { return static_cast<uint32_t>(of) >> 1; }
    bool up() const { return (of & 1) != 0; }
    uint32_t from() const { return static_cast<uint32_t>(rays); }
    uint32_t to() const { return static_cast<uint32_t>(rays >> 32); }
    uint32_t size() const { return to() - from(); }
    uint32_t first_ray(const Tile& tile) const { return row() * static_cast<uint32_t>(tile.u.size()) + from(); }
  };
  void find_spans(const Tile& tile, std::span<const SceneFacet* const> facets, const CellUnits& cells, bool counted);
  void find_heights(const Tile& tile, std::span<const SceneFacet* const> facets, const CellUnits& cells, Crossings& out);
  void take_u(const Tile& tile);
  template <class TakeBack, class Spread>
  [[gnu::noinline]] void decide(std::span<const Span> spans, const Tile& tile, std::span<const SceneFacet* const> facets, const LaneHeights& heights,
                                const TakeBack& take_back, const Spread& spread);

  std::vector<LaneHeights> heights_;  // of the first blocks of facets
  std::vector<Span> spans_;  // the first found_ of them
  size_t found_ = 0;
  std::vector<double> u_, v_;  // of the tile, and some more of the last
  std::vector<int32_t> counts_;
  std::vector<uint32_t> next_, cells_;
  std::vector<uint64_t> crossings_;  // of some spans, and the ray of each
  std::vector<uint32_t> rays_;
};

void ScanEngine::cast(const Tile& tile, std::span<const SceneFacet* const> facets, Crossings& out) {
  const uint32_t nu = static_cast<uint32_t>(tile.u.size());
  const CellUnits cells(*tile.axis);
  find_spans(tile, facets, cells, true);
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
  find_heights(tile, facets, cells, out);
}

// Finds spans_, and heights_ of so many blocks as a tile mostly has; fills counts_ if `counted`.
void ScanEngine::find_spans(const Tile& tile, std::span<const SceneFacet* const> facets, const CellUnits& cells, bool counted) {
  constexpr uint32_t kFacets = FacetLanes::kFacets, kMostRows = 8, kRoom = 256;
  const RayFinder rays(tile.u), rows(tile.v);
  const size_t stride = tile.u.size() + 1;
  if (counted) counts_.assign(stride * rows.size(), 0);
  v_.assign(tile.v.begin(), tile.v.end());
  v_.resize(tile.v.size() + kMostRows, tile.v.back());
  size_t found = 0;
  heights_.clear();
  constexpr size_t kMostKept = 1024;
  heights_.reserve(std::min(kMostKept, (facets.size() + kFacets - 1) / kFacets));
  on_vector_unit([&, v = v_.data(), counts = counts_.data(), last_row = uint64_t{rows.size() - 1}]() TERACELL_IN_LINE {
    // Rows are gathered first, since facets meet different numbers of them: a loop over those of each would end where no processor expects it.
    uint64_t of[kRoom], met[kRoom];
    uint32_t gathered = 0;
    const auto add_gathered = [&]() TERACELL_IN_LINE {
      if (spans_.size() < found + kRoom) spans_.resize(2 * (found + kRoom));
      Span* next = spans_.data() + found;
      for (uint32_t k = 0, n = gathered; k < n; ++k) {
        const Span span = {of[k], met[k]};
        *next = span;
        next += span.from() != span.to();  // nearly a third of the rows of small facets have no ray
        if (!counted) continue;
        int32_t* const count = counts + span.row() * stride;
        ++count[span.from()];
        --count[span.to()];
      }
      found = static_cast<size_t>(next - spans_.data());
      gathered = 0;
    };
    const auto gather_exactly = [&](uint32_t index, uint32_t begin, uint32_t end) {
      const FacetRows facet(facets[index]->facet, tile.frame, rows);
      for (uint32_t row = std::max(begin, facet.begin()); row < std::min(end, facet.end()); ++row) {
        const FacetRows::Rays r = facet.at(row, v[row], rays, exact_decisions_);
        of[gathered] = Span::pack(index, row, r.up), met[gathered] = uint64_t{r.to} << 32 | r.from;
        if (++gathered > kRoom - kMostRows) add_gathered();
      }
    };
    // Facet i of a block, so many rows at once.
    const auto gather = [&]<uint32_t kRows>(const LaneRows& block, uint32_t i, uint32_t index) TERACELL_IN_LINE {
      const auto end = static_cast<uint32_t>(block.end[i]);
      for (auto row = static_cast<uint32_t>(block.begin[i]); row < end; row += kRows) {
        if (block.rays_of<kRows>(i, v + row, Span::pack(index, row, false), rays, of + gathered, met + gathered))
          gathered += std::min(end - row, kRows);
        else gather_exactly(index, row, row + kRows);
        if (gathered > kRoom - kMostRows) add_gathered();
      }
    };
    // Facets i to i + kWidth - 1 of a block, a row of each at once.
    const auto gather_each = [&](LaneRows& block, uint32_t i, uint32_t index, uint64_t most) TERACELL_IN_LINE {
      for (uint64_t r = 0; r < most; ++r) {
        double at[FacetLanes::kWidth];
        for (size_t j = 0; j < FacetLanes::kWidth; ++j) at[j] = v[std::min(block.begin[i + j] + r, last_row)];
        if (block.rays_of_each(i, r, at, Span::pack(index, 0, false), rays, of + gathered, met + gathered)) {
          gathered += FacetLanes::kWidth;
        } else {
          for (uint32_t j = 0; j < FacetLanes::kWidth; ++j)
            if (const uint64_t row = block.begin[i + j] + r; row < block.end[i + j])
              gather_exactly(index + j, static_cast<uint32_t>(row), static_cast<uint32_t>(row) + 1);
        }
        if (gathered > kRoom - kMostRows) add_gathered();
      }
    };
    const bool two_lanes = vector_unit == VectorUnit::kPlain;
    for (uint32_t first = 0; first < facets.size(); first += kFacets) {
      // Facets come in the order of their heights and lie scattered in memory. Without prefetching, waiting for them took a quarter
      // of the time of this loop.
      for (size_t i = first + kFacets; i < std::min<size_t>(first + 2 * kFacets, facets.size()); ++i) {
        const Facet& coming = facets[i]->facet;
        __builtin_prefetch(&coming.vertex[0]);
        __builtin_prefetch(&coming.vertex[2][2]);
      }
      const FacetLanes lanes(facets.subspan(first), tile.frame);
      if (heights_.size() < kMostKept) heights_.emplace_back(lanes, cells);
      LaneRows block(lanes, rays, rows);
      const auto here = static_cast<uint32_t>(std::min<size_t>(kFacets, facets.size() - first));
      for (uint32_t from = 0; from < here; from += FacetLanes::kWidth) {
        const uint32_t to = std::min(from + FacetLanes::kWidth, here);
        uint64_t most = 0;
        for (uint32_t i = from; i < to; ++i) {
          if (block.is_sure[i] == 0) gather_exactly(first + i, 0, rows.size()), block.begin[i] = block.end[i] = 0;
          most = std::max(most, block.end[i] - block.begin[i]);
        }
        if (most < FacetLanes::kWidth && !two_lanes && to == from + FacetLanes::kWidth) {
          gather_each(block, from, first + from, most);
          continue;
        }
        for (uint32_t i = from; i < to; ++i) {
          if (two_lanes) gather.template operator()<2>(block, i, first + i);
          else gather.template operator()<kMostRows>(block, i, first + i);
        }
      }
    }
    add_gathered();
  });
  found_ = found;
}

void ScanEngine::take_u(const Tile& tile) {
  u_.assign(tile.u.begin(), tile.u.end());
  u_.resize(tile.u.size() + LaneHeights::kRays, tile.u.back());
  cells_.resize(tile.u.size() + LaneHeights::kRays);
}

void ScanEngine::find_heights(const Tile& tile, std::span<const SceneFacet* const> facets, const CellUnits& cells, Crossings& out) {
  constexpr size_t kFacets = FacetLanes::kFacets, kRays = LaneHeights::kRays;
  const size_t room = std::max<size_t>(192, tile.u.size()) + kRays;
  take_u(tile);
  crossings_.resize(room), rays_.resize(room);
  const bool wide = out.all.size() > 6 * found_;
  on_vector_unit([&, wide, all = out.all.data(), next = next_.data(), crossings = crossings_.data(), rays = rays_.data()]() TERACELL_IN_LINE {
    for (size_t s = 0; s < found_;) {
      const size_t block = spans_[s].facet() / kFacets;
      std::optional<LaneHeights> made;
      const LaneHeights& heights =
          block < heights_.size() ? heights_[block] : made.emplace(FacetLanes(facets.subspan(block * kFacets), tile.frame), cells);
      const auto cross = [&](const Span& span, uint64_t* to, LaneHeights::Far& far) TERACELL_IN_LINE {
        heights.cross(span.facet() % kFacets, u_.data() + span.from(), span.size(), tile.v[span.row()], span.up(), to, far);
      };
      while (s < found_ && spans_[s].facet() / kFacets == block) {
        const size_t first = s;
        LaneHeights::Far far{};
        if (wide) {  // of one facet
          for (const uint32_t facet = spans_[s].facet(); s < found_ && spans_[s].facet() == facet; ++s) {
            const Span span = spans_[s];
            cross(span, crossings, far);
            uint32_t* const place = next + span.first_ray(tile);
            for (uint32_t i = 0, size = span.size(); i < size; ++i) all[place[i]++] = crossings[i];
          }
        } else {  // of several facets, gathered before they are spread, as rows were
          size_t gathered = 0;
          for (; s < found_; ++s) {
            const Span span = spans_[s];
            if (span.facet() / kFacets != block || gathered + span.size() + kRays > room) break;
            cross(span, crossings + gathered, far);
            const uint32_t ray = span.first_ray(tile);
            const size_t size = span.size();
            for (size_t k = 0; k < size; k += kRays)
#pragma GCC unroll 1
              for (size_t j = 0; j < kRays; ++j) rays[gathered + k + j] = ray + static_cast<uint32_t>(k + j);
            gathered += size;
          }
          for (size_t k = 0; k < gathered; ++k) all[next[rays[k]]++] = crossings[k];
        }
        if (LaneHeights::is_close(far))
          decide(
              {&spans_[first], s - first}, tile, facets, heights, [&](uint32_t ray) { --next_[ray]; },
              [&](uint32_t ray, uint64_t crossing) { out.all[next_[ray]++] = crossing; });
      }
    }
  });
}

bool ScanEngine::cast_planes(const Tile& tile, std::span<const SceneFacet* const> facets, CrossingPlanes& out) {
  constexpr size_t kFacets = FacetLanes::kFacets, kRays = LaneHeights::kRays;
  using Words [[gnu::vector_size(kRays * sizeof(uint64_t))]] = uint64_t;
  using Lanes [[gnu::vector_size(kRays * sizeof(uint32_t))]] = uint32_t;
  static_assert(kRays == sizeof(uint64_t) && kRays <= CrossingPlanes::kMore);  // the counts of a block are one word
  constexpr uint64_t kOfEach = 0x0101010101010101;
  if (std::endian::native != std::endian::little) return false;  // the first ray's count is in the lowest byte
  if (facets.empty() || tile.axis->cells() >= CrossingPlanes::kUp) return false;
  const uint32_t layer = facets[0]->layer;
  const bool one_layer = std::ranges::all_of(facets, [&](const SceneFacet* f) { return f->layer == layer; });
  const uint64_t exact_before = exact_decisions_;
  const CellUnits cells(*tile.axis);
  find_spans(tile, facets, cells, false);
  take_u(tile);
  crossings_.resize(tile.u.size() + kRays);
  out.reset(tile.rays(), one_layer ? std::optional(layer) : std::nullopt);
  bool fits = true;
  on_vector_unit([&, one_layer, u = u_.data(), found_cells = crossings_.data(), stride = out.stride]() TERACELL_IN_LINE {
    for (size_t s = 0; s < found_ && fits;) {
      const size_t block = spans_[s].facet() / kFacets;
      std::optional<LaneHeights> made;
      const LaneHeights& heights =
          block < heights_.size() ? heights_[block] : made.emplace(FacetLanes(facets.subspan(block * kFacets), tile.frame), cells);
      while (s < found_ && spans_[s].facet() / kFacets == block) {
        const size_t first = s;
        LaneHeights::Far far{};
        for (const uint32_t facet = spans_[s].facet(); s < found_ && spans_[s].facet() == facet; ++s) {
          const Span span = spans_[s];
          const size_t ray = span.first_ray(tile), size = span.size();
          heights.cells(facet % kFacets, u + span.from(), size, tile.v[span.row()], span.up() ? CrossingPlanes::kUp : 0, found_cells, far);
          const uint32_t of_layer = facets[facet]->layer;
          uint8_t* const counts = out.counts.data() + ray;
          // Where all rays of a block have found as many crossings, the next ones lie in one plane, side by side.
          const auto put = [&](size_t k, size_t here, uint64_t valid, const auto& write) TERACELL_IN_LINE {
            uint64_t found;
            __builtin_memcpy(&found, counts + k, sizeof found);
            const uint64_t plane = found & 0xff;
            if (((found ^ plane * kOfEach) & valid) != 0 || plane >= out.planes()) {
              for (size_t j = 0; j < here; ++j) fits &= out.add(ray + k + j, static_cast<uint32_t>(found_cells[k + j]), of_layer);
              return;
            }
            found += kOfEach & valid;
            __builtin_memcpy(counts + k, &found, sizeof found);
            Words words;
            __builtin_memcpy(&words, found_cells + k, sizeof words);
            const size_t at = plane * stride + ray + k;
            write(out.cells.data() + at, __builtin_convertvector(words, Lanes));
            if (!one_layer) write(out.layers.data() + at, Lanes{} + of_layer);
          };
          size_t k = 0;
          for (; k + kRays <= size; k += kRays)
            put(k, kRays, ~uint64_t{0}, [](uint32_t* to, const Lanes& lanes) TERACELL_IN_LINE { __builtin_memcpy(to, &lanes, sizeof lanes); });
          if (const size_t here = size - k; here > 0)
            put(k, here, ~(~uint64_t{0} << 8 * here), [=](uint32_t* to, const Lanes& lanes) TERACELL_IN_LINE {
              constexpr Lanes kPlaces = {0, 1, 2, 3, 4, 5, 6, 7};
              Lanes others;
              __builtin_memcpy(&others, to, sizeof others);
              others = kPlaces < static_cast<uint32_t>(here) ? lanes : others;
              __builtin_memcpy(to, &others, sizeof others);
            });
        }
        if (fits && LaneHeights::is_close(far))
          decide(
              {&spans_[first], s - first}, tile, facets, heights, [&](uint32_t ray) { --out.counts[ray]; },
              [&](uint32_t ray, uint64_t crossing) {
                fits &= out.add(ray, Crossing::cell(crossing) | (Crossing::step(crossing) > 0 ? CrossingPlanes::kUp : 0), Crossing::layer(crossing));
              });
      }
    }
  });
  if (!fits) exact_decisions_ = exact_before;
  return fits;
}

// Spreads the crossings of the last spans once more, those of close ones as exact arithmetic has them: take_back(ray) for each of them, then
// spread(ray, crossing).
template <class TakeBack, class Spread>
void ScanEngine::decide(std::span<const Span> spans, const Tile& tile, std::span<const SceneFacet* const> facets, const LaneHeights& heights,
                        const TakeBack& take_back, const Spread& spread) {
  for (const Span& span : spans)
    for (uint32_t i = 0; i < span.size(); ++i) take_back(span.first_ray(tile) + i);
  std::optional<FacetHeight> height;
  uint32_t facet = 0;
  for (const Span& span : spans) {
    const size_t place = span.facet() % FacetLanes::kFacets;
    LaneHeights::Far far{};
    heights.cross(place, u_.data() + span.from(), span.size(), tile.v[span.row()], span.up(), crossings_.data(), far);
    if (!heights.can_tell(place) || LaneHeights::is_close(far)) {
      if (!height || span.facet() != facet) height.emplace(facets[facet = span.facet()]->facet, tile.frame, *tile.axis);
      height->first_cells({u_.data() + span.from(), span.size()}, tile.v[span.row()], cells_.data(), exact_decisions_);
      const uint64_t rest = Crossing::pack(0, facets[facet]->layer, span.up());
      for (uint32_t i = 0; i < span.size(); ++i) crossings_[i] = uint64_t{cells_[i]} << 32 | rest;
    }
    for (uint32_t i = 0; i < span.size(); ++i) spread(span.first_ray(tile) + i, crossings_[i]);
  }
}

namespace {

EngineMaker scan_maker(const RayFrame&, const AllFacets&) {
  return [] { return std::make_unique<ScanEngine>(); };
}

}  // namespace

const EngineKind kScanEngine = {"scan", false, scan_maker};

}  // namespace teracell::mesher
