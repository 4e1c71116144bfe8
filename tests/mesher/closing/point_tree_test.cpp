// Points near a segment, against all distances.
#include "mesher/closing/point_tree.hpp"

#include "tests/support/test.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

double distance(const Vec3& p, const Vec3& a, const Vec3& b) {
  long double along = 0, length = 0, away = 0;
  for (int d = 0; d < 3; ++d) {
    along += (static_cast<long double>(p[d]) - a[d]) * (static_cast<long double>(b[d]) - a[d]);
    length += (static_cast<long double>(b[d]) - a[d]) * (static_cast<long double>(b[d]) - a[d]);
  }
  const long double t = length > 0 ? std::clamp<long double>(along / length, 0, 1) : 0;
  for (int d = 0; d < 3; ++d) {
    const long double x = p[d] - (a[d] + t * (static_cast<long double>(b[d]) - a[d]));
    away += x * x;
  }
  return static_cast<double>(std::sqrt(away));
}

// How often each point is given.
std::vector<int> visits(const PointTree& tree, size_t points, const Vec3& a, const Vec3& b, double reach) {
  std::vector<int> out(points);
  tree.near(a, b, reach, [&](uint32_t i) { ++out.at(i); });
  return out;
}

void expect_all_near(const PointTree& tree, const std::vector<Vec3>& points, const Vec3& a, const Vec3& b, double reach) {
  const std::vector<int> given = visits(tree, points.size(), a, b, reach);
  for (size_t i = 0; i < points.size(); ++i) {
    REQUIRE(given[i] <= 1);
    if (distance(points[i], a, b) <= reach) REQUIRE(given[i] == 1);
  }
}

Vec3 any_point(std::mt19937_64& random, double size) {
  return {random_in(random, -size, size), random_in(random, -size, size), random_in(random, -size, size)};
}

TEST_CASE("Every point within reach of a segment is given once, near and far from the origin, for points in a line or all equal too") {
  std::mt19937_64 random(1);
  for (const int kind : {0, 1, 2, 3}) {
    std::vector<Vec3> points;
    for (size_t i = 0; i < rounds(600); ++i) {
      Vec3 p = any_point(random, 1);
      if (kind == 1) p = {p[0], 0.5, 0.5};
      if (kind == 2) p = {0.5, 0.5, 0.5};
      if (kind == 3) p[0] += 1e6;
      points.push_back(p);
    }
    const PointTree tree(points);
    for (size_t round = 0; round < rounds(50); ++round) {
      const Vec3 a = points[round % points.size()], b = round % 3 == 0   ? a
                                                        : round % 3 == 1 ? points[(7 * round) % points.size()]
                                                                         : any_point(random, 3);
      // Up to exactly the distance of a point.
      const double reach = round % 2 == 0 ? random_in(random, 0, 0.2) : distance(points[(3 * round) % points.size()], a, b);
      expect_all_near(tree, points, a, b, reach);
    }
  }
}

TEST_CASE("Points on a segment a million times as long as the reach are found") {
  std::mt19937_64 random(2);
  std::vector<Vec3> points;
  const Vec3 a{-500, 20, 3}, b{700, -90, 44};
  for (int i = 0; i < 1000; ++i) {
    const double t = random_in(random, 0, 1);
    Vec3 p;
    for (int d = 0; d < 3; ++d) p[d] = a[d] + t * (b[d] - a[d]) + random_in(random, -0.001, 0.001);
    points.push_back(p);
  }
  expect_all_near(PointTree(points), points, a, b, 0.001);
  expect_all_near(PointTree(points), points, b, a, 0.001);
}

TEST_CASE("Few points that are out of reach are given") {
  std::mt19937_64 random(3);
  std::vector<Vec3> points;
  for (int i = 0; i < 8000; ++i) points.push_back(any_point(random, 1));
  const PointTree tree(points);
  const auto given = [&](const Vec3& a, const Vec3& b) {
    const std::vector<int> all = visits(tree, points.size(), a, b, 0.01);
    return std::count(all.begin(), all.end(), 1);
  };
  REQUIRE(given({0, 0, 0}, {0, 0, 0}) < 200);
  REQUIRE(given({-1, -1, -1}, {1, 1, 1}) < 1500);  // its box holds all points
  REQUIRE(given({3, 0, 0}, {3, 1, 0}) == 0);
}

TEST_CASE("A tree of no points gives none, one of few gives them by number") {
  REQUIRE(visits(PointTree({}), 0, {0, 0, 0}, {1, 1, 1}, 9).empty());
  const std::vector<Vec3> points = {{0, 0, 0}, {5, 0, 0}};
  for (size_t i = 0; i < points.size(); ++i) REQUIRE(visits(PointTree(points), 2, points[i], points[i], 0)[i] == 1);
}

}  // namespace
}  // namespace teracell::mesher
