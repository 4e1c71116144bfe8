// What is taken from a bin: its facets, with their rays and with what they are in this bin and in others.
#include <algorithm>
#include <utility>

#include "mesher/tiles/bins.hpp"

namespace teracell::mesher {

class FacetBins::Taking {
 public:
  Taking(const FacetBins& bins, const TreePlace& place, const std::function<void(const BinnedFacets&)>& f)
      : bins_(bins), rays_(bins.rays_), place_(place), f_(f), shift_(rays_.shift(place.depth)) {
    if (place.depth >= 0) return;
    const int group = rays_.shift(0);
    group_u_ = uint64_t{place.cu} << shift_ >> group << group, group_v_ = uint64_t{place.cv} << shift_ >> group << group;
  }
  void take(const WeldedRecords& block) {
    ++out_.block;
    vertices_.resize(block.vertices());
    for (size_t v = 0; v < vertices_.size(); ++v) vertices_[v] = bins_.vertex_in(block.vertex(v));
    // Facets that are moved, or that share few vertices, have their rays found as a whole.
    const bool by_vertices = !bins_.move_ && block.vertices() < 2 * block.records();
    if (by_vertices) {
      of_vertices_.resize(block.vertices());
      rays_.ranges_of(vertices_, of_vertices_.data());
    }
    block.for_each_run([&](size_t first, size_t last, std::span<const uint8_t> rest) {
      const uint32_t tag = tag_in(rest);
      if (is_part(tag)) {
        for (size_t i = first; i < last; ++i) parts_.push_back(&bins_.part_in(block.vertex(block.vertices_of(i)[0])));
        return;
      }
      begin(layer_in(tag), bins_.patch_in(rest));
      out_.added = (tag & kNotOfFile) != 0, out_.ignored = (tag & kIgnored) != 0, out_.of_block = last - first == block.records();
      const bool moves = bins_.move_ && !(tag & kInPlace);
      for (size_t i = first; i < last; ++i) {
        BinnedFacets::One& one = facets_[count_];
        one.vertices = block.vertices_of(i);
        const auto& [a, b, c] = one.vertices;
        if (by_vertices) {
          one.rays = rays_.range_of(of_vertices_[a], of_vertices_[b], of_vertices_[c], out_.layer);
        } else {
          Facet& facet = moved_[count_];
          facet = {{vertices_[a], vertices_[b], vertices_[c]}};
          if (moves) facet = bins_.move_(facet, out_.layer);
        }
        if (++count_ == kTakenAtOnce) hand_on(by_vertices, moves);
      }
      hand_on(by_vertices, moves);
    });
    for (const BinnedPart* part : std::exchange(parts_, {})) take(*part);
  }

 private:
  static constexpr size_t kTakenAtOnce = 64;
  void begin(uint32_t layer, uint32_t patch) {
    out_.layer = layer, out_.patch = patch;
    out_.vertices = vertices_;
  }
  void take(const BinnedPart& part) {
    ++out_.block;
    vertices_.resize(3 * kTakenAtOnce);
    begin(layer_in(part.layer), part.patch);
    out_.added = false, out_.ignored = (part.layer & kIgnored) != 0, out_.of_block = true;
    const bool moves = bins_.move_ != nullptr;
    const auto hand_on_block = [&] {
      out_.vertices = std::span(vertices_).first(3 * count_);
      hand_on(false, moves);
      ++out_.block;
    };
    part.read([&](const Facet& facet) {
      Facet& placed = moved_[count_];
      placed = moves ? bins_.move_(facet, out_.layer) : facet;
      if (!bins_.meets(place_, bins_.units_of(rays_.range_of(placed, out_.layer)))) return;
      const uint32_t v = 3 * static_cast<uint32_t>(count_);
      std::ranges::copy(facet.vertex, vertices_.begin() + v);
      facets_[count_].vertices = {v, v + 1, v + 2};
      if (++count_ == kTakenAtOnce) hand_on_block();
    });
    hand_on_block();
  }
  void hand_on(bool have_rays, bool moved) {
    if (!have_rays) {
      std::array<RayRange, kTakenAtOnce> ranges;
      rays_.ranges_of(
          count_, [this](size_t i) TERACELL_IN_LINE -> const Facet& { return moved_[i]; }, [this](size_t) { return out_.layer; }, ranges.data());
      for (size_t i = 0; i < count_; ++i) facets_[i].rays = ranges[i];
    }
    out_.facets = std::span(facets_).first(count_);
    out_.moved = moved ? std::span<const Facet>(moved_).first(count_) : std::span<const Facet>();
    for (size_t i = 0; i < count_; ++i) place_among_bins(i);
    count_ = 0;
    if (!out_.facets.empty()) f_(out_);
  }
  // In how many bins facet i lies, and what it is in this one. Most lie in this one alone.
  void place_among_bins(size_t i) {
    BinnedFacets::One& out = facets_[i];
    out.at_home = out.leads = true, out.bins = 1;
    const RayRange& r = out.rays;
    if (r.u0 < u_.begin || r.u1 >= u_.end || r.v0 < v_.begin || r.v1 >= v_.end) place_among_several(i, bins_.units_of(r), out);
    if (out_.ignored) out.rays = {};
  }
  void place_among_several(size_t i, const UnitRange& units, BinnedFacets::One& out) const {
    const auto inside = [&](uint64_t u, uint64_t v) { return u >> shift_ == place_.cu && v >> shift_ == place_.cv; };
    // A facet is at home in the bin of its least vertex, so facets with the same vertices have the same home.
    const Facet in_file = out_.in_file(out), placed = out_.placed(i);
    const Vec3& p = placed.vertex[std::ranges::min_element(in_file.vertex) - in_file.vertex.begin()];
    const UnitRange home = bins_.units_of(rays_.range_of({{p, p, p}}, out_.layer));
    out.at_home = inside(home.first_u, home.first_v);
    out.bins = out.at_home ? bins_.bins_of(bins_.root_, units) : 2;
    out.leads = place_.depth >= 0 || inside(std::max<uint64_t>(units.first_u, group_u_), std::max<uint64_t>(units.first_v, group_v_));
  }

  const FacetBins& bins_;
  const GridRays& rays_;
  const TreePlace place_;
  const std::function<void(const BinnedFacets&)>& f_;
  const int shift_;
  uint64_t group_u_ = 0, group_v_ = 0;  // the first unit of the place's group, if it is smaller than one
  // Facets with no other rays lie in this bin alone. The last bin of a row or column has no end.
  struct Along {
    uint64_t begin, end;
    Along(uint64_t at, uint64_t side, uint64_t rays) : begin(at * side), end((at + 1) * side < rays ? (at + 1) * side : ~uint64_t{0}) {}
  };
  const Along u_{place_.cu, rays_.size(place_.depth), rays_.shape.nu}, v_{place_.cv, rays_.size(place_.depth), rays_.shape.nv};
  BinnedFacets out_;
  std::array<BinnedFacets::One, kTakenAtOnce> facets_;
  std::array<Facet, kTakenAtOnce> moved_;
  size_t count_ = 0;  // of facets that are to be handed on
  std::vector<Vec3> vertices_;
  std::vector<RayRange> of_vertices_;  // of the points alone
  std::vector<const BinnedPart*> parts_;
};

void FacetBins::take(const TreePlace& place, const std::function<void(const BinnedFacets&)>& f) {
  Taking taking(*this, place, f);
  WeldedRecords block(shape_);
  take_blocks(const_cast<Bin&>(bin_at(place)), [&](std::span<const uint8_t> bytes) {
    block.read(bytes);
    taking.take(block);
  });
}

}  // namespace teracell::mesher
