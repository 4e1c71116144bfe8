// Pictures of planes against their pixels' cells, one by one, and against slices.
#include "store/read/plane.hpp"

#include "store/read/query.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

namespace teracell {
namespace {

using namespace testing;

constexpr uint16_t kOutside = 999;

Grid three_axes() {
  return {{Axis::uniform(-1, 0.25, 3, 19, 0.5), Axis::graded({0, 0.1, 0.5, 2, 2.5, 2.75, 4}, 0.5), Axis::uniform(10, 0.5, 0, 17, 0.25)}};
}

// The pixels of the view, the lowest row first.
std::vector<uint16_t> pixels_of(const GridReader& reader, const PlaneView& view, int threads = 1, int64_t held = kHeldCells, bool top_down = false) {
  const int64_t width = view.i1 - view.i0;
  std::vector<uint16_t> out(static_cast<size_t>(width * (view.j1 - view.j0)), 12345);
  int64_t next = top_down ? view.j1 - 1 : view.j0;
  for_each_plane_row(
      reader, view, strongest_material(reader.meta()), kOutside, top_down, threads,
      [&](int64_t j, std::span<const uint16_t> row) {
        REQUIRE(j == next);
        next += top_down ? -1 : 1;
        REQUIRE(std::ssize(row) == width);
        std::ranges::copy(row, out.begin() + (j - view.j0) * width);
      },
      held);
  return out;
}

PlaneView random_view(std::mt19937_64& random, const Grid& grid, int level) {
  std::uniform_real_distribution<double> share(0, 1);
  PlaneView view{.i1 = 37, .j1 = 23, .level = level};
  for (size_t d = 0; d < 3; ++d) {
    const double length = grid.axis[d].max() - grid.axis[d].min();
    view.right[d] = (share(random) - 0.5) * length / 15;
    view.up[d] = (share(random) - 0.5) * length / 10;
    view.corner[d] = grid.axis[d].min() + share(random) * length - 18 * view.right[d] - 12 * view.up[d];
  }
  return view;
}

TEST_CASE("Each pixel of a plane has the cell in which its middle lies, for any plane, ray axis and level", "[long]") {
  const Grid grid = three_axes();
  std::mt19937_64 random(11);
  const auto cells = random_cells(random, grid.cells(), 4);
  for (const int ray_axis : {0, 1, 2}) {
    const GridReader reader = reader_of(with_tiny_chunks(metadata_of(grid, ray_axis, 4)), cells);
    int inside = 0, outside = 0;
    for (int n = 0; n < 60; ++n) {
      const int level = n % 3;
      const PlaneView view = random_view(random, grid, level);
      const auto pixels = pixels_of(reader, view);
      bool good = true;
      size_t at = 0;
      for (int64_t j = 0; j < view.j1; ++j)
        for (int64_t i = 0; i < view.i1; ++i, ++at) {
          Index3 cell;
          bool is_inside = true;
          for (size_t d = 0; d < 3; ++d) {
            const double x = view.corner[d] + (static_cast<double>(j) + 0.5) * view.up[d] + (static_cast<double>(i) + 0.5) * view.right[d];
            is_inside &= x >= grid.axis[d].plane(0) && x < grid.axis[d].plane(grid.axis[d].cells());
            for (cell[d] = 0; cell[d] + 1 < grid.axis[d].cells() && grid.axis[d].plane(cell[d] + 1) <= x;) ++cell[d];
          }
          ++(is_inside ? inside : outside);
          if (!is_inside) {
            good &= pixels[at] == kOutside;
            continue;
          }
          Box box;
          for (size_t d = 0; d < 3; ++d) box.lo[d] = cell[d] >> level, box.hi[d] = box.lo[d] + 1;
          uint16_t expected = 0;
          read_box<uint16_t>(reader, level, box, strongest_material(reader.meta()), 0, &expected, {1, 1, 1});
          good &= pixels[at] == expected;
        }
      REQUIRE(good);
    }
    CHECK(inside > 10000);
    CHECK(outside > 1000);
  }
}

TEST_CASE("A plane is the same in parts, on many threads, in little memory and from the top") {
  const Grid grid = three_axes();
  std::mt19937_64 random(12);
  const GridReader reader = reader_of(with_tiny_chunks(metadata_of(grid, 1, 4)), random_cells(random, grid.cells(), 4));
  for (int n = 0; n < 10; ++n) {
    const PlaneView view = random_view(random, grid, 0);
    const auto pixels = pixels_of(reader, view);
    CHECK(pixels_of(reader, view, 3) == pixels);
    CHECK(pixels_of(reader, view, 1, 50) == pixels);
    CHECK(pixels_of(reader, view, 2, 1, true) == pixels);
    PlaneView part = view;
    part.i0 = 5, part.i1 = 30, part.j0 = 7, part.j1 = 19;
    const auto of_part = pixels_of(reader, part);
    bool good = true;
    for (int64_t j = part.j0; j < part.j1; ++j)
      for (int64_t i = part.i0; i < part.i1; ++i)
        good &= of_part[static_cast<size_t>((j - part.j0) * 25 + i - part.i0)] == pixels[static_cast<size_t>(j * view.i1 + i)];
    CHECK(good);
  }
}

TEST_CASE("A plane across an axis, with a pixel for each cell, is the slice") {
  const Grid grid{{Axis::uniform(-1, 0.25, 0, 19, 0.5), Axis::uniform(0, 0.5, 0, 11, 0.5), Axis::uniform(10, 0.5, 0, 17, 0.5)}};
  std::mt19937_64 random(13);
  const GridReader reader = reader_of(with_tiny_chunks(metadata_of(grid, 0, 4)), random_cells(random, grid.cells(), 4));
  for (const int axis : {0, 1, 2}) {
    const RayFrame f = RayFrame::along(axis);
    PlaneView view{.i1 = grid.axis[f.u].cells(), .j1 = grid.axis[f.v].cells()};
    for (const int d : {0, 1, 2}) view.corner[d] = grid.axis[d].min();
    view.corner[axis] = grid.axis[axis].centre(6);
    view.right[f.u] = grid.axis[f.u].step(), view.up[f.v] = grid.axis[f.v].step();
    std::vector<uint16_t> slice;
    for_each_row(reader, whole_slice(reader.meta(), axis, 6, 0), strongest_material(reader.meta()), false, 1,
                 [&](int64_t, std::span<const uint16_t> row) { slice.insert(slice.end(), row.begin(), row.end()); });
    CHECK(pixels_of(reader, view) == slice);
  }
}

}  // namespace
}  // namespace teracell
