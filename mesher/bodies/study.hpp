// The one pass over all facets: what is found of them while they are read.
#pragma once
#include <algorithm>
#include <cmath>
#include <utility>

#include "mesher/bodies/bodies.hpp"
#include "mesher/bodies/extent.hpp"
#include "mesher/scene/placement.hpp"
#include "mesher/tiles/welded_records.hpp"

namespace teracell::mesher {

// Facets were written by another processor. Asked for so many facets before they are used, they arrive in time; the processor asked by itself for too
// few, and waiting for the others took half of the time of the study.
inline constexpr size_t kFacetsAhead = 16;

// So many facets are looked at together: they stay in the cache for what is found of them one after the other.
inline constexpr size_t kFacetsAtOnce = 64;

// What a pass over the facets of a body finds that does not depend on their order: whether the surface is closed, whether it has opposite facets,
// and, unless only a sample is kept, how many lie on others or have no area.
class alignas(64) Topology {  // so that those of different threads share no line of a cache
 public:
  template <class F>
  void take(std::span<const F> facets, size_t behind);
  // Facets with the hashes of their vertices.
  template <class F>
  void take(std::span<const F> facets, std::span<const std::array<VertexHash, 3>> hashes);
  void add(const Topology& other) { boundary_.add(other.boundary_), facets_.add(other.facets_); }  // of the same body; both keep samples
  void keep_sample() { facets_.keep_sample(); }
  void begin() {
    boundary_ = {};
    facets_.clear();
    degenerate_ = 0;
  }
  const BoundaryProof& boundary() const { return boundary_; }
  // Counts, without shells, and whether there are opposite facets.
  std::pair<SurfaceCounts, bool> found() {
    const EqualFacets equal = facets_.equal();
    const SurfaceCounts counts = facets_.is_sample() ? SurfaceCounts() : SurfaceCounts{degenerate_, equal.duplicates, equal.opposite, 0};
    return {counts, equal.opposite_in_sample};
  }

 private:
  BoundaryProof boundary_;
  FacetSet facets_;
  uint64_t degenerate_ = 0;
};

inline const Facet& facet_of(const Facet& f) { return f; }
inline const Facet& facet_of(const SceneFacet& f) { return f.facet; }

// `behind`: how many facets come behind these in memory. REQUIRES: at most kFacetsAtOnce facets.
template <class F>
void Topology::take(std::span<const F> facets, size_t behind) {
  std::array<std::array<VertexHash, 3>, kFacetsAtOnce> hashes;
  for (size_t i = 0; i < facets.size(); ++i) {
    __builtin_prefetch(&facets[i] + std::min<size_t>(kFacetsAhead, facets.size() - 1 - i + behind));
    hashes[i] = vertex_hashes(facet_of(facets[i]));
  }
  take(facets, std::span<const std::array<VertexHash, 3>>(hashes).first(facets.size()));
}

template <class F>
void Topology::take(std::span<const F> facets, std::span<const std::array<VertexHash, 3>> hashes) {
  for (const std::array<VertexHash, 3>& facet : hashes) facets_.add(facet);
  boundary_.add(hashes);
  if (facets_.is_sample()) return;
  for (const F& f : facets) degenerate_ += has_no_area(facet_of(f));
}

static_assert(FacetBlocks::kSome <= FacetWelder::kMost);

// What a thread needs to take blocks of facets. A vertex that successive facets share is hashed once.
class BlockTaker {
 public:
  Topology topology;
  // Welds facets, FacetBlocks::kSome at most, and calls f with some dozens of them at a time.
  template <class TakeSome>
  void take(std::span<const Facet> facets, const TakeSome& take_some) {
    welder_.weld(facets);
    std::ranges::transform(welder_.vertices(), of_vertices_.begin(), vertex_hash);
    for (size_t first = 0; first < facets.size(); first += kFacetsAtOnce) {
      const size_t count = std::min(kFacetsAtOnce, facets.size() - first);
      for (size_t i = 0; i < count; ++i) {
        const auto& [a, b, c] = welder_.vertices_of(first + i);
        of_facets_[i] = {of_vertices_[a], of_vertices_[b], of_vertices_[c]};
      }
      topology.take(facets.subspan(first, count), std::span<const std::array<VertexHash, 3>>(of_facets_).first(count));
      take_some(facets.subspan(first, count));
    }
  }
  const FacetWelder& welded() const { return welder_; }  // the facets that were taken last

 private:
  FacetWelder welder_;
  std::array<VertexHash, 3 * FacetWelder::kMost> of_vertices_;
  std::array<std::array<VertexHash, 3>, kFacetsAtOnce> of_facets_;
};

// The one pass over all facets. Of each body it finds its Topology; of all of them, where their matrices put them, the box and the areas of their
// projections. Areas are sums of those of FacetBlocks::kFacets facets that come one after another, whether they come as blocks or not.
class Study {
 public:
  Study(const Vec3& flat_slack, bool count) : flat_slack_(flat_slack), flat_(flat_slack) {
    if (!count) count_no_longer();
    begin();
  }
  // What the surfaces are made of will be counted when they are read once more.
  void count_no_longer() { topology_.keep_sample(); }
  // Facets of one patch.
  template <class F>
  void take(std::span<const F> facets, const SceneBody& body, uint32_t patch) {
    if (patch != patch_) end_group(), patch_ = patch;
    while (!facets.empty()) {
      const auto some = facets.first(std::min(facets.size(), FacetBlocks::kFacets - in_group_));
      facets = facets.subspan(some.size());
      if (flat_.wanted())
        take_some(some, facets.size(), body, topology_, group_, [this](const Facet& f, double size) { flat_.take(f.vertex, size); });
      else take_some(some, facets.size(), body, topology_, group_, kNoFlat);
      in_group_ += some.size();
      if (in_group_ == FacetBlocks::kFacets) end_group();
    }
  }
  // Whether the facets of a body may come as blocks, in parts on several threads: take_block() for each, on any thread with a taker that no other
  // one uses; then add_block() with the outcome, in the order of the blocks; and add_topology() for each thread.
  bool takes_blocks() const { return !FlatFaceSearch(flat_slack_).wanted(); }
  struct Measures {
    Extent extent;
    double size = 0;  // the areas of all facets
  };
  // Calls log(welder) when some facets were welded.
  template <class Log>
  static Measures take_block(const std::function<std::span<const Facet>()>& next, const SceneBody& body, BlockTaker& taker, const Log& log) {
    Measures out;
    for (auto facets = next(); !facets.empty(); facets = next()) {
      taker.take(facets, [&](std::span<const Facet> some) { measure_some(some, body, out, kNoFlat); });
      log(taker.welded());
    }
    return out;
  }
  void add_block(const Measures& of_block, uint32_t patch) {
    if (patch >= areas_.size()) areas_.resize(patch + 1);
    extent_.add(of_block.extent), areas_[patch] += of_block.size;
  }
  void add_topology(Topology& of_thread) { topology_.add(of_thread), of_thread.begin(); }
  // REQUIRES: all facets of the body were taken.
  void end_body() {
    end_group();
    const auto [counts, opposites] = topology_.found();
    bodies_.push_back({extent_.lo, extent_.hi, topology_.boundary(), opposites, counts, std::exchange(areas_, {}), std::move(flat_).found()});
    begin();
  }
  void hand_over(Bodies& out) {
    out.lo.fill(HUGE_VAL), out.hi.fill(-HUGE_VAL);
    out.area = extent_.area;
    for (size_t b = 0; b < bodies_.size(); ++b) {
      BodyFacets& body = out.bodies[b];
      body.lo = bodies_[b].lo, body.hi = bodies_[b].hi;
      body.boundary = bodies_[b].boundary;
      body.opposites = bodies_[b].opposites;
      body.facet_counts = bodies_[b].counts;
      body.areas = std::move(bodies_[b].areas);
      body.flat = std::move(bodies_[b].flat);
      for (int d = 0; d < 3; ++d) {
        out.lo[d] = std::min(out.lo[d], body.lo[d]);
        out.hi[d] = std::max(out.hi[d], body.hi[d]);
      }
    }
  }

 private:
  struct Found {
    Vec3 lo, hi;
    BoundaryProof boundary;
    bool opposites;
    SurfaceCounts counts;  // without shells
    std::vector<double> areas;
    FlatFaces flat;
  };
  static constexpr auto kNoFlat = [](const Facet&, double) TERACELL_IN_LINE {};
  template <class F, class TakeFlat>
  static void take_some(std::span<const F> facets, size_t behind, const SceneBody& body, Topology& topology, Measures& out,
                        const TakeFlat& take_flat) {
    for (; !facets.empty(); facets = facets.subspan(std::min(facets.size(), kFacetsAtOnce))) {
      const auto some = facets.first(std::min(facets.size(), kFacetsAtOnce));
      topology.take(some, static_cast<size_t>(&facets.back() - &some.back()) + behind);
      measure_some(some, body, out, take_flat);
    }
  }
  template <class F, class TakeFlat>
  static void measure_some(std::span<const F> some, const SceneBody& body, Measures& out, const TakeFlat& take_flat) {
    const auto measure = [&](const auto& facet_at) {
      out.extent.add(some.size(), facet_at, out.size, [&](size_t i, double size) TERACELL_IN_LINE { take_flat(facet_at(i), size); });
    };
    if (body.matrix == kIdentity) return measure([&](size_t i) TERACELL_IN_LINE -> const Facet& { return facet_of(some[i]); });
    std::array<Facet, kFacetsAtOnce> there;
    for (size_t i = 0; i < some.size(); ++i) there[i] = moved(facet_of(some[i]), body);
    measure([&](size_t i) TERACELL_IN_LINE -> const Facet& { return there[i]; });
  }
  void end_group() {
    if (in_group_ == 0) return;
    add_block(std::exchange(group_, {}), patch_);
    in_group_ = 0;
  }
  void begin() {
    extent_ = {.area = extent_.area};
    topology_.begin();
    flat_ = FlatFaceSearch(flat_slack_);
    patch_ = 0;
  }
  Extent extent_;  // of the body; the areas are of all bodies
  std::vector<double> areas_;  // of patches
  Topology topology_;
  const Vec3 flat_slack_;
  FlatFaceSearch flat_;
  Measures group_;  // of the last in_group_ facets
  size_t in_group_ = 0;
  uint32_t patch_ = 0;  // of these
  std::vector<Found> bodies_;
};

}  // namespace teracell::mesher
