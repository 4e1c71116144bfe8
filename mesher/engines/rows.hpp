// Finds the rays that cross a facet, row by row: the step that the engines `scan` and `slice` share.
//
// A row meets two edges of the facet; every ray between these edges crosses the facet. The first ray on the right of an edge is
// computed in doubles with a proven error bound; for rays within the bound, the exact predicate decides. As the answers are
// exact, neighbouring facets agree on every edge that they share, without exchanging anything.
#pragma once
#include <algorithm>
#include <cmath>

#include "mesher/engines/engine.hpp"
#include "mesher/engines/predicates.hpp"

namespace teracell::mesher {

// Finds a place among ascending coordinates: a guess, which is right for even spacing, and a walk from there.
class RayFinder {
 public:
  // Keeps a reference. REQUIRES: at least one ray.
  explicit RayFinder(const std::vector<double>& rays)
      : rays_(rays), per_unit_(rays.size() > 1 ? static_cast<double>(rays.size() - 1) / (rays.back() - rays[0]) : 0) {}
  uint32_t size() const { return static_cast<uint32_t>(rays_.size()); }
  double operator[](uint32_t i) const { return rays_[i]; }
  // The first ray at or above x.
  uint32_t from(double x) const {
    const double guess = std::clamp((x - rays_[0]) * per_unit_ + 1, 0.0, static_cast<double>(size()));
    auto i = static_cast<uint32_t>(static_cast<int32_t>(guess));
    while (i > 0 && rays_[i - 1] >= x) --i;
    while (i < size() && rays_[i] < x) ++i;
    return i;
  }

 private:
  const std::vector<double>& rays_;
  double per_unit_;
};

// The line through lo and hi, two vertices of a facet with lo below hi in v.
class FacetEdge {
 public:
  FacetEdge() {}  // not set: most facets need only two of their three edges
  FacetEdge(const Vec3& lo, const Vec3& hi, const RayFrame& f)
      : lo_u_(lo[f.u]), lo_v_(lo[f.v]), hi_u_(hi[f.u]), hi_v_(hi[f.v]), slope_((hi_u_ - lo_u_) / (hi_v_ - lo_v_)) {
    // u(v) = lo_u + (v - lo_v) * slope: six roundings relative to at most |hi_u - lo_u|, and one relative to |lo_u| more. An edge
    // of constant u is exact.
    constexpr double kUnit = 0x1p-53;  // the unit roundoff
    slack_ = hi_u_ == lo_u_ ? 0 : 9 * kUnit * (std::abs(lo_u_) + std::abs(hi_u_));
  }

  // The first ray of the row v that passes on the right of the edge. REQUIRES: lo_v <= v <= hi_v.
  uint32_t first_right(double v, const RayFinder& rays, uint64_t& exact) const {
    const double u = lo_u_ + (v - lo_v_) * slope_;
    uint32_t i = rays.from(u - slack_);
    while (i < rays.size() && rays[i] <= u + slack_) {
      if (slack_ == 0) break;
      ++exact;
      if (right_of_edge(lo_u_, lo_v_, hi_u_, hi_v_, rays[i], v)) break;
      ++i;
    }
    return i;
  }

 private:
  double lo_u_, lo_v_, hi_u_, hi_v_, slope_, slack_;
};

// The rays of a tile that cross a facet: in each of the rows [begin(), end()), the rays [from, to).
class FacetRows {
 public:
  struct Rays {
    uint32_t from, to;
    bool up;  // the facet turns left in (u, v), which decides its sign in the winding number
  };

  // `rows` are the v of the tile. Keeps no reference.
  FacetRows(const Facet& facet, const RayFrame& f, const RayFinder& rows) {
    const Vec3 *lo = &facet.vertex[0], *mid = &facet.vertex[1], *hi = &facet.vertex[2];
    const auto order = [&](const Vec3*& a, const Vec3*& b) {  // without a branch, which would be mispredicted half of the time
      const bool swap = (*b)[f.v] < (*a)[f.v];
      const Vec3 *const first = swap ? b : a, *const second = swap ? a : b;
      a = first, b = second, odd_ ^= swap;
    };
    order(lo, mid), order(mid, hi), order(lo, mid);
    begin_ = rows.from((*lo)[f.v]);
    end_ = rows.from((*hi)[f.v]);
    if (begin_ == end_) return;
    turn_ = std::clamp(rows.from((*mid)[f.v]), begin_, end_);
    longest_ = FacetEdge(*lo, *hi, f);
    if (begin_ < turn_) lower_ = FacetEdge(*lo, *mid, f);
    if (turn_ < end_) upper_ = FacetEdge(*mid, *hi, f);
  }
  uint32_t begin() const { return begin_; }
  uint32_t end() const { return end_; }

  // `rays` are the u of the tile. REQUIRES: begin() <= row < end(), and v is that of the row.
  Rays at(uint32_t row, double v, const RayFinder& rays, uint64_t& exact) const {
    const uint32_t a = longest_.first_right(v, rays, exact);
    const uint32_t b = (row < turn_ ? lower_ : upper_).first_right(v, rays, exact);
    // With the longest edge on the left, the sorted triangle turns left, and its normal points up.
    return {std::min(a, b), std::max(a, b), (a < b) != odd_};
  }

 private:
  uint32_t begin_, turn_ = 0, end_;
  bool odd_ = false;  // the permutation that sorts the vertices by v is odd
  FacetEdge longest_, lower_, upper_;
};

}  // namespace teracell::mesher
