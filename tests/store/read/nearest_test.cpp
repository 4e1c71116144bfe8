// The cell of some labels near a place, against looking at all cells.
#include "store/read/nearest.hpp"

#include "tests/support/checked.hpp"
#include "tests/support/stored.hpp"

namespace teracell {
namespace {

using namespace testing;

struct Looked {
  Grid grid;
  std::vector<Label> cells;

  Label at(const Index3& c) const { return cells[static_cast<size_t>((c[2] * grid.axis[1].cells() + c[1]) * grid.axis[0].cells() + c[0])]; }

  template <class F>
  void each(const std::vector<bool>& labels, F&& f) const {
    const Index3 n = grid.cells();
    for (Index3 c{}; c[2] < n[2]; ++c[2])
      for (c[1] = 0; c[1] < n[1]; ++c[1])
        for (c[0] = 0; c[0] < n[0]; ++c[0])
          if (labels[at(c)]) f(c);
  }

  Box box(const std::vector<bool>& labels) const {
    Box out{.lo = grid.cells(), .hi = {}};
    each(labels, [&](const Index3& c) {
      for (int d = 0; d < 3; ++d) {
        out.lo[d] = std::min(out.lo[d], c[d]);
        out.hi[d] = std::max(out.hi[d], c[d] + 1);
      }
    });
    return out.empty() ? Box{} : out;
  }

  // What a cell is judged by: its distance in shares of the box around all cells of the labels.
  std::function<double(const Index3&)> distance(const std::vector<bool>& labels, const Index3& to) const {
    return [to, around = box(labels)](const Index3& c) {
      double sum = 0;
      for (int d = 0; d < 3; ++d) {
        const double off = static_cast<double>(c[d] - to[d]) / static_cast<double>(around.hi[d] - around.lo[d]);
        sum += off * off;
      }
      return std::sqrt(sum);
    };
  }
};

TEST_CASE("A cell of some labels near a place is one of theirs, at most an eighth farther than the nearest, and none where there is none") {
  for (uint64_t seed = 0; seed < 30; ++seed) {
    std::mt19937_64 random(seed);
    Looked looked{.grid = random_grid(random, 30), .cells = {}};
    const Index3 n = looked.grid.cells();
    looked.cells.resize(static_cast<size_t>(n[0] * n[1] * n[2]));
    for (size_t i = 0; i < 1 + seed * seed; ++i) looked.cells[random() % looked.cells.size()] = static_cast<Label>(1 + random() % 3);
    const GridReader reader = reader_of(with_tiny_chunks(metadata_of(looked.grid, static_cast<int>(seed % 3), 5)), looked.cells);
    for (int k = 0; k < 10; ++k) {
      std::vector<bool> labels(5);
      for (size_t i = 1; i < 5; ++i) labels[i] = random() % 2 == 0;
      Index3 to;
      for (int d = 0; d < 3; ++d) to[d] = static_cast<int64_t>(random() % static_cast<uint64_t>(n[d]));
      const Box around = looked.box(labels);
      if (k % 2 == 0 && !around.empty())
        for (int d = 0; d < 3; ++d) to[d] = (around.lo[d] + around.hi[d] - 1) / 2;
      const auto distance = looked.distance(labels, to);
      double least = std::numeric_limits<double>::infinity();
      looked.each(labels, [&](const Index3& c) { least = std::min(least, distance(c)); });
      const auto [box, found] = read_nearest(reader, labels, to);
      INFO("seed " << seed << ", question " << k);
      REQUIRE(found.has_value() == std::isfinite(least));
      REQUIRE(box == around);
      if (!found) continue;
      REQUIRE(labels[looked.at(*found)]);
      REQUIRE(distance(*found) <= 1.125 * least * (1 + 1e-12));
    }
  }
}

TEST_CASE("Near the middle of a flat hall are its stands, not the floor far below") {
  const Index3 n = {100, 100, 22};
  Looked hall{.grid = unit_grid(n), .cells = std::vector<Label>(static_cast<size_t>(n[0] * n[1] * n[2]))};
  for (size_t i = 0; i < hall.cells.size(); ++i) hall.cells[i] = i / 10000 < 2 || i % 100 < 25 || i % 100 > 75;
  const auto cell = read_nearest(reader_of(metadata_of(hall.grid, 0, 2), hall.cells), {false, true}).cell;
  REQUIRE(cell);
  CHECK(hall.at(*cell) == 1);
  CHECK(std::abs((*cell)[2] - 11) < 4);
}

}  // namespace
}  // namespace teracell
