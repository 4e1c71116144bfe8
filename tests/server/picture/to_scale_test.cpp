// Which cells the pixels of a picture to scale show, by looking at all planes.
#include "server/picture/to_scale.hpp"

#include "tests/support/test.hpp"

namespace teracell::server {
namespace {

Axis random_axis(std::mt19937_64& random) {
  const auto cells = static_cast<int64_t>(1 + random() % 70);
  std::uniform_real_distribution<double> width(0.01, 1);
  if (random() % 4 == 0) return Axis::uniform(-3, width(random), static_cast<int64_t>(random() % 5), cells, 0.5);
  std::vector<double> planes = {-width(random)};
  while (std::ssize(planes) <= cells) planes.push_back(planes.back() + (random() % 5 == 0 ? 20 : 1) * width(random));
  return Axis::graded(planes, 0.25);
}

TEST_CASE("A pixel of a picture to scale shows the cell that its middle lies in", "[server]") {
  std::mt19937_64 random(5);
  for (int round = 0; round < 500; ++round) {
    const Axis axis = random_axis(random);
    const auto level = static_cast<int>(random() % 4);
    const int64_t cells = ceil_shift(axis.cells(), level);
    const auto from = static_cast<int64_t>(random() % static_cast<uint64_t>(cells));
    const int64_t to = from + 1 + static_cast<int64_t>(random() % static_cast<uint64_t>(cells - from));
    const auto pixels = static_cast<int64_t>(1 + random() % 200);
    const auto plane = [&](int64_t i) { return axis.plane(std::min(i << level, axis.cells())); };
    REQUIRE(length_of(axis, level, from, to) == plane(to) - plane(from));
    const std::vector<int64_t> shown = cells_to_scale(axis, level, from, to, pixels);
    REQUIRE(std::ssize(shown) == pixels);
    const double length = plane(to) - plane(from), slack = 1e-12 * (std::abs(plane(from)) + length);  // of rounding, for a middle on a plane
    for (int64_t i = 0; i < pixels; ++i) {
      const double middle = plane(from) + length * (2 * static_cast<double>(i) + 1) / (2 * static_cast<double>(pixels));
      const int64_t cell = shown[static_cast<size_t>(i)];
      INFO("round " << round << ", pixel " << i << " shows " << cell);
      REQUIRE((cell >= from && cell < to));
      REQUIRE((plane(cell) <= middle + slack && middle - slack <= plane(cell + 1)));
    }
  }
}

TEST_CASE("A picture to scale of equal cells with a pixel for each shows them one by one", "[server]") {
  const std::vector<int64_t> shown = cells_to_scale(Axis::uniform(0, 0.1, 0, 1000, 0.5), 0, 100, 900, 800);
  for (int64_t i = 0; i < 800; ++i) REQUIRE(shown[static_cast<size_t>(i)] == 100 + i);
}

}  // namespace
}  // namespace teracell::server
