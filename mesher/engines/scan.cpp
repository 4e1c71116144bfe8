// The default engine: scan conversion of each facet's projection over the rays of a tile.
//
// Per facet and row of rays two edges are intersected with the row; between them every ray crosses the facet, at a
// height that is linear along the row. Both questions (which ray comes first right of the edge, which sample point
// first above the plane) are answered from doubles with a proven error bound and, within the bound, by the exact
// predicates. As the answers are exact, neighbouring facets agree on every shared edge without sharing any state.
//
// Two passes over the rows: the first keeps spans and counts them in a difference array, so that the second can
// write every crossing straight to its ray. On nefertiti at 10^12 cells (26 x 26 rays a facet) a crossing costs
// about 5 ns here, half of it in the scattered write.
//
// After S. Patil, B. Ravi, "Voxel-based representation, display and thickness analysis of intricate shapes" (2005)
// and the division-free ray casting of T. Ma, T. Ma, L. Hao (MSAM 2020); the bounds are ours.
#include "mesher/engines/scan.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "mesher/predicates.hpp"
#include "store/error.hpp"

namespace teracell {
namespace {

constexpr double kUnit = 0x1p-53;  // the unit roundoff
constexpr uint64_t kMaxCrossings = uint64_t{1} << 28;  // of a tile: 2 GiB

}  // namespace

// Finds, for the line through lo and hi, the first ray of a row that passes right of it.
class ScanEngine::Edge {
 public:
  Edge() = default;
  Edge(const Vec3& lo, const Vec3& hi, const Frame& f)
      : lo_u_(lo[f.u]), lo_v_(lo[f.v]), hi_u_(hi[f.u]), hi_v_(hi[f.v]), slope_((hi_u_ - lo_u_) / (hi_v_ - lo_v_)) {
    // u(v) = lo_u + (v - lo_v) * slope: six roundings of at most |hi_u - lo_u|, one of |lo_u| more; an upright edge is exact.
    slack_ = hi_u_ == lo_u_ ? 0 : 9 * kUnit * (std::abs(lo_u_) + std::abs(hi_u_));
  }

  uint32_t first_right(double v, const std::vector<double>& rays, double per_unit, uint64_t& exact) const {
    const double u = lo_u_ + (v - lo_v_) * slope_;
    const double guess = (u - rays[0]) * per_unit;
    const auto n = static_cast<int64_t>(rays.size());
    int64_t i = guess <= 0 ? 0 : guess >= static_cast<double>(n) ? n : static_cast<int64_t>(guess);
    while (i > 0 && rays[i - 1] >= u - slack_) --i;
    while (i < n && rays[i] < u - slack_) ++i;
    while (i < n && rays[i] <= u + slack_) {
      if (slack_ == 0) break;
      ++exact;
      if (right_of_edge(lo_u_, lo_v_, hi_u_, hi_v_, rays[i], v)) break;
      ++i;
    }
    return static_cast<uint32_t>(i);
  }

 private:
  double lo_u_ = 0, lo_v_ = 0, hi_u_ = 0, hi_v_ = 0, slope_ = 0, slack_ = 0;
};

// The facet's plane as w(u, v) = w0 + gu * (u - u0) + gv * (v - v0).
struct ScanEngine::Plane {
  double u0, v0, w0, gu, gv;
  double slack;  // bounds |computed - true w| over the facet's projection; infinite: don't use
  bool flat;     // w is w0 everywhere, exactly

  Plane(const Facet& facet, const Frame& f) {
    const auto& [a, b, c] = facet.vertex;
    u0 = a[f.u], v0 = a[f.v], w0 = a[f.w];
    const double d1u = b[f.u] - u0, d1v = b[f.v] - v0, d1w = b[f.w] - w0;
    const double d2u = c[f.u] - u0, d2v = c[f.v] - v0, d2w = c[f.w] - w0;
    flat = b[f.w] == w0 && c[f.w] == w0;
    // The normal; each component carries at most four roundings of its two products.
    const double nu = d1v * d2w - d1w * d2v, eu = 4 * kUnit * (std::abs(d1v * d2w) + std::abs(d1w * d2v));
    const double nv = d1w * d2u - d1u * d2w, ev = 4 * kUnit * (std::abs(d1w * d2u) + std::abs(d1u * d2w));
    const double nw = d1u * d2v - d1v * d2u, ew = 4 * kUnit * (std::abs(d1u * d2v) + std::abs(d1v * d2u));
    gu = -nu / nw;
    gv = -nv / nw;
    const double safe = std::abs(nw) - ew;
    if (!(safe > 0)) {
      slack = HUGE_VAL;
      return;
    }
    // The gradient's error, then that of the two terms over the facet's extent and of their sum; doubled for the
    // second-order terms that this leaves out.
    const double width = std::max(std::abs(d1u), std::abs(d2u)), height = std::max(std::abs(d1v), std::abs(d2v));
    const double slope_u = std::abs(gu), slope_v = std::abs(gv);
    const double error_u = (eu + slope_u * ew) / safe + 4 * kUnit * slope_u;
    const double error_v = (ev + slope_v * ew) / safe + 4 * kUnit * slope_v;
    slack = 2 * (width * error_u + height * error_v + 4 * kUnit * (std::abs(w0) + slope_u * width + slope_v * height));
    if (!(slack < HUGE_VAL)) slack = HUGE_VAL;  // not a number either
  }
};

void ScanEngine::cast(const Tile& tile, std::span<const SceneFacet* const> facets, Crossings& out) {
  const uint32_t nu = static_cast<uint32_t>(tile.u.size());
  find_spans(tile, facets);
  // counts_ holds, a row at a time, how many spans start minus how many end at each ray.
  out.begin.resize(tile.rays() + 1);
  uint64_t total = 0;
  for (size_t row = 0; row < tile.v.size(); ++row) {
    int covering = 0;
    for (uint32_t i = 0; i < nu; ++i) {
      covering += counts_[row * (nu + 1) + i];
      out.begin[row * nu + i] = static_cast<uint32_t>(total);
      total += covering;
    }
  }
  if (total > kMaxCrossings)
    throw InputError(fmt::format("{} x {} rays cross the surfaces {} times, more than {} times: they are too many sheets for one tile", nu, tile.v.size(), total,
                                 kMaxCrossings));
  out.begin.back() = static_cast<uint32_t>(total);
  out.all.resize(total);
  next_.assign(out.begin.begin(), out.begin.end() - 1);
  find_heights(tile, facets, out);
}

void ScanEngine::find_spans(const Tile& tile, std::span<const SceneFacet* const> facets) {
  const Frame& f = tile.frame;
  const auto nu = static_cast<uint32_t>(tile.u.size()), nv = static_cast<uint32_t>(tile.v.size());
  counts_.assign((nu + 1) * nv, 0);
  spans_.clear();
  const double per_u = nu > 1 ? (nu - 1) / (tile.u.back() - tile.u[0]) : 0;
  const double per_v = nv > 1 ? (nv - 1) / (tile.v.back() - tile.v[0]) : 0;
  // The first row whose centre is at or above v.
  const auto first_row = [&](double v) {
    const double guess = (v - tile.v[0]) * per_v;
    uint32_t j = guess <= 0 ? 0 : guess >= nv ? nv : static_cast<uint32_t>(guess);
    while (j > 0 && tile.v[j - 1] >= v) --j;
    while (j < nv && tile.v[j] < v) ++j;
    return j;
  };

  for (uint32_t index = 0; index < facets.size(); ++index) {
    const Facet& facet = facets[index]->facet;
    const Vec3 *lo = &facet.vertex[0], *mid = &facet.vertex[1], *hi = &facet.vertex[2];
    bool odd = false;  // the permutation that sorts by v
    const auto order = [&](const Vec3*& a, const Vec3*& b) {
      if ((*b)[f.v] < (*a)[f.v]) std::swap(a, b), odd = !odd;
    };
    order(lo, mid), order(mid, hi), order(lo, mid);
    const uint32_t from = first_row((*lo)[f.v]), to = first_row((*hi)[f.v]);
    if (from == to) continue;
    const uint32_t turn = std::clamp(first_row((*mid)[f.v]), from, to);
    const Edge longest(*lo, *hi, f);
    const auto rows = [&](const Edge& other, uint32_t begin, uint32_t end) {
      for (uint32_t j = begin; j < end; ++j) {
        const uint32_t a = longest.first_right(tile.v[j], tile.u, per_u, exact_decisions_);
        const uint32_t b = other.first_right(tile.v[j], tile.u, per_u, exact_decisions_);
        if (a == b) continue;
        // With the long edge on the left the sorted triangle turns left, and its normal points up.
        const uint32_t left = std::min(a, b), right = std::max(a, b);
        spans_.push_back({index, j, left, right, (a < b) != odd});
        int32_t* count = counts_.data() + j * (nu + 1);
        ++count[left];
        --count[right];
      }
    };
    if (from < turn) rows(Edge(*lo, *mid, f), from, turn);
    if (turn < to) rows(Edge(*mid, *hi, f), turn, to);
  }
}

void ScanEngine::find_heights(const Tile& tile, std::span<const SceneFacet* const> facets, Crossings& out) {
  const auto nu = static_cast<uint32_t>(tile.u.size());
  for (size_t s = 0; s < spans_.size();) {
    const uint32_t index = spans_[s].facet;
    const SceneFacet& facet = *facets[index];
    const Plane plane(facet.facet, tile.frame);
    for (; s < spans_.size() && spans_[s].facet == index; ++s) {
      const Span& span = spans_[s];
      cells_of_span(tile, facet.facet, plane, span);
      uint32_t* next = next_.data() + span.row * nu;
      const uint64_t rest = Crossing::pack(0, facet.layer, span.up);
      for (uint32_t i = span.from; i < span.to; ++i) out.all[next[i]++] = uint64_t{cells_[i]} << 32 | rest;
    }
  }
}

// Fills cells_[span.from .. span.to) with the first cell whose sample point lies above the facet.
void ScanEngine::cells_of_span(const Tile& tile, const Facet& facet, const Plane& plane, const Span& span) {
  const Axis& axis = *tile.axis;
  const auto n = static_cast<uint32_t>(axis.cells());
  cells_.resize(tile.u.size());
  if (plane.flat) {
    const auto cell = static_cast<uint32_t>(axis.first_centre_from(plane.w0));
    std::fill(cells_.begin() + span.from, cells_.begin() + span.to, cell);
    return;
  }
  const double v = tile.v[span.row];
  Vec3 p;
  p[tile.frame.v] = v;
  const auto above = [&](uint32_t i, int64_t cell) {
    p[tile.frame.u] = tile.u[i];
    p[tile.frame.w] = axis.centre(cell);
    ++exact_decisions_;
    return is_above(facet, tile.frame.w, p);
  };
  const double base = plane.w0 + plane.gv * (v - plane.v0);

  if (!axis.is_graded()) {
    // In units of cells, t = (w - min) / step - first - sample; a sample point lies at every whole t. Bounded are also
    // the roundings of the centres themselves and of t.
    const double per_cell = 1 / axis.step(), offset = static_cast<double>(axis.first()) + axis.sample();
    const double reach = offset + n + (std::abs(axis.origin()) + std::abs(plane.w0)) * per_cell;
    const double slack = plane.slack * per_cell * (1 + 8 * kUnit) + 16 * kUnit * reach;
    if (slack < 0.25) {
      constexpr double kRound = 0x1.8p52;  // adding and subtracting it rounds to the nearest integer
      const double least = -0.5, most = n - 0.5, min = axis.origin();
      double closest = 1;
      for (uint32_t i = span.from; i < span.to; ++i) {
        double t = (base + plane.gu * (tile.u[i] - plane.u0) - min) * per_cell - offset;
        t = t < least ? least : t > most ? most : t;
        const double r = (t + kRound) - kRound;
        cells_[i] = static_cast<uint32_t>(static_cast<int32_t>(r) + (t > r));
        const double distance = std::abs(t - r);
        closest = distance < closest ? distance : closest;
      }
      if (closest > slack) return;
      for (uint32_t i = span.from; i < span.to; ++i) {
        double t = (base + plane.gu * (tile.u[i] - plane.u0) - min) * per_cell - offset;
        t = std::clamp(t, least, most);
        const double r = (t + kRound) - kRound;
        const auto cell = static_cast<uint32_t>(static_cast<int32_t>(r));
        if (std::abs(t - r) <= slack && cell < n) cells_[i] = above(i, cell) ? cell : cell + 1;
      }
      return;
    }
  }
  for (uint32_t i = span.from; i < span.to; ++i) {  // a graded axis, or a facet too steep for the bound
    int64_t lo = 0, hi = n;
    if (plane.slack < HUGE_VAL) {
      const double w = base + plane.gu * (tile.u[i] - plane.u0);
      lo = axis.first_centre_from(w - plane.slack);
      hi = axis.first_centre_from(std::nextafter(w + plane.slack, HUGE_VAL));
    }
    while (lo < hi) {
      const int64_t middle = (lo + hi) / 2;
      if (above(i, middle)) hi = middle;
      else lo = middle + 1;
    }
    cells_[i] = static_cast<uint32_t>(lo);
  }
}

}  // namespace teracell
