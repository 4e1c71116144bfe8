// Facets in memory, by number, in pieces that never move.
#include "mesher/tiles/facet_store.hpp"

#include "tests/support/test.hpp"

namespace teracell::mesher {
namespace {

Facet facet(uint64_t i) {
  const auto x = static_cast<double>(i);
  return {{Vec3{x, 0, 0}, {x, 1, 0}, {x, 0, 1}}};
}

std::vector<Facet> facets(uint64_t first, uint64_t last) {
  std::vector<Facet> out;
  for (uint64_t i = first; i < last; ++i) out.push_back(facet(i));
  return out;
}

TEST_CASE("Facets keep number, layer and place while others are appended, one by one or many at once") {
  FacetStore store;
  std::vector<const SceneFacet*> places;
  uint64_t next = 0;
  for (const uint64_t batch : {1u, 2u, 4092u, 1u, 4096u, 1u, 9000u, 1u, 7u}) {
    const std::vector<Facet> some = facets(next, next + batch);
    std::span<const Facet> left = some;
    while (!left.empty()) {
      const auto taken = store.append(left, static_cast<uint32_t>(batch));
      REQUIRE(taken.size() >= 1);
      REQUIRE(taken.size() <= left.size());
      for (const SceneFacet& f : taken) places.push_back(&f);
      left = left.subspan(taken.size());
    }
    next += batch;
    REQUIRE(store.size() == next);
    REQUIRE(places.size() == next);
  }
  for (uint64_t i = 0; i < next; ++i) {
    REQUIRE(&store[i] == places[i]);
    REQUIRE(store[i].facet.vertex == facet(i).vertex);
  }
  REQUIRE(store[0].layer == 1);
  REQUIRE(store[2].layer == 2);
  REQUIRE(store[4095].layer == 1);
  REQUIRE(store[4096].layer == 4096);
}

TEST_CASE("A stretch of facets is walked in order, from anywhere to anywhere, and may be changed on the way") {
  FacetStore store;
  store.append_all(facets(0, 10000), 5, 2);
  REQUIRE(store.size() == 10000);
  for (const auto& [first, last] :
       {std::pair<uint64_t, uint64_t>{0, 10000}, {0, 0}, {4095, 4097}, {4096, 8192}, {8191, 8192}, {9999, 10000}, {17, 9000}}) {
    uint64_t next = first;
    std::as_const(store).for_each(first, last, [&](const SceneFacet& f) { REQUIRE(f.facet.vertex == facet(next++).vertex); });
    REQUIRE(next == last);
  }
  store.for_each(4000, 4200, [](SceneFacet& f) { f.layer = 6; });
  for (uint64_t i = 3900; i < 4300; ++i) {
    REQUIRE(store[i].layer == (i >= 4000 && i < 4200 ? 6 : 5));
    REQUIRE(store[i].patch == 2);
  }
}

}  // namespace
}  // namespace teracell::mesher
