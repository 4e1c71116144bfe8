// Finds the rays of a grid by coordinate, and as a tree in which a node has 4 x 4 children (tiling.hpp).
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>
#include <vector>

#include "mesher/closing/closing.hpp"
#include "mesher/engines/engine.hpp"
#include "store/base/system/vector_units.hpp"
#include "store/grid/metadata.hpp"
#include "store/runs/pyramid.hpp"

namespace teracell::mesher {

// Finds rays by coordinate with a multiplication and a margin for its rounding error: never too few, seldom one too many.
class RayBounds {
 public:
  explicit RayBounds(const Axis& axis) : axis_(axis), graded_(axis.is_graded()), rays_(static_cast<double>(axis.cells())) {
    if (graded_) return;
    origin_ = axis.origin();
    per_ray_ = 1 / axis.step();
    const double offset = static_cast<double>(axis.first()) + axis.sample(), n = static_cast<double>(axis.cells());
    const double margin = 0x1p-48 * (std::abs(axis.origin()) * per_ray_ + offset + n + 1);
    from_ = offset + margin;
    to_ = offset - margin;
  }
  uint32_t first(double lo) const { return graded_ ? static_cast<uint32_t>(axis_.first_centre_from(lo)) : ceil((lo - origin_) * per_ray_ - from_); }
  uint32_t last(double hi) const { return graded_ ? static_cast<uint32_t>(axis_.first_centre_from(hi)) : ceil((hi - origin_) * per_ray_ - to_); }

 private:
  friend class UniformRays;
  uint32_t ceil(double t) const {
    t = std::min(std::max(t, 0.0), rays_);  // std::clamp branches
    const auto whole = static_cast<int32_t>(t);
    return static_cast<uint32_t>(whole) + (t > whole);
  }
  const Axis& axis_;
  const bool graded_;
  const double rays_;
  double origin_ = 0, per_ray_ = 0, from_ = 0, to_ = 0;
};

// The rays that a facet may meet: [u0, u1) x [v0, v1). Empty when the facet lies between rays.
struct RayRange {
  uint32_t u0, u1, v0, v1;
  bool empty() const { return u0 >= u1 || v0 >= v1; }
};

// Finds the ranges of many facets on two uniform axes, as RayBounds to the last bit (vector_units.hpp says why): all four bounds side by side.
class UniformRays {
 public:
  UniformRays(const RayBounds& u, const RayBounds& v)
      : is_uniform(!u.graded_ && !v.graded_),
        origin_{u.origin_, u.origin_, v.origin_, v.origin_},
        per_ray_{u.per_ray_, u.per_ray_, v.per_ray_, v.per_ray_},
        margin_{u.from_, u.to_, v.from_, v.to_},
        rays_{u.rays_, u.rays_, v.rays_, v.rays_} {}
  const bool is_uniform;
  // ranges[i] is that of corners(i): the least u, the greatest u, the least v, the greatest v. REQUIRES: is_uniform.
  using Bounds [[gnu::vector_size(32)]] = double;
  template <class Corners>
  void find(size_t count, const Corners& corners, RayRange* ranges) const {
    on_vector_unit([count, ranges, &corners, this]() TERACELL_IN_LINE {
      using Rays [[gnu::vector_size(16)]] = int32_t;
      static_assert(sizeof(Rays) == sizeof(RayRange));
      Bounds origin, per_ray, margin, most;
      __builtin_memcpy(&origin, origin_.data(), sizeof origin), __builtin_memcpy(&per_ray, per_ray_.data(), sizeof per_ray);
      __builtin_memcpy(&margin, margin_.data(), sizeof margin), __builtin_memcpy(&most, rays_.data(), sizeof most);
      for (size_t i = 0; i < count; ++i) {
        Bounds t;
        corners(i, t);
        t = (t - origin) * per_ray - margin;
        t = t < 0 ? Bounds{} : t;
        t = most < t ? most : t;
        Rays rays = __builtin_convertvector(t, Rays);
        rays -= __builtin_convertvector(t > __builtin_convertvector(rays, Bounds), Rays);
        __builtin_memcpy(ranges + i, &rays, sizeof rays);
      }
    });
  }

 private:
  std::array<double, 4> origin_, per_ray_, margin_, rays_;
};

// The chunks of level 0 that a facet may have rays in. Unlike RayRange it includes the last ones, so it can't be empty.
struct ChunkRange {
  uint32_t first_u, last_u, first_v, last_v;
};

// A node of the tree. At `depth` 0 it is a group of 4 x 4 tiles, at -1 a tile; bins may be smaller still. (cu, cv) is its place among the nodes of
// this depth.
struct TreePlace {
  int depth = 0;
  uint32_t cu = 0, cv = 0;
  // Children are numbered row by row.
  TreePlace child(uint32_t k) const { return {depth - 1, cu * kFanOut + k % kFanOut, cv * kFanOut + k / kFanOut}; }
};

// Divides by the side of chunks or units, which is mostly a power of two.
class Side {
 public:
  explicit Side(uint32_t rays) : rays_(rays), shift_(std::has_single_bit(rays) ? std::countr_zero(rays) : kNone) {}
  uint32_t of(uint32_t ray) const { return shift_ == kNone ? ray / rays_ : ray >> shift_; }

 private:
  static constexpr int kNone = -1;
  uint32_t rays_;
  int shift_;
};

struct GridRays {
  RayFrame frame;
  const Axis& w;
  RayBounds u, v;
  UniformRays uniform;
  LevelShape shape;
  Side chunk, unit;  // a unit is a node of the lowest depth
  int lowest;        // depth of the tree
  std::vector<uint8_t> widened;  // for each body; empty if it is 0 for all

  // Keeps references to the axes. Facets of a body reach as many rays further on each side as `widened` says, because they may
  // matter to cells whose rays they do not meet (marker.hpp).
  explicit GridRays(const Metadata& meta, std::vector<uint8_t> widened_bodies = {})
      : frame(meta.frame()),
        w(meta.grid.axis[frame.w]),
        u(meta.grid.axis[frame.u]),
        v(meta.grid.axis[frame.v]),
        uniform(u, v),
        shape(meta, 0),
        chunk(shape.chunk_rays),
        unit(lowest_side(shape.chunk_rays)),
        lowest(-1 - std::countr_zero(shape.chunk_rays / lowest_side(shape.chunk_rays)) / kFanOutBits),
        widened(std::move(widened_bodies)) {}

  RayRange range_of(const Facet& facet, uint32_t layer) const {
    const auto& [a, b, c] = facet.vertex;
    // Two at a time: for a list, std::min branches, and every other branch is mispredicted.
    const auto least = [&](int d) { return std::min(std::min(a[d], b[d]), c[d]); };
    const auto most = [&](int d) { return std::max(std::max(a[d], b[d]), c[d]); };
    return widened_for({u.first(least(frame.u)), u.last(most(frame.u)), v.first(least(frame.v)), v.last(most(frame.v))}, layer);
  }
  // The same for facet_of(0) to facet_of(count - 1), which have layers layer_of(0) to layer_of(count - 1).
  template <class FacetOf, class LayerOf>
  void ranges_of(size_t count, const FacetOf& facet_of, const LayerOf& layer_of, RayRange* ranges) const {
    if (!uniform.is_uniform) {
      for (size_t i = 0; i < count; ++i) ranges[i] = range_of(facet_of(i), layer_of(i));
      return;
    }
    const auto corners = [&facet_of, du = frame.u, dv = frame.v](size_t i, UniformRays::Bounds& out) TERACELL_IN_LINE {
      using Bounds = UniformRays::Bounds;
      const auto& [a, b, c] = facet_of(i).vertex;
      const Bounds p = {a[du], a[du], a[dv], a[dv]}, q = {b[du], b[du], b[dv], b[dv]}, r = {c[du], c[du], c[dv], c[dv]};
      Bounds least = p < q ? p : q, most = p < q ? q : p;
      least = r < least ? r : least, most = most < r ? r : most;
      out = __builtin_shufflevector(least, most, 0, 5, 2, 7);
    };
    uniform.find(count, corners, ranges);
    if (widened.empty()) return;
    for (size_t i = 0; i < count; ++i) ranges[i] = widened_for(ranges[i], layer_of(i));
  }
  // Those of points, and that of a facet from those of its vertices.
  void ranges_of(std::span<const Vec3> points, RayRange* ranges) const {
    if (!uniform.is_uniform) {
      for (const Vec3& p : points) *ranges++ = {u.first(p[frame.u]), u.last(p[frame.u]), v.first(p[frame.v]), v.last(p[frame.v])};
      return;
    }
    const auto corners = [at = points.data(), du = frame.u, dv = frame.v](size_t i, UniformRays::Bounds& out) TERACELL_IN_LINE {
      const Vec3& p = at[i];
      out = UniformRays::Bounds{p[du], p[du], p[dv], p[dv]};
    };
    uniform.find(points.size(), corners, ranges);
  }
  RayRange range_of(const RayRange& a, const RayRange& b, const RayRange& c, uint32_t layer) const {
    return widened_for({std::min(std::min(a.u0, b.u0), c.u0), std::max(std::max(a.u1, b.u1), c.u1), std::min(std::min(a.v0, b.v0), c.v0),
                        std::max(std::max(a.v1, b.v1), c.v1)},
                       layer);
  }
  // REQUIRES: !range.empty().
  ChunkRange chunks_of(const RayRange& r) const { return {chunk.of(r.u0), chunk.of(r.u1 - 1), chunk.of(r.v0), chunk.of(r.v1 - 1)}; }
  // The side of a node of that depth, in units and in rays.
  uint64_t units(int depth) const { return uint64_t{1} << shift(depth); }
  int shift(int depth) const { return kFanOutBits * (depth - lowest); }
  uint64_t size(int depth) const { return units(depth) * (shape.chunk_rays >> shift(-1)); }
  TreePlace root() const {
    TreePlace root;
    while (size(root.depth) < std::max(shape.nu, shape.nv)) ++root.depth;
    return root;
  }

 private:
  RayRange widened_for(const RayRange& r, uint32_t layer) const {
    if (widened.empty()) return r;
    const uint32_t more = widened[body_of_layer(layer)];
    return {r.u0 - std::min(r.u0, more), std::min(r.u1 + more, shape.nu), r.v0 - std::min(r.v0, more), std::min(r.v1 + more, shape.nv)};
  }
  // Of a chunk's side, what is left when it is divided by four as often as that goes.
  static uint32_t lowest_side(uint32_t chunk_rays) {
    while (chunk_rays % kFanOut == 0) chunk_rays /= kFanOut;
    return chunk_rays;
  }
};

}  // namespace teracell::mesher
