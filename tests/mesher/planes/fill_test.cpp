// Planes between candidates, and the rows of cells that they are made of.
#include "mesher/planes/fill.hpp"

#include "mesher/planes/candidates.hpp"
#include "mesher/planes/flat_faces.hpp"
#include "mesher/planes/geometric.hpp"
#include "store/base/error.hpp"
#include "tests/support/test.hpp"

namespace teracell::mesher {
namespace {

using Planes = std::vector<double>;

Planes filled(const Planes& kept, double finest, double coarsest, double growth, const std::vector<Resolution>& resolutions = {}) {
  return fill_between(kept, Widths(kept.front(), kept.back(), coarsest, resolutions), finest, growth, 1 << 20);
}

double largest_ratio(const Planes& planes) {
  double out = 1;
  for (size_t i = 1; i + 1 < planes.size(); ++i) {
    const double a = planes[i] - planes[i - 1], b = planes[i + 1] - planes[i];
    out = std::max({out, a / b, b / a});
  }
  return out;
}

TEST_CASE("Lines for which a program of others never ends", "[planes]") {
  const Planes kept = {-22, -1.414, -0.25, 0.25, 1.414, 2, 22};
  for (const double finest : {0.5, 0.25, 0.1}) {
    const Planes planes = filled(kept, finest, 14.99, 1.5);
    for (const double k : kept) CHECK(std::ranges::binary_search(planes, k));
    if (finest < 0.5) CHECK(largest_ratio(planes) < 1.5 + 1e-9);
  }
}

TEST_CASE("Gaps that hold whole cells of the widest kind have these, in round numbers", "[planes]") {
  CHECK(filled({0, 10}, 0.1, 2, 1.3) == Planes{0, 2, 4, 6, 8, 10});
  CHECK(filled({-1, 0, 3}, 0.5, 1, 1.3) == Planes{-1, 0, 1, 2, 3});
}

TEST_CASE("Cells as wide as can be have round planes, and rounding makes none wider", "[planes]") {
  const Planes planes = filled({-36, 0, 1.6, 37.635}, 0.3, 6, 1.4, {{0, 1.6, 0.4}});
  CHECK(Planes(planes.begin(), planes.begin() + 4) == Planes{-36, -30, -24, -18});
  for (size_t i = 0; i + 1 < planes.size(); ++i) CHECK(planes[i + 1] - planes[i] <= 6 + 1e-14 * 36);
  CHECK(filled({0, 3 * (1 + 1e-11), 4}, 0.5, 1, 1.3).size() == 5);
}

TEST_CASE("A gap is one cell where no more fit, or none is wanted", "[planes]") {
  CHECK(filled({0, 1.9}, 1, 5, 1.3) == Planes{0, 1.9});
  CHECK(filled({0, 0.5}, 1, 5, 1.3) == Planes{0, 0.5});
  CHECK(filled({0, 5}, 1, 5, 1.3) == Planes{0, 5});
}

TEST_CASE("A resolution within a gap has whole cells, and those beside it grow from there", "[planes]") {
  const Planes planes = filled({0, 100}, 0.1, 8, 1.25, {{40, 43, 0.5}});
  for (size_t i = 0; i + 1 < planes.size(); ++i)
    if (planes[i + 1] > 40 && planes[i] < 43) CHECK(planes[i + 1] - planes[i] < 0.5 + 1e-9);
  CHECK(largest_ratio(planes) < 1.25 + 1e-9);
  CHECK(planes.size() < 50);
}

TEST_CASE("More cells than are allowed are a usage error before there is memory for them", "[planes]") {
  for (const double finest : {1e-2, 1e-20, 1e-30, 1e-300}) CHECK_THROWS_AS(filled({0, 1e12}, finest, 2 * finest, 1.3), UsageError);
}

TEST_CASE("The lengths of rows are the sums of their cells, and logarithms are those of the library", "[planes]") {
  std::mt19937_64 random(3);
  const auto real = [&](double lo, double hi) { return std::uniform_real_distribution<>(lo, hi)(random); };
  for (int round = 0; round < 3000; ++round) {
    const Growth g{real(1.02, 3)};
    const int64_t n = 2 + static_cast<int64_t>(random() % 60);
    const double least = 1, most = real(1, 50), first = real(least, most);
    const double last = std::clamp(real(least, most), first / g.power(n - 1), first * g.power(n - 1));
    double wide = 0, narrow = 0;
    for (int64_t i = 0; i < n; ++i) wide += widest(g, first, last, most, n, i), narrow += narrowest(g, first, last, least, n, i);
    CHECK(widest_length(g, first, last, most, n) == Approx(wide).epsilon(1e-11));
    CHECK(narrowest_length(g, first, last, least, n) == Approx(narrow).epsilon(1e-11));
    const double x = std::exp(real(-300, 300));
    CHECK(portable_log(x) == Approx(std::log(x)).epsilon(1e-14).margin(1e-15));
  }
}

TEST_CASE("Of candidates that are too near the one of higher rank stays: sides, fixed planes, larger faces, lesser coordinates", "[planes]") {
  using enum Candidate::Rank;
  const Kept kept =
      merged({{5, kFace, 9}, {5.5, kFixed}, {0, kSide}, {10, kSide}, {9.5, kFixed}, {2, kFace, 1}, {2.9, kFace, 2}, {7, kFace, 1}, {7.9, kFace, 1}},
             1, 1e-9);
  CHECK(kept.at == Planes{0, 2.9, 5.5, 7, 10});
  REQUIRE(kept.losses.size() == 4);
  CHECK((kept.losses[0].lost.at == 9.5 && kept.losses[0].kept.at == 10));
  CHECK((kept.losses[1].lost.at == 5 && kept.losses[1].kept.at == 5.5));
}

TEST_CASE("Areas that differ by rounding are equal, and of what is equal in all the first goes first", "[planes]") {
  using enum Candidate::Rank;
  const Kept kept = merged(
      {{0, kSide}, {9, kSide}, {8.8005, kFace, 3 * (1 + 1e-15)}, {8.7995, kFace, 3}, {5, kFace, 1, 7}, {5, kFace, 1, 2}, {5.01, kFace, 0.5, 1}}, 0.05,
      1e-9);
  CHECK(kept.at == Planes{0, 5, 8.7995, 9});
  REQUIRE(kept.losses.size() == 2);
  CHECK(kept.losses[0].lost.at == 8.8005);
  CHECK(kept.losses[1].kept.body == 7);
}

TEST_CASE("Planes a whole finest cell apart are both kept, whatever rounding says; those at one place are no loss", "[planes]") {
  using enum Candidate::Rank;
  const Kept kept = merged({{-30, kSide}, {30, kSide}, {-29.8, kFace, 1}, {-29.8 + 1e-12, kFace, 1}}, 0.2, 1e-8);
  CHECK(kept.at == Planes{-30, -29.8, 30});
  CHECK(kept.losses.empty());
}

TEST_CASE("Facets are flat across an axis where their corners agree to within the slack, and stand at the median of their area", "[planes]") {
  FlatFaceSearch search({0.01, -1, 0.01});
  search.take({Vec3{1, 0, 0}, Vec3{1, 2, 0}, Vec3{1, 0, 2}}, 2);
  search.take({Vec3{1.004, 0, 0}, Vec3{1.005, 1, 0}, Vec3{1.005, 0, 1}}, 0.5);
  search.take({Vec3{5, 0, 0}, Vec3{5.1, 1, 0}, Vec3{5, 0, 1}}, 0.5);
  const FlatFaces found = std::move(search).found();
  CHECK(found.axis[1].empty());
  CHECK(found.least_missed[0] == Approx(0.1));
  const std::vector<FlatArea> faces = grouped(found.axis[0], 0.01, 1);
  REQUIRE(faces.size() == 1);
  CHECK((faces[0].at == 1 && faces[0].area == Approx(2.5) && faces[0].facing == Approx(2.5).epsilon(0.01)));
  CHECK(grouped(found.axis[0], 0.001, 2.2).empty());
}

}  // namespace
}  // namespace teracell::mesher
