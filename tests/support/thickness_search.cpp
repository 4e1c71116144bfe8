#include "tests/support/thickness_search.hpp"

namespace teracell::testing {
// Places are in half cells: centres of cells are odd, corners even.
std::vector<uint32_t> by_search(const Cells& cells, Label label) {
  std::vector<uint32_t> out(cells.labels.size());
  const auto centre = [](const Index3& cell) { return Index3{2 * cell[0] + 1, 2 * cell[1] + 1, 2 * cell[2] + 1}; };
  Cells::each({0, 0, 0}, {2 * cells.n[0] + 1, 2 * cells.n[1] + 1, 2 * cells.n[2] + 1}, [&](const Index3& p) {
    if (p[0] % 2 != p[1] % 2 || p[1] % 2 != p[2] % 2) return;
    const Index3 near = {p[0] / 2, p[1] / 2, p[2] / 2};
    int64_t least = 1000;
    const auto [from, to] = around(near, 5, cells.n);
    Cells::each(from, to, [&](const Index3& c) {
      if (cells.at(c) != label) least = std::min(least, squared(p, centre(c)));
    });
    int64_t allows = 0;  // the thickness
    for (int64_t halves = 2; halves <= 16; ++halves)
      if (4 * least >= (halves + 2) * (halves + 2)) allows = halves;
    if (allows == 0) return;
    const auto [lo, hi] = around(near, 8, cells.n);
    Cells::each(lo, hi, [&](const Index3& c) {
      uint32_t& thickness = out[cells.number(c)];
      if (cells.at(c) == label && allows > thickness && 16 * squared(p, centre(c)) <= (3 * allows + 12) * (3 * allows + 12))
        thickness = static_cast<uint32_t>(allows);
    });
  });
  return out;
}

}  // namespace teracell::testing
