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

// The plane of the facet as w(u, v) = w0 + gu * (u - u0) + gv * (v - v0), with a bound on its rounding error. Where a sample
// point is closer than the bound, the exact predicate decides, so the answers are those of exact arithmetic. Keeps references
// to facet and axis.
class FacetHeight {
 public:
  // `axis` is that of the cells, along frame.w.
  TERACELL_IN_LINE FacetHeight(const Facet& facet, const RayFrame& frame, const Axis& axis) : facet_(facet), frame_(frame), axis_(axis) {
    const auto& [a, b, c] = facet.vertex;
    u0_ = a[frame.u], v0_ = a[frame.v], w0_ = a[frame.w];
    flat_ = b[frame.w] == w0_ && c[frame.w] == w0_;
    if (flat_) return;
    bound_plane();
    if (!axis.is_graded()) bound_cells();
  }

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
  TERACELL_IN_LINE void bound_plane() {
    const auto& [a, b, c] = facet_.vertex;
    const RayFrame& f = frame_;
    const double d1u = b[f.u] - u0_, d1v = b[f.v] - v0_, d1w = b[f.w] - w0_;
    const double d2u = c[f.u] - u0_, d2v = c[f.v] - v0_, d2w = c[f.w] - w0_;
    // The normal. The error of each component is at most four roundings of its two products.
    const double nu = d1v * d2w - d1w * d2v, eu = 4 * kRoundoff * (std::abs(d1v * d2w) + std::abs(d1w * d2v));
    const double nv = d1w * d2u - d1u * d2w, ev = 4 * kRoundoff * (std::abs(d1w * d2u) + std::abs(d1u * d2w));
    const double nw = d1u * d2v - d1v * d2u, ew = 4 * kRoundoff * (std::abs(d1u * d2v) + std::abs(d1v * d2u));
    const double safe = std::abs(nw) - ew;
    if (!(safe > 0)) {
      slack_ = HUGE_VAL;
      return;
    }
    // Divisions take long, so there are two in place of four, for which a gradient has one rounding more.
    const double per_nw = 1 / nw, per_safe = 1 / safe;
    gu_ = -nu * per_nw;
    gv_ = -nv * per_nw;
    // The error of the gradient, then that of the two terms over the extent of the facet and of what is made of their sum (eight roundings). It
    // is doubled to cover the second-order terms that are left out.
    const double width = std::max(std::abs(d1u), std::abs(d2u)), height = std::max(std::abs(d1v), std::abs(d2v));
    const double slope_u = std::abs(gu_), slope_v = std::abs(gv_);
    const double error_u = (eu + slope_u * ew) * per_safe + 4 * kRoundoff * slope_u;
    const double error_v = (ev + slope_v * ew) * per_safe + 4 * kRoundoff * slope_v;
    slack_ = 2 * (width * error_u + height * error_v + 8 * kRoundoff * (std::abs(w0_) + slope_u * width + slope_v * height));
    if (!(slack_ < HUGE_VAL)) slack_ = HUGE_VAL;  // if it is not a number
  }
  // In units of cells, sample points lie at integers t. The bound includes the rounding of the sample points themselves and of t.
  TERACELL_IN_LINE void bound_cells() {
    axis_origin_ = axis_.origin(), cells_ = static_cast<double>(axis_.cells());
    per_cell_ = 1 / axis_.step();
    offset_ = static_cast<double>(axis_.first()) + axis_.sample();
    const double reach = offset_ + cells_ + (std::abs(axis_origin_) + std::abs(w0_)) * per_cell_;
    cell_slack_ = slack_ * per_cell_ * (1 + 8 * kRoundoff) + 16 * kRoundoff * reach;
  }
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
