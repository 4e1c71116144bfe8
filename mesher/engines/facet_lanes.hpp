// Facets, a block of them at once: what doubles say about the rays that cross them and about their planes, side by side on a vector unit
// (vector_units.hpp). Most facets of a fine surface meet only a few rays, so preparing them takes longer than casting their rays. (At 1000^3 cells of
// nefertiti, 6 crossings per facet, casting takes three quarters of the time that it takes with one facet after another.)
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

#include "mesher/engines/engine.hpp"
#include "mesher/engines/height.hpp"
#include "mesher/engines/rows.hpp"

namespace teracell::mesher {

// Vertex k of facet i is at (u[k][i], v[k][i], w[k][i]).
struct FacetLanes {
  static constexpr uint32_t kFacets = 32;
  static constexpr uint32_t kWidth = 8;  // these are computed side by side
  double u[3][kFacets], v[3][kFacets], w[3][kFacets];
  uint32_t layer[kFacets];
  uint32_t size;  // a multiple of kWidth: the last facet is repeated

  // Takes the first kFacets of `facets`. REQUIRES: it is not empty.
  TERACELL_IN_LINE FacetLanes(std::span<const SceneFacet* const> facets, const RayFrame& f) {
    const auto count = static_cast<uint32_t>(std::min<size_t>(facets.size(), kFacets));
    size = (count + kWidth - 1) / kWidth * kWidth;
    for (uint32_t i = 0; i < size; ++i) {
      const SceneFacet& facet = *facets[std::min(i, count - 1)];
      layer[i] = facet.layer;
      for (int k = 0; k < 3; ++k) {
        const Vec3& p = facet.facet.vertex[k];
        u[k][i] = p[f.u], v[k][i] = p[f.v], w[k][i] = p[f.w];
      }
    }
  }

  // Calls lane(i) for each facet, in loops that a compiler can lay side by side.
  template <class Lane>
  TERACELL_IN_LINE void for_each(const Lane& lane) const {
    for (size_t first = 0; first < size; first += kWidth)
      for (size_t i = 0; i < kWidth; ++i) lane(first + i);
  }
};

// For each facet of a block what FacetRows (rows.hpp) finds for one: the rows [begin, end) that meet it, and the edges that its rays lie between.
// Where is_sure is 0, and where rays_of() returns false, only FacetRows can tell.
struct LaneRows {
  static constexpr uint32_t kFacets = FacetLanes::kFacets;
  uint64_t begin[kFacets], end[kFacets];
  double is_sure[kFacets];  // 1 or 0

  TERACELL_IN_LINE LaneRows(const FacetLanes& block, const RayFinder& rays, const RayFinder& rows) {
    block.for_each([&](size_t i) TERACELL_IN_LINE {
      double u0 = block.u[0][i], u1 = block.u[1][i], u2 = block.u[2][i], v0 = block.v[0][i], v1 = block.v[1][i], v2 = block.v[2][i];
      const double most = std::max(std::max(std::abs(u0), std::abs(u1)), std::abs(u2));
      double odd = 0;
      const auto order = [&](double& ua, double& va, double& ub, double& vb) TERACELL_IN_LINE {
        const bool swap = vb < va;
        const double u = swap ? ub : ua, v = swap ? vb : va;
        ub = swap ? ua : ub, vb = swap ? va : vb;
        ua = u, va = v;
        odd = swap ? 1 - odd : odd;
      };
      order(u0, v0, u1, v1), order(u1, v1, u2, v2), order(u0, v0, u1, v1);
      odd_[i] = odd;
      lo_u_[i] = u0, lo_v_[i] = v0, mid_u_[i] = u1, mid_v_[i] = v1;
      longest_[i] = (u2 - u0) / (v2 - v0), lower_[i] = (u1 - u0) / (v1 - v0), upper_[i] = (u2 - u1) / (v2 - v1);
      close_[i] = 0.5 - (FacetEdge::slack(2 * most) * rays.per_ray() * (1 + 0x1p-50) + rays.slack());
      const double s = rows.place_of(v0), t = rows.place_of(v2), whole_s = s + RayFinder::kRound, whole_t = t + RayFinder::kRound;
      begin[i] = std::bit_cast<uint64_t>(whole_s) & 0xffffffff, end[i] = std::bit_cast<uint64_t>(whole_t) & 0xffffffff;
      const double far = std::max(std::abs(s - (whole_s - RayFinder::kRound)), std::abs(t - (whole_t - RayFinder::kRound)));
      is_sure[i] = far < 0.5 - rows.slack() ? (close_[i] > 0.25 ? 1.0 : 0.0) : 0.0;
    });
  }

  // For row begin[i] + r of each of kWidth facets from `first` on, whose coordinate is v[0], v[1], ..: what rays_of() finds for one, or no rays if
  // the facet has fewer rows. REQUIRES: is_sure is 1 for facets with rows. `id` is of the first facet; that of the next one is greater by 2^32.
  TERACELL_IN_LINE bool rays_of_each(size_t first, uint64_t r, const double* v, uint64_t id, const RayFinder& rays, uint64_t* of,
                                     uint64_t* met) const {
    uint64_t ofs[FacetLanes::kWidth], mets[FacetLanes::kWidth];
    double far[FacetLanes::kWidth];
#pragma GCC unroll 1
    for (size_t j = 0; j < FacetLanes::kWidth; ++j) {
      const size_t i = first + j;
      const bool is_lower = v[j] < mid_v_[i];
      const double s = rays.place_of(lo_u_[i] + (v[j] - lo_v_[i]) * longest_[i]), whole_s = s + RayFinder::kRound;
      const double t =
          rays.place_of((is_lower ? lo_u_[i] : mid_u_[i]) + (v[j] - (is_lower ? lo_v_[i] : mid_v_[i])) * (is_lower ? lower_[i] : upper_[i]));
      const double whole_t = t + RayFinder::kRound;
      const uint64_t row = begin[i] + r, here = static_cast<int64_t>(row) < static_cast<int64_t>(end[i]) ? ~uint64_t{0} : 0;
      mets[j] =
          (std::bit_cast<uint64_t>(std::max(whole_s, whole_t)) << 32 | (std::bit_cast<uint64_t>(std::min(whole_s, whole_t)) & 0xffffffff)) & here;
      const uint64_t turns = (whole_s < whole_t ? 1 : 0) ^ (odd_[i] != 0 ? 1 : 0);
      ofs[j] = id + (uint64_t{j} << 32) + ((2 * row + turns) & here);
      const double beyond = std::max(std::abs(s - (whole_s - RayFinder::kRound)), std::abs(t - (whole_t - RayFinder::kRound))) - close_[i];
      far[j] = here != 0 ? beyond : -1;
    }
    for (size_t j = 0; j < FacetLanes::kWidth; ++j) met[j] = mets[j];
    for (size_t j = 0; j < FacetLanes::kWidth; ++j) of[j] = ofs[j];
    for (size_t half = FacetLanes::kWidth / 2; half > 0; half /= 2)
      for (size_t j = 0; j < half; ++j) far[j] = std::max(far[j], far[j + half]);
    return far[0] < 0;
  }

  // For the rows with the coordinates v[0] to v[kRows - 1]: the rays [from, to) that cross facet i, as met[r] = to << 32 | from; and of[r] =
  // id + 2 * r, + 1 if the facet turns left in (u, v). Returns whether that is sure. What is written for rows that do not meet the facet has no
  // meaning. REQUIRES: id is even.
  template <uint32_t kRows>
  TERACELL_IN_LINE bool rays_of(size_t i, const double* v, uint64_t id, const RayFinder& rays, uint64_t* of, uint64_t* met) const {
    const double u0 = lo_u_[i], v0 = lo_v_[i], u1 = mid_u_[i], v1 = mid_v_[i];
    const double longest = longest_[i], lower = lower_[i], upper = upper_[i], close = close_[i];
    const uint64_t straight = id | (odd_[i] != 0), turned = straight ^ 1;
    uint64_t ofs[kRows], mets[kRows];  // a compiler does not know that `of` and `met` are apart from `v`
    double far[kRows];
#pragma GCC unroll 1
    for (size_t r = 0; r < kRows; ++r) {
      const bool is_lower = v[r] < v1;
      const double s = rays.place_of(u0 + (v[r] - v0) * longest), whole_s = s + RayFinder::kRound;
      const double t = rays.place_of((is_lower ? u0 : u1) + (v[r] - (is_lower ? v0 : v1)) * (is_lower ? lower : upper));
      const double whole_t = t + RayFinder::kRound;
      mets[r] = std::bit_cast<uint64_t>(std::max(whole_s, whole_t)) << 32 | (std::bit_cast<uint64_t>(std::min(whole_s, whole_t)) & 0xffffffff);
      ofs[r] = (whole_s < whole_t ? turned : straight) + 2 * r;
      far[r] = std::max(std::abs(s - (whole_s - RayFinder::kRound)), std::abs(t - (whole_t - RayFinder::kRound)));
    }
    for (size_t r = 0; r < kRows; ++r) met[r] = mets[r];
    for (size_t r = 0; r < kRows; ++r) of[r] = ofs[r];
    for (size_t half = kRows / 2; half > 0; half /= 2)
      for (size_t r = 0; r < half; ++r) far[r] = std::max(far[r], far[r + half]);
    return far[0] < close;
  }

 private:
  double lo_u_[kFacets], lo_v_[kFacets], mid_u_[kFacets], mid_v_[kFacets];  // the ends of the lower edge
  double longest_[kFacets], lower_[kFacets], upper_[kFacets];  // slopes of the edges, du / dv
  double close_[kFacets];  // an edge that stays closer than this to a whole number, in units of rays, is surely on this side of them
  double odd_[kFacets];  // the permutation that sorts the vertices by v is odd
};

// Where rays along a uniform axis of cells cross a block of facets.
struct LaneHeights {
  TERACELL_IN_LINE LaneHeights(const FacetLanes& block, const CellUnits& cells) : cells_(cells) {
    block.for_each([&](size_t i) TERACELL_IN_LINE {
      const FacetPlane plane(block.u[0][i], block.v[0][i], block.w[0][i], block.u[1][i], block.v[1][i], block.w[1][i], block.u[2][i], block.v[2][i],
                             block.w[2][i]);
      u0_[i] = plane.u0, v0_[i] = plane.v0, w0_[i] = plane.w0, gv_[i] = plane.gv, slope_[i] = plane.gu * cells.per_cell;
      const double slack = cells.slack(plane);
      slack_[i] = slack < 0.25 ? slack : 1;
    });
    for (size_t i = 0; i < block.size; ++i) rest_[i] = Crossing::pack(0, block.layer[i], false);
  }

  bool can_tell(size_t i) const { return slack_[i] < 0.25; }

  // How far at most facets were from the middle between two sample points, and the error of that, in each place of a block of rays. Where they are
  // close, only FacetHeight::first_cells() can tell. (Rays behind the last one of a span count, too, but seldom make a difference.)
  static constexpr size_t kRays = 8;
  using Far = std::array<double, kRays>;
  static bool is_close(const Far& far) { return *std::max_element(far.begin(), far.end()) >= 0.5; }

  // For the rays u[k] of the row v: crossings[k] = that with facet i, for whole blocks of rays; or the low half of words[k] = its cell + `more`. What
  // is written for rays that do not cross it has no meaning. REQUIRES: a cell + `more` fits into 32 bits.
  TERACELL_IN_LINE void cross(size_t i, const double* u, size_t size, double v, bool up, uint64_t* crossings, Far& far) const {
    for_each(i, u, size, v, 0, far, [=, rest = rest_[i] | up](size_t k, uint64_t cell) TERACELL_IN_LINE { crossings[k] = cell << 32 | rest; });
  }
  TERACELL_IN_LINE void cells(size_t i, const double* u, size_t size, double v, uint32_t more, uint64_t* words, Far& far) const {
    for_each(i, u, size, v, more, far, [=](size_t k, uint64_t cell) TERACELL_IN_LINE { words[k] = cell; });
  }

 private:
  static constexpr uint32_t kFacets = FacetLanes::kFacets;

  // take(k, cell): the low half of the bits of `cell` is the cell + `more`.
  template <class Take>
  TERACELL_IN_LINE void for_each(size_t i, const double* u, size_t size, double v, uint32_t more, Far& far, const Take& take) const {
    // A number below 2^51 that is added to this one is rounded to an integer, which is what the low half of the sum's bits say.
    const double round = 0x1.8p52 + more;
    const double base = (w0_[i] + gv_[i] * (v - v0_[i]) - cells_.origin) * cells_.per_cell - cells_.offset + 0.5;
    const double slope = slope_[i], u0 = u0_[i], slack = slack_[i], most = cells_.cells;
    for (size_t k = 0; k < size; k += kRays)
#pragma GCC unroll 1
      for (size_t j = 0; j < kRays; ++j) {
        const double t = std::min(std::max(base + slope * (u[k + j] - u0), 0.0), most), sum = t + round;
        take(k + j, std::bit_cast<uint64_t>(sum));
        far[j] = std::max(far[j], std::abs(t - (sum - round)) + slack);
      }
  }

  const CellUnits cells_;
  double u0_[kFacets], v0_[kFacets], w0_[kFacets], gv_[kFacets];
  double slope_[kFacets];  // along u, in cells
  double slack_[kFacets];  // in units of cells; 1 where doubles say nothing
  uint64_t rest_[kFacets];
};

}  // namespace teracell::mesher
