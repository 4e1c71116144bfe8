// Shells, degenerate and duplicate facets, against maps and union-find over facets.
#include "mesher/closing/surface_counts.hpp"

#include "tests/support/counted.hpp"
#include "tests/support/shapes.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

using Facets = std::vector<Facet>;

Facet facet(const Vec3& a, const Vec3& b, const Vec3& c) { return {{a, b, c}}; }

Counted survey(const Facets& facets, uint64_t expect = 0) {
  SurfaceCounter out;
  if (expect > 0) out.expect(expect);
  for (const Facet& f : facets) out.add(f);
  const SurfaceCounts found = out.totals();
  return {found.degenerate, found.duplicates, found.opposite, found.shells};
}

TEST_CASE("A surface's counts are those of maps and union-find, however much room was made for it") {
  std::mt19937_64 random(1);
  Counted all;
  for (const int size : {2, 20, 400})
    for (const size_t facets : {size_t{1}, size_t{30}, rounds(2000)}) {
      const Facets some = tangle(random, facets, size);
      const Counted expected = counted(some);
      CAPTURE(size, facets, expected.shells);
      REQUIRE(survey(some) == expected);
      REQUIRE(survey(some, 1) == expected);
      REQUIRE(survey(some, 100000) == expected);
      all.degenerate += expected.degenerate, all.opposite += expected.opposite, all.shells += expected.shells;
    }
  REQUIRE(all.degenerate > 100);
  REQUIRE(all.opposite > 20);
  REQUIRE(all.shells > 100);
}

TEST_CASE("A facet whose corners are on a line but for a rounding has an area") {
  REQUIRE(survey({facet({0, 0, 0}, {1, 1, 1}, {3, 3, 3})}).degenerate == 1);
  REQUIRE(survey({facet({0, 0, 0}, {0.1, 0.1, 0}, {0.3, std::nextafter(0.3, 1), 0})}).degenerate == 0);
  REQUIRE(survey({facet({1e75, 0, 0}, {-1e75, 0, 0}, {0, 1e-75, 0})}).degenerate == 0);
  REQUIRE(survey({facet({1e75, 0, 0}, {-1e75, 0, 0}, {1e-75, 0, 0})}).degenerate == 1);
}

TEST_CASE("The first of several facets with the same vertices says which ones are opposite") {
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0};
  const Facet up{{a, b, c}}, up_again{{c, a, b}}, down{{b, a, c}};
  REQUIRE(survey({up, up_again, down}) == Counted{0, 2, 1, 1});
  REQUIRE(survey({down, up, up_again}) == Counted{0, 2, 2, 1});
  // Of a thousand facets later too.
  Facets many(1000, up);
  many.front() = down;
  REQUIRE(survey(many) == Counted{0, 999, 999, 1});
}

TEST_CASE("Shells are connected by vertices, not by edges, whatever the order in which they meet") {
  std::mt19937_64 random(2);
  Facets chain;  // of facets that share a vertex each with the next, in two halves
  for (int i = 0; i < 500; ++i)
    if (i != 250) chain.push_back(facet({double(i), 0, 0}, {double(i + 1), 0, 0}, {i + 0.5, 1, 0}));
  for (int order = 0; order < 3; ++order) {
    REQUIRE(survey(chain).shells == 2);
    std::ranges::shuffle(chain, random);
  }
  chain.push_back(facet({250, 0, 0}, {251, 0, 0}, {250, 0, 7}));
  REQUIRE(survey(chain).shells == 1);
}

TEST_CASE("A facet that is only joined is not counted, and equal vertices have equal numbers") {
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0}, d{5, 5, 5};
  SurfaceCounter out;
  out.add({{a, a, b}});
  out.add({{c, c, d}});
  const std::array hashes = {vertex_hash(a), vertex_hash(b), vertex_hash(c), vertex_hash(d), vertex_hash(b)};
  std::array<uint32_t, 5> numbers;
  out.number(hashes, numbers.data());
  REQUIRE(numbers == std::array<uint32_t, 5>{0, 1, 2, 3, 1});
  REQUIRE(out.totals().shells == 2);
  REQUIRE(out.shell_of(numbers[0]) != out.shell_of(numbers[2]));
  for (int i = 0; i < 2; ++i) out.join({numbers[1], numbers[1], numbers[2]});
  REQUIRE(out.totals().shells == 1);
  REQUIRE(out.shell_of(numbers[0]) == out.shell_of(numbers[3]));
  REQUIRE(out.totals().degenerate == 2);
  REQUIRE(out.totals().duplicates == 0);
}

TEST_CASE("Counts may be asked for between facets") {
  std::mt19937_64 random(3);
  const Facets facets = tangle(random, rounds(300), 5);
  SurfaceCounter out;
  for (size_t i = 0; i < facets.size(); ++i) {
    out.add(facets[i]);
    if (i % 37 != 0 && i + 1 != facets.size()) continue;
    const Counted expected = counted({facets.begin(), facets.begin() + static_cast<ptrdiff_t>(i) + 1});
    REQUIRE(out.totals().duplicates == expected.duplicates);
    REQUIRE(out.totals().opposite == expected.opposite);
    REQUIRE(out.totals().shells == expected.shells);
    REQUIRE(out.totals().degenerate == expected.degenerate);
  }
}

TEST_CASE("Shells are the same when the file numbers the vertices, whatever numbers it gives them") {
  std::mt19937_64 random(5);
  for (const int size : {3, 30, 100})
    for (const size_t count : {size_t{3}, rounds(3000)}) {
      const Facets facets = tangle(random, count, size);
      const uint64_t expected = counted(facets).shells;
      for (const uint32_t first : {0u, 60'000u, 4'000'000'000u}) {  // large numbers are not worth a table
        // Some vertices have two numbers, and some facets have none.
        std::map<std::pair<Vec3, bool>, uint32_t> numbers;
        ShellCounter counter;
        for (const Facet& f : facets) {
          std::array<uint32_t, 3> of_facet;
          for (int i = 0; i < 3; ++i)
            of_facet[i] =
                numbers.try_emplace({f.vertex[i], random_int(random, 0, 4) == 0}, first + static_cast<uint32_t>(numbers.size())).first->second;
          if (random_int(random, 0, 5) == 0) counter.add(vertex_hashes(f));
          else counter.add(f, of_facet);
        }
        CAPTURE(size, count, first);
        REQUIRE(counter.shells() == expected);
        const Vec3 &a = facets.front().vertex[0], &b = facets.front().vertex[1];
        REQUIRE(counter.shell_of(vertex_hash(a)) == counter.shell_of(vertex_hash(b)));
      }
    }
}

TEST_CASE("Vertices are numbered in the order of first appearance, and keep their numbers") {
  std::mt19937_64 random(4);
  VertexNumbers numbers;
  std::map<Vec3, uint32_t> expected;
  for (size_t i = 0; i < rounds(20000); ++i) {
    const Vec3 v{double(random_int(random, 0, 99)), double(random_int(random, 0, 99)), 0.1};
    const auto number = static_cast<uint32_t>(expected.size());
    REQUIRE(numbers.find_or_add(vertex_hash(v)) == expected.try_emplace(v, number).first->second);
  }
  REQUIRE(numbers.count() == expected.size());
  for (const auto& [v, number] : expected) {
    REQUIRE(numbers.find(vertex_hash(v)) == number);
    REQUIRE(numbers.hash(number) == vertex_hash(v));
  }
}

}  // namespace
}  // namespace teracell::mesher
