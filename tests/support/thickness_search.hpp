// The thickness of walls by a search over all balls, for small grids.
#pragma once
#include "tests/support/test.hpp"

namespace teracell::testing {

// The cells [z][y][x] of a grid.
struct Cells {
  Index3 n;
  std::vector<Label> labels;
  explicit Cells(const Index3& size) : n(size), labels(static_cast<size_t>(n[0] * n[1] * n[2])) {}
  size_t number(const Index3& c) const { return static_cast<size_t>((c[2] * n[1] + c[1]) * n[0] + c[0]); }
  Label at(const Index3& c) const { return labels[number(c)]; }
  template <class F>
  static void each(const Index3& lo, const Index3& hi, F&& f) {
    Index3 c;
    for (c[2] = lo[2]; c[2] < hi[2]; ++c[2])
      for (c[1] = lo[1]; c[1] < hi[1]; ++c[1])
        for (c[0] = lo[0]; c[0] < hi[0]; ++c[0]) f(c);
  }
  // Whether the centre of a cell meets a condition.
  template <class F>
  void fill(Label label, F&& is_in) {
    each({0, 0, 0}, n, [&](const Index3& c) {
      if (is_in(Vec3{static_cast<double>(c[0]) + 0.5, static_cast<double>(c[1]) + 0.5, static_cast<double>(c[2]) + 0.5})) labels[number(c)] = label;
    });
  }
};

// The box of the positions that are at most `reach` away from a place and in [0, n).
inline std::pair<Index3, Index3> around(const Index3& place, int64_t reach, const Index3& n) {
  Index3 lo, hi;
  for (size_t d = 0; d < 3; ++d) lo[d] = std::max<int64_t>(0, place[d] - reach), hi[d] = std::min(n[d], place[d] + reach + 1);
  return {lo, hi};
}

inline int64_t squared(const Index3& a, const Index3& b) {
  int64_t out = 0;
  for (size_t d = 0; d < 3; ++d) out += (a[d] - b[d]) * (a[d] - b[d]);
  return out;
}

// In half cells, 0 for other labels: every ball around each place.
std::vector<uint32_t> by_search(const Cells& cells, Label label);

}  // namespace teracell::testing
