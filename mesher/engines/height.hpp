// Where rays cross a facet, in cells: the first cell whose sample point lies above the facet. All engines use it.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

#include "mesher/engines/engine.hpp"
#include "mesher/engines/predicates.hpp"
#include "store/base/system/vector_units.hpp"

namespace teracell::mesher {

// The plane of a facet as w(u, v) = w0 + gu * (u - u0) + gv * (v - v0), where (u0, v0, w0) is its first vertex. Without branches, so that several
// can be computed side by side (facet_lanes.hpp).
struct FacetPlane {
  double u0, v0, w0, gu, gv;
  double slack;  // bounds |computed w - true w| over the projection of the facet; infinite: there is no bound

  // (u1, v1, w1) and (u2, v2, w2) are the other vertices.
  TERACELL_IN_LINE FacetPlane(double u, double v, double w, double u1, double v1, double w1, double u2, double v2, double w2) : u0(u), v0(v), w0(w) {
    const double d1u = u1 - u, d1v = v1 - v, d1w = w1 - w;
    const double d2u = u2 - u, d2v = v2 - v, d2w = w2 - w;
    // The normal. The error of each component is at most four roundings of its two products.
    const double nu = d1v * d2w - d1w * d2v, eu = 4 * kRoundoff * (std::abs(d1v * d2w) + std::abs(d1w * d2v));
    const double nv = d1w * d2u - d1u * d2w, ev = 4 * kRoundoff * (std::abs(d1w * d2u) + std::abs(d1u * d2w));
    const double nw = d1u * d2v - d1v * d2u, ew = 4 * kRoundoff * (std::abs(d1u * d2v) + std::abs(d1v * d2u));
    const double safe = std::abs(nw) - ew;
    // Divisions take long, so there are two in place of four, for which a gradient has one rounding more.
    const double per_nw = 1 / nw, per_safe = 1 / safe;
    const double slope_u = std::abs(nu * per_nw), slope_v = std::abs(nv * per_nw);
    // The error of the gradient, then that of the two terms over the extent of the facet and of what is made of their sum (eight roundings). It
    // is doubled to cover the second-order terms that are left out.
    const double width = std::max(std::abs(d1u), std::abs(d2u)), height = std::max(std::abs(d1v), std::abs(d2v));
    const double error_u = (eu + slope_u * ew) * per_safe + 4 * kRoundoff * slope_u;
    const double error_v = (ev + slope_v * ew) * per_safe + 4 * kRoundoff * slope_v;
    const double bound = 2 * (width * error_u + height * error_v + 8 * kRoundoff * (std::abs(w0) + slope_u * width + slope_v * height));
    const bool is_bounded = (safe > 0) & (bound < HUGE_VAL);  // false if it is not a number
    gu = is_bounded ? -nu * per_nw : 0;
    gv = is_bounded ? -nv * per_nw : 0;
    slack = is_bounded ? bound : HUGE_VAL;
  }
};

// Places along a uniform axis in units of cells, so that sample points lie at integers.
struct CellUnits {
  double origin = 0, per_cell = 0, offset = 0, cells = 0;

  explicit CellUnits(const Axis& axis) {
    if (axis.is_graded()) return;
    origin = axis.origin(), cells = static_cast<double>(axis.cells());
    per_cell = 1 / axis.step();
    offset = static_cast<double>(axis.first()) + axis.sample();
  }
  // Bounds |computed t - true t|, and the rounding of the sample points themselves; 1 on a graded axis, where t says nothing.
  TERACELL_IN_LINE double slack(const FacetPlane& plane) const {
    const double reach = offset + cells + (std::abs(origin) + std::abs(plane.w0)) * per_cell;
    const double slack = plane.slack * per_cell * (1 + 8 * kRoundoff) + 16 * kRoundoff * reach;
    return per_cell > 0 ? slack : 1;
  }
};

// Where rays cross one facet. Where a sample point is closer to its plane than the bounds, the exact predicate decides, so the answers are those of
// exact arithmetic. Keeps references to facet and axis.
class FacetHeight {
 public:
  // `axis` is that of the cells, along frame.w.
  FacetHeight(const Facet& facet, const RayFrame& frame, const Axis& axis)
      : facet_(facet), frame_(frame), axis_(axis), plane_(plane_of(facet.vertex, frame)), units_(axis), cell_slack_(units_.slack(plane_)) {
    const auto& [a, b, c] = facet.vertex;
    flat_ = b[frame.w] == a[frame.w] && c[frame.w] == a[frame.w];
  }

  // For the rays u[i] of the row v: cells[i] = the first cell whose sample point, shifted by the tie rule, lies above the facet, or
  // the number of cells. Adds to `exact` how often the exact predicate was called. REQUIRES: all of the rays cross the facet.
  void first_cells(std::span<const double> u, double v, uint32_t* cells, uint64_t& exact) const;

  // For the same rays: subs[i] = the first sub-position (sub_position.hpp) behind cells[i] - 1 that lies above the facet, from 1 to
  // kSubPositions; 0 where that cell has no sample point on both of its sides. `cells` are those of first_cells().
  void first_sub_positions(std::span<const double> u, double v, const uint32_t* cells, uint32_t* subs, uint64_t& exact) const;

 private:
  static FacetPlane plane_of(const std::array<Vec3, 3>& p, const RayFrame& f) {
    return {p[0][f.u], p[0][f.v], p[0][f.w], p[1][f.u], p[1][f.v], p[1][f.w], p[2][f.u], p[2][f.v], p[2][f.w]};
  }
  bool above(double u, double v, double w, uint64_t& exact) const;
  uint32_t first_sub_position(double u, double v, uint32_t cell, uint64_t& exact) const;

  const Facet& facet_;
  const RayFrame frame_;
  const Axis& axis_;
  const FacetPlane plane_;
  const CellUnits units_;
  const double cell_slack_;
  bool flat_;  // w is w0 everywhere, exactly
};

}  // namespace teracell::mesher
