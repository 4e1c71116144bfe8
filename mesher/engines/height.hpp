// Where rays cross a facet, in cells: the first cell whose sample point lies above the facet. All engines use it.
#pragma once
#include <cstdint>
#include <span>

#include "mesher/engines/engine.hpp"

namespace teracell::mesher {

// The plane of the facet as w(u, v) = w0 + gu * (u - u0) + gv * (v - v0), with a bound on its rounding error. Where a sample
// point is closer than the bound, the exact predicate decides, so the answers are those of exact arithmetic. Keeps references
// to facet and axis.
class FacetHeight {
 public:
  // `axis` is that of the cells, along frame.w.
  FacetHeight(const Facet& facet, const RayFrame& frame, const Axis& axis);

  // For the rays u[i] of the row v: cells[i] = the first cell whose sample point, shifted by the tie rule, lies above the facet, or
  // the number of cells. Adds to `exact` how often the exact predicate was called. REQUIRES: all of the rays cross the facet.
  void first_cells(std::span<const double> u, double v, uint32_t* cells, uint64_t& exact) const;

  // For the same rays: subs[i] = the first sub-position (sub_position.hpp) behind cells[i] - 1 that lies above the facet, from 1 to
  // kSubPositions; 0 where that cell has no sample point on both of its sides. `cells` are those of first_cells().
  void first_sub_positions(std::span<const double> u, double v, const uint32_t* cells, uint32_t* subs, uint64_t& exact) const;

 private:
  void bound_plane();
  void bound_cells();
  bool above(double u, double v, double w, uint64_t& exact) const;
  uint32_t first_sub_position(double u, double v, uint32_t cell, uint64_t& exact) const;

  const Facet& facet_;
  const RayFrame frame_;
  const Axis& axis_;
  double u0_, v0_, w0_, gu_ = 0, gv_ = 0;
  double slack_;  // bounds |computed w - true w| over the projection of the facet; infinite: there is no bound
  bool flat_;     // w is w0 everywhere, exactly
  // For a uniform axis, in units of cells: t = (w - min) * per_cell - offset, and the bound of |computed t - true t|.
  double per_cell_ = 0, offset_ = 0, cell_slack_ = 1;
};

}  // namespace teracell::mesher
