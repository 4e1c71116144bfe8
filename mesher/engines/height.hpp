// Where rays cross a facet, in cells: the first cell whose sample point lies above the facet. All engines use it.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

#include "mesher/engines/engine.hpp"
#include "store/base/system/vector_units.hpp"

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

  // The same in doubles alone, for loops that run on a vector unit (vector_units.hpp): crossings[i] = first cell << 32 | rest, for whole blocks
  // of rays. What is written for rays that do not cross the facet has no meaning. `far` is how far at most the facet was from the middle between
  // two sample points, in each place of a block; if it is_close() in the end, first_cells() must say where it was right. REQUIRES: is_plain().
  static constexpr size_t kBlock = 8;
  using Far = std::array<double, kBlock>;
  TERACELL_IN_LINE void plain_crossings(const double* u, size_t size, double v, uint64_t rest, uint64_t* crossings, Far& far) const {
    // A number below 2^51 that is added to this one is rounded to an integer, which is what the low half of the sum's bits say.
    constexpr double kRound = 0x1.8p52;
    const double base = (w0_ + gv_ * (v - v0_) - axis_origin_) * per_cell_ - offset_ + 0.5, slope = gu_ * per_cell_;
    for (size_t i = 0; i < size; i += kBlock)
#pragma GCC unroll 1
      for (size_t j = 0; j < kBlock; ++j) {
        const double t = std::min(std::max(base + slope * (u[i + j] - u0_), 0.0), cells_), sum = t + kRound;
        crossings[i + j] = std::bit_cast<uint64_t>(sum) << 32 | rest;
        far[j] = std::max(far[j], std::abs(t - (sum - kRound)));
      }
  }
  bool is_plain() const { return !flat_ && cell_slack_ < 0.25; }
  bool is_close(const Far& far) const { return *std::max_element(far.begin(), far.end()) >= 0.5 - cell_slack_; }

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
  double per_cell_ = 0, offset_ = 0, axis_origin_ = 0, cells_ = 0, cell_slack_ = 1;
};

}  // namespace teracell::mesher
