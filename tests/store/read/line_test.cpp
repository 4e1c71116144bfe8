// Lines through cells against points on them.
#include "store/read/line.hpp"

#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

namespace teracell {
namespace {

using namespace testing;

Grid mixed_grid() { return {{Axis::uniform(-1, 0.25, 3, 9, 0.5), Axis::graded({0, 0.1, 0.5, 2, 2.5}, 0.5), Axis::uniform(10, 2, 0, 7, 0.25)}}; }

double share_between(std::mt19937_64& random, double lo, double hi) { return lo + (hi - lo) * std::uniform_real_distribution<double>(0, 1)(random); }

TEST_CASE("The materials along a line are those of its points, for any direction and ray axis; cells are counted once") {
  const Grid grid = mixed_grid();
  std::mt19937_64 random(5);
  const auto cells = random_cells(random, grid.cells(), 4);
  for (const int ray_axis : {0, 1, 2}) {
    const GridReader reader = reader_of(with_tiny_chunks(metadata_of(grid, ray_axis, 4)), cells);
    const Index3 n = grid.cells();
    for (int i = 0; i < 300; ++i) {
      Vec3 a, b;
      for (int d = 0; d < 3; ++d) {
        const double low = grid.axis[d].min(), high = grid.axis[d].max(), more = 0.4 * (high - low);
        a[d] = share_between(random, low - more, high + more);
        b[d] = i % 4 == d ? a[d] : share_between(random, low - more, high + more);  // along planes and axes too
      }
      const auto runs = read_line(reader, a, b);
      double last = 0;
      bool good = true;
      for (size_t r = 0; r < runs.size(); ++r) {
        good &= runs[r].from >= last && runs[r].to > runs[r].from && runs[r].to <= 1 && runs[r].cells > 0;
        if (r > 0) good &= runs[r].from == last && runs[r].material != runs[r - 1].material;
        last = runs[r].to;
      }
      REQUIRE(good);
      // Many points: each that isn't near a plane has the material of its run.
      std::set<Index3> met;
      for (int k = 0; k < 2000; ++k) {
        const double t = (k + 0.5) / 2000;
        Index3 cell;
        bool inside = true;
        for (int d = 0; d < 3; ++d) {
          const double x = a[d] + t * (b[d] - a[d]);
          inside = inside && x > grid.axis[d].min() && x < grid.axis[d].max();
          if (inside) cell[d] = grid.axis[d].cell_at(x);
        }
        const auto run = std::ranges::find_if(runs, [&](const LineRun& r) { return t >= r.from && t < r.to; });
        if (!inside) {
          if (run != runs.end()) good &= t - run->from < 1e-9 || run->to - t < 1e-9;
          continue;
        }
        met.insert(cell);
        const Label label = cells[static_cast<size_t>((cell[2] * n[1] + cell[1]) * n[0] + cell[0])];
        const bool near = std::ranges::any_of(runs, [&](const LineRun& r) { return std::abs(t - r.from) < 1e-9 || std::abs(t - r.to) < 1e-9; });
        good &= near || (run != runs.end() && run->material == label);
      }
      REQUIRE(good);
      int64_t counted = 0;
      for (const LineRun& r : runs) counted += r.cells;
      REQUIRE(counted >= static_cast<int64_t>(met.size()));
      REQUIRE(counted <= n[0] + n[1] + n[2]);
    }
  }
}

TEST_CASE("A line along a row of cells has the runs of the row, with their exact lengths") {
  const Grid grid = mixed_grid();
  std::vector<Label> cells(static_cast<size_t>(grid.cells()[0] * grid.cells()[1] * grid.cells()[2]), 0);
  for (int x = 2; x < 5; ++x) cells[static_cast<size_t>(x)] = 1;
  const GridReader reader = reader_of(metadata_of(grid, 2, 2), cells);
  const double low = grid.axis[0].min(), high = grid.axis[0].max();
  const auto forth = read_line(reader, {low, 0.05, 11}, {high, 0.05, 11}), back = read_line(reader, {high, 0.05, 11}, {low, 0.05, 11});
  REQUIRE(forth.size() == 3);
  CHECK(forth[1].material == 1);
  CHECK(forth[1].cells == 3);
  CHECK(forth[1].from == Approx(2.0 / 9));
  CHECK(forth[1].to == Approx(5.0 / 9));
  REQUIRE(back.size() == 3);
  CHECK(back[1].cells == 3);
  CHECK(back[1].from == Approx(4.0 / 9));
  CHECK(read_line(reader, {low - 2, 0.05, 11}, {low - 1, 0.05, 11}).empty());
  CHECK(read_line(reader, {low, 5, 11}, {high, 5, 11}).empty());
}

}  // namespace
}  // namespace teracell
