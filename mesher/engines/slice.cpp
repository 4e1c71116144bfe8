// The slicing algorithm. Each plane of rays (constant v) cuts facets into segments, which form the contours of the bodies in
// that plane. Each ray of the plane (constant u) is a scan line over these contours.
//
// Facets are sorted by the first plane that cuts them, and a list of the facets that are still cut moves along with the plane.
// rows.hpp and height.hpp say exactly between which rays a segment lies and at which height a ray crosses it. So the ends of
// neighbouring segments agree, although contours are never linked.
//
// Crossings are written plane by plane, each to its final place. `scan` walks over the whole tile twice instead, but keeps
// nothing of a facet except its spans.
#include <numeric>
#include <optional>

#include "mesher/engines/engines.hpp"
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

void SliceEngine::cast(const Tile& tile, std::span<const SceneFacet* const> facets, Crossings& out) {
  sort_cuts(tile, facets);
  active_.clear();
  out.begin.assign(1, 0);
  out.all.clear();
  for (uint32_t row = 0; row < tile.v.size(); ++row) {
    cut_plane(tile, row);
    scan_contours(tile, row, out);
  }
}

void SliceEngine::sort_cuts(const Tile& tile, std::span<const SceneFacet* const> facets) {
  const RayFinder rows(tile.v);
  cuts_.clear();
  first_.assign(tile.v.size() + 1, 0);
  for (const SceneFacet* facet : facets) {
    const FacetRows cut(facet->facet, tile.frame, rows);
    if (cut.begin() == cut.end()) continue;
    cuts_.push_back({facet, cut, std::nullopt});
    ++first_[cut.begin() + 1];
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  next_.assign(first_.begin(), first_.end());
  sorted_.resize(cuts_.size());
  for (uint32_t i = 0; i < cuts_.size(); ++i) sorted_[next_[cuts_[i].rows.begin()]++] = i;
}

void SliceEngine::cut_plane(const Tile& tile, uint32_t row) {
  const RayFinder rays(tile.u);
  std::erase_if(active_, [&](uint32_t i) { return cuts_[i].rows.end() == row; });
  active_.insert(active_.end(), sorted_.begin() + first_[row], sorted_.begin() + first_[row + 1]);
  contours_.clear();
  for (const uint32_t i : active_) {
    const FacetRows::Rays segment = cuts_[i].rows.at(row, tile.v[row], rays, exact_decisions_);
    if (segment.from < segment.to) contours_.push_back({&cuts_[i], segment});
  }
}

void SliceEngine::scan_contours(const Tile& tile, uint32_t row, Crossings& out) {
  const size_t nu = tile.u.size();
  next_.assign(nu + 1, 0);  // for each ray, how many segments begin there minus how many end; later, where its next crossing goes
  for (const Segment& s : contours_) {
    ++next_[s.rays.from];
    --next_[s.rays.to];
  }
  uint64_t total = out.all.size();
  uint32_t over = 0;
  for (size_t i = 0; i < nu; ++i) {
    over += next_[i];
    next_[i] = static_cast<uint32_t>(total);
    total += over;
    out.begin.push_back(static_cast<uint32_t>(total));
  }
  check_crossings(tile, total);
  out.all.resize(total);
  cells_.resize(nu);
  for (const Segment& s : contours_) {
    Cut& cut = *s.cut;
    if (!cut.height) cut.height.emplace(cut.facet->facet, tile.frame, *tile.axis);
    const std::span<const double> u(tile.u.data() + s.rays.from, s.rays.to - s.rays.from);
    cut.height->first_cells(u, tile.v[row], cells_.data(), exact_decisions_);
    uint32_t* next = next_.data() + s.rays.from;
    const uint64_t rest = Crossing::pack(0, cut.facet->layer, s.rays.up);
    for (uint32_t i = 0; i < u.size(); ++i) out.all[next[i]++] = uint64_t{cells_[i]} << 32 | rest;
  }
}

namespace {

EngineMaker slice_maker(const RayFrame&, const AllFacets&) {
  return [] { return std::make_unique<SliceEngine>(); };
}

}  // namespace

const EngineKind kSliceEngine = {"slice", false, slice_maker};

}  // namespace teracell::mesher
