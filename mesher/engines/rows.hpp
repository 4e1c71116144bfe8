// Finds the rays that cross a facet, row by row: the step that the engines `scan` and `slice` share.
//
// A row meets two edges of the facet; every ray between these edges crosses the facet. The first ray on the right of an edge is
// computed in doubles with a proven error bound; for rays within the bound, the exact predicate decides. As the answers are
// exact, neighbouring facets agree on every edge that they share, without exchanging anything.
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>

#include "mesher/engines/engine.hpp"
#include "mesher/engines/predicates.hpp"
#include "store/base/system/vector_units.hpp"

namespace teracell::mesher {

// Finds a place among ascending coordinates. Where they are evenly spaced a multiplication tells, unless the place is so close to a ray that
// rounding matters; then, and where they are not, a walk from there does.
class RayFinder {
 public:
  // Keeps a reference. REQUIRES: at least one ray.
  explicit RayFinder(const std::vector<double>& rays)
      : rays_(rays),
        lowest_(rays[0]),
        per_ray_(rays.size() > 1 ? static_cast<double>(rays.size() - 1) / (rays.back() - lowest_) : 0),
        most_(static_cast<double>(rays.size())) {
    if (!(per_ray_ > 0 && per_ray_ < HUGE_VAL)) return;
    // Without rounding, place_of() grows with x. So where it is further from the middle between two whole numbers than that of any ray, by what
    // rounding may do, it tells the two rays that x lies between.
    double off = 0;
    for (size_t i = 0; i < rays.size(); ++i) off = std::max(off, std::abs((rays[i] - lowest_) * per_ray_ - static_cast<double>(i)));
    slack_ = off + 0x1p-49 * static_cast<double>(rays.size());
  }
  uint32_t size() const { return static_cast<uint32_t>(rays_.size()); }
  double operator[](uint32_t i) const { return rays_[i]; }

  // Where x lies in units of rays, and a half more; 0 or size() where it lies before or behind them all.
  TERACELL_IN_LINE double place_of(double x) const { return std::min(std::max((x - lowest_) * per_ray_ + 0.5, 0.0), most_); }
  // A place that is added to this one is rounded to an integer, which is what the low half of the sum's bits say.
  static constexpr double kRound = 0x1.8p52;
  // How close to a ray a place must be for rounding to matter, if that of x itself is right; 1 if the rays are not evenly spaced.
  double slack() const { return slack_; }
  double per_ray() const { return per_ray_; }

  // The first ray at or above x.
  TERACELL_IN_LINE uint32_t from(double x) const {
    const double t = place_of(x), sum = t + kRound;
    const auto i = static_cast<uint32_t>(std::bit_cast<uint64_t>(sum));
    return std::abs(t - (sum - kRound)) < 0.5 - slack_ ? i : walk(x, i);
  }

 private:
  [[gnu::noinline]] uint32_t walk(double x, uint32_t i) const {
    while (i > 0 && rays_[i - 1] >= x) --i;
    while (i < size() && rays_[i] < x) ++i;
    return i;
  }

  const std::vector<double>& rays_;
  double lowest_, per_ray_, most_, slack_ = 1;
};

// The line through lo and hi, two vertices of a facet with lo below hi in v; if they are at the same v, it meets no row.
class FacetEdge {
 public:
  FacetEdge() = default;
  FacetEdge(const Vec3& lo, const Vec3& hi, const RayFrame& f)
      : lo_u_(lo[f.u]), lo_v_(lo[f.v]), hi_u_(hi[f.u]), hi_v_(hi[f.v]), slope_((hi_u_ - lo_u_) / (hi_v_ - lo_v_)) {
    // u(v) = lo_u + (v - lo_v) * slope has six roundings relative to at most |hi_u - lo_u|, and one relative to |lo_u| more. An
    // edge of constant u is exact.
    slack_ = hi_u_ == lo_u_ ? 0 : slack(std::abs(lo_u_) + std::abs(hi_u_));
  }

  // The error of u(v) between lo_v and hi_v, for any edge between ends whose |u| have this sum at most.
  TERACELL_IN_LINE static double slack(double sum) { return 9 * kRoundoff * sum; }

  // The first ray of the row v that passes on the right of the edge. REQUIRES: lo_v <= v <= hi_v.
  [[gnu::noinline]] uint32_t first_right(double v, const RayFinder& rays, uint64_t& exact) const {
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
  double lo_u_ = 0, lo_v_ = 0, hi_u_ = 0, hi_v_ = 0, slope_ = 0, slack_ = 0;
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
    // One of the shorter edges may have no rows, and perhaps no height. That is seldom known before, and costs less than a branch.
    longest_ = FacetEdge(*lo, *hi, f), lower_ = FacetEdge(*lo, *mid, f), upper_ = FacetEdge(*mid, *hi, f);
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
