#include "mesher/engines/height.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "mesher/engines/predicates.hpp"
#include "mesher/engines/sub_position.hpp"
#include "store/base/system/vector_units.hpp"

namespace teracell::mesher {

bool FacetHeight::above(double u, double v, double w, uint64_t& exact) const {
  Vec3 p;
  p[frame_.u] = u;
  p[frame_.v] = v;
  p[frame_.w] = w;
  ++exact;
  return is_above(facet_, frame_.w, p);
}

void FacetHeight::first_cells(std::span<const double> u, double v, uint32_t* cells, uint64_t& exact) const {
  if (flat_) {
    std::fill_n(cells, u.size(), static_cast<uint32_t>(axis_.first_centre_from(plane_.w0)));
    return;
  }
  const double base = plane_.w0 + plane_.gv * (v - plane_.v0);
  if (cell_slack_ < 0.25) {
    constexpr size_t kBlock = 8;
    constexpr double kRound = 0x1.8p52;  // adding and subtracting it rounds to the nearest integer
    const double most = static_cast<double>(axis_.cells()) - 0.5, min = axis_.origin();
    const auto height = [=, this](double ray) TERACELL_IN_LINE {
      return std::clamp((base + plane_.gu * (ray - plane_.u0) - min) * units_.per_cell - units_.offset, -0.5, most);
    };
    double closest = 1;
    on_vector_unit([=, &u, &closest]() TERACELL_IN_LINE {
      // Most rows are no longer than two or three vectors, so what is left of them is no loop of its own: the last block overlaps the one before.
      const double* const rays = u.data();
      const size_t size = u.size();
      std::array<double, kBlock> near;
      near.fill(1);
      const auto block = [&](size_t begin, size_t width) TERACELL_IN_LINE {
        for (size_t j = 0; j < width; ++j) {
          const double t = height(rays[begin + j]), r = (t + kRound) - kRound;
          cells[begin + j] = static_cast<uint32_t>(static_cast<int32_t>(r) + (t > r));
          near[j] = std::min(near[j], std::abs(t - r));
        }
      };
      if (size >= kBlock) {
        for (size_t i = 0; i + kBlock <= size; i += kBlock) block(i, kBlock);
        if (size % kBlock != 0) block(size - kBlock, kBlock);
      } else if (size >= kBlock / 2) {
        block(0, kBlock / 2);
        block(size - kBlock / 2, kBlock / 2);
      } else {
        block(0, size);
      }
      for (size_t half = kBlock / 2; half > 0; half /= 2)
        for (size_t j = 0; j < half; ++j) near[j] = std::min(near[j], near[j + half]);
      closest = near[0];
    });
    if (closest > cell_slack_) return;
    for (size_t i = 0; i < u.size(); ++i) {
      const double t = height(u[i]), r = (t + kRound) - kRound;
      const auto cell = static_cast<uint32_t>(static_cast<int32_t>(r));
      if (std::abs(t - r) <= cell_slack_ && cell < axis_.cells()) cells[i] = above(u[i], v, axis_.centre(cell), exact) ? cell : cell + 1;
    }
    return;
  }
  for (size_t i = 0; i < u.size(); ++i) {  // a graded axis, or a facet too steep for the bound
    int64_t lo = 0, hi = axis_.cells();
    if (plane_.slack < HUGE_VAL) {
      const double w = base + plane_.gu * (u[i] - plane_.u0);
      lo = axis_.first_centre_from(w - plane_.slack);
      hi = axis_.first_centre_from(std::nextafter(w + plane_.slack, HUGE_VAL));
    }
    while (lo < hi) {
      const int64_t middle = (lo + hi) / 2;
      if (above(u[i], v, axis_.centre(middle), exact)) hi = middle;
      else lo = middle + 1;
    }
    cells[i] = static_cast<uint32_t>(lo);
  }
}

void FacetHeight::first_sub_positions(std::span<const double> u, double v, const uint32_t* cells, uint32_t* subs, uint64_t& exact) const {
  const double base = plane_.w0 + plane_.gv * (v - plane_.v0);
  const auto last = static_cast<uint32_t>(axis_.cells() - 1);
  const auto between = [&](uint32_t cell) { return cell - 1 < last; };  // two sample points
  if (flat_ || !(cell_slack_ < 0.25 / kSubPositions)) {
    for (size_t i = 0; i < u.size(); ++i) subs[i] = between(cells[i]) ? first_sub_position(u[i], v, cells[i], exact) : 0;
    return;
  }
  constexpr double kRound = 0x1.8p52;  // adding and subtracting it rounds to the nearest integer
  const double bound = 2 * cell_slack_ * kSubPositions, min = axis_.origin();
  double closest = 1;
  const auto place = [&](size_t i) {
    const double t = (base + plane_.gu * (u[i] - plane_.u0) - min) * units_.per_cell - units_.offset;
    return std::clamp((t - (static_cast<int32_t>(cells[i]) - 1)) * kSubPositions, 0.0, double{kSubPositions});
  };
  for (size_t i = 0; i < u.size(); ++i) {
    const double x = place(i), r = (x + kRound) - kRound;
    const bool is_between = between(cells[i]);
    subs[i] = is_between ? static_cast<uint32_t>(static_cast<int32_t>(r) + (x > r)) : 0;
    closest = std::min(closest, is_between ? std::abs(x - r) : 1);
  }
  if (closest > bound) return;
  for (size_t i = 0; i < u.size(); ++i) {
    if (!between(cells[i])) continue;
    const double x = place(i);
    if (std::abs(x - ((x + kRound) - kRound)) <= bound) subs[i] = first_sub_position(u[i], v, cells[i], exact);
  }
}

// In units of sub-positions above the lower sample point, the facet lies at x, and the bound includes the rounding of sub-positions. Between
// two integers, nearly always neighbours, the exact predicate decides.
uint32_t FacetHeight::first_sub_position(double u, double v, uint32_t cell, uint64_t& exact) const {
  const double lower = axis_.centre(int64_t{cell} - 1), upper = axis_.centre(cell);
  int64_t below = 0, from = kSubPositions;  // the first one above lies in (below, from]
  if (flat_ || plane_.slack < HUGE_VAL) {
    const double w = flat_ ? plane_.w0 : plane_.w0 + plane_.gv * (v - plane_.v0) + plane_.gu * (u - plane_.u0);
    const double per = kSubPositions / (upper - lower), x = (w - lower) * per;
    const double bound = ((flat_ ? 0 : plane_.slack) + 8 * kRoundoff * (std::abs(lower) + std::abs(upper) + std::abs(w))) * per + 1e-9;
    below = static_cast<int64_t>(std::clamp(std::floor(x - bound), 0.0, kSubPositions - 1.0));
    from = static_cast<int64_t>(std::clamp(std::ceil(x + bound), static_cast<double>(below + 1), double{kSubPositions}));
  }
  while (from - below > 1) {
    const int64_t middle = (below + from) / 2;
    const double q = sub_position(axis_, int64_t{cell} - 1, static_cast<uint32_t>(middle));
    (flat_ ? q >= plane_.w0 : above(u, v, q, exact)) ? from = middle : below = middle;
  }
  return static_cast<uint32_t>(from);
}

}  // namespace teracell::mesher
