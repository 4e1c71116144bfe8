// Duplicate and opposite facets, against maps of sorted vertices.
#include "mesher/closing/facet_set.hpp"

#include <utility>

#include "tests/support/counted.hpp"
#include "tests/support/shapes.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

using Facets = std::vector<Facet>;

enum class Sample { kAll, kFromTheStart, kFromTheMiddle, kAtTheEnd };

bool finds_opposites(const Facets& facets, Sample sample) {
  FacetSet set;
  for (size_t i = 0; i < facets.size(); ++i) {
    if ((sample == Sample::kFromTheStart && i == 0) || (sample == Sample::kFromTheMiddle && i == facets.size() / 2)) set.keep_sample();
    set.add(vertex_hashes(facets[i]));
  }
  if (sample == Sample::kAtTheEnd) set.keep_sample();
  return set.equal().opposite_in_sample;
}

// The same, however the sample is kept.
bool finds_opposites(const Facets& facets) {
  const bool found = finds_opposites(facets, Sample::kAll);
  for (const Sample sample : {Sample::kFromTheStart, Sample::kFromTheMiddle, Sample::kAtTheEnd}) CHECK(finds_opposites(facets, sample) == found);
  return found;
}

TEST_CASE("Opposite facets are two with the same three different vertices that run different ways round") {
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0}, d{0, 0, 1};
  REQUIRE_FALSE(finds_opposites({}));
  REQUIRE(finds_opposites({{{a, b, c}}, {{b, a, c}}}));
  REQUIRE(finds_opposites({{{a, b, c}}, {{a, b, d}}, {{c, b, a}}}));
  REQUIRE(finds_opposites({{{a, b, c}}, {{b, c, a}}, {{a, c, b}}}));  // one of three
  REQUIRE_FALSE(finds_opposites({{{a, b, c}}, {{b, c, a}}, {{c, a, b}}}));
  REQUIRE_FALSE(finds_opposites({{{a, b, c}}, {{b, a, d}}}));
  REQUIRE_FALSE(finds_opposites({{{a, a, b}}, {{a, b, a}}, {{b, a, a}}, {{b, b, a}}}));  // without area: no way round
}

TEST_CASE("Samples of the parts of a surface find what a sample of all of it finds") {
  std::mt19937_64 random(6);
  for (const auto& [count, opposites] : {std::pair(size_t{10}, true), {rounds(200'000), false}, {rounds(200'000), true}}) {
    Facets facets = tangle(random, count, 1000);
    if (opposites) {
      for (size_t i = 0; i < count / 2; ++i) facets[i + count / 2] = {{facets[i].vertex[1], facets[i].vertex[0], facets[i].vertex[2]}};
      std::ranges::shuffle(facets, random);
    }
    std::vector<FacetSet> parts(3);
    for (FacetSet& part : parts) part.keep_sample();
    for (const Facet& f : facets) parts[random() % parts.size()].add(vertex_hashes(f));
    parts[0].add(parts[1]);
    parts[0].add(parts[2]);
    CHECK(parts[0].equal().opposite_in_sample == finds_opposites(facets, Sample::kFromTheStart));
  }
}

TEST_CASE("A set of facets counts those that are equal to earlier ones, and can be used again") {
  std::mt19937_64 random(1);
  FacetSet set;
  for (const size_t count : {size_t{1}, size_t{20}, rounds(3000), size_t{5}}) {
    const Facets facets = tangle(random, count, count > 100 ? 5 : 2);
    std::vector<uint64_t> together;
    const auto add_together = [&] { set.add(std::exchange(together, {})); };
    for (const Facet& f : facets) {
      const std::array<VertexHash, 3> hashes = vertex_hashes(f);
      if (random() % 20 != 0) {
        together.push_back(FacetSet::key_of({hashes[0].low, hashes[1].low, hashes[2].low}));
      } else {
        add_together();
        set.add(hashes);
      }
    }
    add_together();
    const Counted expected = counted(facets);
    const EqualFacets found = set.equal();
    REQUIRE(found.duplicates == expected.duplicates);
    REQUIRE(found.opposite == expected.opposite);
    set.clear();
    REQUIRE(set.equal().duplicates == 0);
    REQUIRE_FALSE(set.equal().opposite_in_sample);
  }
  set.keep_sample();
  set.clear();
  REQUIRE(set.is_sample());
}

TEST_CASE("A sample of the facets tells whether opposite ones are among them, in any order and whether or not all are held") {
  std::mt19937_64 random(4);
  const Facets sphere = shapes::sphere({0, 0, 0}, 4, 7);  // 131,072: more than the sample holds
  for (const size_t doubled : {size_t{0}, size_t{1}, size_t{3}, size_t{2000}}) {
    Facets facets = sphere;
    for (size_t i = 0; i < doubled; ++i) facets.push_back(shapes::flip({sphere[i]})[0]);
    const bool found = finds_opposites(facets);
    if (doubled % 2000 == 0) CHECK(found == (doubled > 0));
    std::ranges::shuffle(facets, random);
    CHECK(finds_opposites(facets) == found);
  }
}

}  // namespace
}  // namespace teracell::mesher
