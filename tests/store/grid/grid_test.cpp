// Axes and grids: the last bit of every coordinate, and which cell or centre a coordinate meets.
#include "store/grid/grid.hpp"

#include "store/base/error.hpp"
#include "tests/support/test.hpp"

namespace teracell {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Axis random_graded(std::mt19937_64& random, int cells) {
  std::uniform_real_distribution<double> exponent(-12, 3);
  std::vector<double> planes = {-5};
  for (int i = 0; i < cells; ++i) planes.push_back(planes.back() + std::exp2(exponent(random)));
  return Axis::graded(planes, 0.25);
}

// Ordinary ones, and those where a guess by division is off by cells.
std::vector<Axis> axes() {
  std::mt19937_64 random(1);
  return {Axis::uniform(0, 1, 0, 100, 0.5),
          Axis::uniform(-3.7, 0.1, 0, 200, 0),
          Axis::uniform(-3.7, 0.1, 1000, 200, 0.25),
          Axis::uniform(0, 0.1, int64_t{1} << 40, 300, 0.75),
          Axis::uniform(1e15, 2, 0, 100, 0),                     // the step is 16 ulps
          Axis::uniform(1e6, 0x1p-32, 0, 100, 0),                // 2 ulps
          Axis::uniform(-1e6, 0x1p-31, 7, 100, 0.5),
          Axis::uniform(0, 1, (int64_t{1} << 52) - 50, 50, 0),   // at the limit of `first`
          Axis::uniform(0, 0x1.812641b328b6ep-2, 3289424847640678, 16, 0.75),  // the guess lands beyond the answer
          Axis::uniform(0x1.2147ae147ae14p+54, 0x1.635147f130596p+3, 3627751061612384, 16, 0.75),
          Axis::uniform(-1e75, 1e74, 0, 15, 0.5),
          Axis::uniform(0, 1e-74, 0, 50, 0.5),
          Axis::uniform(1e-60, 1e-70, 0, 50, 0.999),
          Axis::uniform(-0.3, 0.3, 0, 3, 0),
          Axis::uniform(5, 0.125, 0, 1, 0.5),
          Axis::graded({0, 1, 3, 3.5, 100, 101}, 0.5),
          Axis::graded({-1e74, -1, 0, 1e-70, 1, 1e75}, 0.5),
          Axis::graded({1, std::nextafter(1, 2), 2}, 0),
          random_graded(random, 200)};
}

// Coordinates where answers change: at centres and planes, a bit beside them, and far away.
std::vector<double> interesting_coordinates(const Axis& axis) {
  std::vector<double> all = {0, -kInfinity, kInfinity, 1e300, -1e300, std::numeric_limits<double>::denorm_min()};
  for (int64_t i = 0; i < axis.cells(); ++i)
    for (const double x : {axis.plane(i), axis.centre(i), axis.plane(i + 1)})
      for (const double y : {std::nextafter(x, -kInfinity), x, std::nextafter(x, kInfinity)}) all.push_back(y);
  return all;
}

TEST_CASE("A uniform axis computes centres and planes in the order of the rule, one rounding an operation") {
  int fused_would_differ = 0;
  for (const Axis& a : {Axis::uniform(0.1, 0.1, 0, 1000, 0.5), Axis::uniform(-7.3, 0.3, 12345678901, 1000, 0.25)}) {
    for (int64_t i = 0; i < a.cells(); ++i) {
      const double index = static_cast<double>(a.first() + i);
      const double place = index + a.sample(), scaled = place * a.step(), centre = a.origin() + scaled;
      REQUIRE(a.centre(i) == centre);
      const double plane = index * a.step();
      REQUIRE(a.plane(i) == a.origin() + plane);
      fused_would_differ += std::fma(place, a.step(), a.origin()) != centre;
    }
  }
  REQUIRE(fused_would_differ > 0);  // so the comparison above means something
}

TEST_CASE("A graded axis computes a centre from the two planes of its cell") {
  const std::vector<double> planes = {-1, 0.1, 0.3, 7};
  const Axis a = Axis::graded(planes, 0.3);
  REQUIRE(a.cells() == 3);
  for (size_t i = 0; i < 3; ++i) {
    const double width = planes[i + 1] - planes[i], part = 0.3 * width;
    REQUIRE(a.centre(static_cast<int64_t>(i)) == planes[i] + part);
    REQUIRE(a.plane(static_cast<int64_t>(i)) == planes[i]);
  }
  REQUIRE(a.max() == 7);
}

TEST_CASE("A crop that begins at a later cell has the very centres of the whole axis") {
  const Axis whole = Axis::uniform(0.1, 0.7, 0, 1000, 0.5), crop = Axis::uniform(0.1, 0.7, 600, 50, 0.5);
  for (int64_t i = 0; i < 50; ++i) {
    REQUIRE(crop.centre(i) == whole.centre(600 + i));
    REQUIRE(crop.plane(i) == whole.plane(600 + i));
  }
}

TEST_CASE("Minus zero is plus zero in an axis") {
  REQUIRE_FALSE(std::signbit(Axis::uniform(-0.0, 1, 0, 1, 0).origin()));
  REQUIRE_FALSE(std::signbit(Axis::graded({-0.0, 1}, 0).plane(0)));
}

TEST_CASE("The first centre from a coordinate on is what counting the centres below it gives") {
  for (const Axis& axis : axes()) {
    INFO("min " << axis.min() << ", " << axis.cells() << " cells, graded " << axis.is_graded());
    int64_t wrong = 0;
    for (const double x : interesting_coordinates(axis)) {
      int64_t below = 0;
      while (below < axis.cells() && axis.centre(below) < x) ++below;
      wrong += axis.first_centre_from(x) != below;
    }
    REQUIRE(wrong == 0);
  }
}

TEST_CASE("On an axis of two billion cells the first centre from a coordinate on is its neighbours' next") {
  std::mt19937_64 random(2);
  const Axis axis = Axis::uniform(-123.456, 1e-7, 99, Axis::kMaxCells, 0.5);
  std::uniform_real_distribution<double> anywhere(axis.min(), axis.max());
  for (int i = 0; i < 1000; ++i) {
    const double x = anywhere(random);
    const int64_t cell = axis.first_centre_from(x);
    REQUIRE((cell == axis.cells() || axis.centre(cell) >= x));
    REQUIRE((cell == 0 || axis.centre(cell - 1) < x));
  }
}

TEST_CASE("A coordinate belongs to the cell whose planes hold it, lower plane included, and max to the last cell") {
  for (const Axis& axis : axes()) {
    INFO("min " << axis.min() << ", " << axis.cells() << " cells, graded " << axis.is_graded());
    int64_t wrong = 0;
    for (const double x : interesting_coordinates(axis)) {
      if (!(x >= axis.min() && x <= axis.max())) continue;
      int64_t cell = axis.cells() - 1;
      while (axis.plane(cell) > x) --cell;
      wrong += axis.cell_at(x) != cell;
    }
    REQUIRE(wrong == 0);
    REQUIRE(axis.cell_at(axis.min()) == 0);
    REQUIRE(axis.cell_at(axis.max()) == axis.cells() - 1);
  }
}

TEST_CASE("An axis whose centres do not ascend strictly is refused") {
  REQUIRE_THROWS_AS(Axis::uniform(1e17, 1, 0, 100, 0.5), UsageError);               // cells smaller than an ulp
  REQUIRE_THROWS_AS(Axis::uniform(0, 1, int64_t{1} << 52, 100, 0.5), UsageError);   // i + 0.5 is rounded
  REQUIRE_THROWS_AS(Axis::graded({0, 1, 1, 2}, 0.5), UsageError);
  REQUIRE_THROWS_AS(Axis::graded({0, 2, 1}, 0.5), UsageError);
  REQUIRE_THROWS_AS(Axis::graded({2, 1}, 0.5), UsageError);
  REQUIRE_THROWS_AS(Axis::graded({1 + 0x1p-52, 1 + 0x2p-52, 1 + 0x3p-52}, 0.5), UsageError);  // planes ascend, centres meet
}

TEST_CASE("An axis refuses what is not a number, a width or a count") {
  for (const double bad : {kNaN, kInfinity, -kInfinity, 1e76, 1e-76, -1e-76}) {
    INFO(bad);
    REQUIRE_THROWS_AS(Axis::uniform(bad, 1, 0, 10, 0.5), UsageError);
    REQUIRE_THROWS_AS(Axis::uniform(0, bad, 0, 10, 0.5), UsageError);
  }
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    REQUIRE_THROWS_AS(Axis::graded({0, bad, 1}, 0.5), UsageError);
    REQUIRE_THROWS_AS(Axis::graded({bad, 1}, 0.5), UsageError);
    REQUIRE_THROWS_AS(Axis::graded({0, bad}, 0), UsageError);
  }
  REQUIRE_THROWS_AS(Axis::uniform(0, 0, 0, 10, 0.5), UsageError);
  REQUIRE_THROWS_AS(Axis::uniform(0, -1, 0, 10, 0.5), UsageError);
  REQUIRE_THROWS_AS(Axis::uniform(9e74, 1e74, 0, 100, 0.5), UsageError);  // leaves the range on the way
  for (const double bad : {-0.1, 1.0, kNaN, kInfinity}) {
    REQUIRE_THROWS_AS(Axis::uniform(0, 1, 0, 10, bad), UsageError);
    REQUIRE_THROWS_AS(Axis::graded({0, 1}, bad), UsageError);
  }
  for (const int64_t bad : {int64_t{0}, int64_t{-1}, Axis::kMaxCells + 1, std::numeric_limits<int64_t>::max(), std::numeric_limits<int64_t>::min()})
    REQUIRE_THROWS_AS(Axis::uniform(0, 1, 0, bad, 0.5), UsageError);
  for (const int64_t bad : {int64_t{-1}, (int64_t{1} << 52) + 1, std::numeric_limits<int64_t>::max()})
    REQUIRE_THROWS_AS(Axis::uniform(0, 1, bad, 10, 0), UsageError);
  REQUIRE_THROWS_AS(Axis::graded({}, 0.5), UsageError);
  REQUIRE_THROWS_AS(Axis::graded({1}, 0.5), UsageError);
}

TEST_CASE("Each level halves the axes, rounding up, until one cell is left") {
  const Grid grid{{Axis::uniform(0, 1, 0, 13, 0.5), Axis::graded({0, 1, 4}, 0.5), Axis::uniform(0, 1, 0, 1, 0.5)}};
  REQUIRE(grid.levels() == 5);
  REQUIRE(grid.cells(0) == Index3{13, 2, 1});
  REQUIRE(grid.cells(1) == Index3{7, 1, 1});
  REQUIRE(grid.cells(2) == Index3{4, 1, 1});
  REQUIRE(grid.cells(4) == Index3{1, 1, 1});
  REQUIRE(grid.box(1) == Box{{0, 0, 0}, {7, 1, 1}});
  const Axis one = Axis::uniform(0, 1, 0, 1, 0.5), largest = Axis::uniform(0, 1, 0, Axis::kMaxCells, 0.5);
  REQUIRE(Grid{{one, one, one}}.levels() == 1);
  REQUIRE(Grid{{largest, one, largest}}.levels() == 32);
  REQUIRE(Grid{{largest, one, largest}}.cells(31) == Index3{1, 1, 1});
}

TEST_CASE("The frame of an axis has the other two in the order x, y, z") {
  REQUIRE((RayFrame::along(0).u == 1 && RayFrame::along(0).v == 2 && RayFrame::along(0).w == 0));
  REQUIRE((RayFrame::along(1).u == 0 && RayFrame::along(1).v == 2 && RayFrame::along(1).w == 1));
  REQUIRE((RayFrame::along(2).u == 0 && RayFrame::along(2).v == 1 && RayFrame::along(2).w == 2));
}

TEST_CASE("Counts of cells beyond 64 bits are spelled out in full") {
  const int64_t n = Axis::kMaxCells;
  REQUIRE(cell_count_text({100'000, 100'000, 100'000}) == "1000000000000000");
  REQUIRE(cell_count_text({n, n, n}) == "9903520286612926114398470136");
}

}  // namespace
}  // namespace teracell
