// How a grid is cut into parts.
#include <catch2/catch.hpp>

#include <algorithm>

#include "mesher/shards.hpp"
#include "tests/support/random.hpp"
#include "tests/support/stored.hpp"

namespace teracell {
namespace {

using namespace testing;

Metadata square(uint32_t rays) {
  const Axis axis = Axis::uniform(0, 1, 0, rays, 0.5);
  return metadata_of({{axis, axis, Axis::uniform(0, 1, 0, 10, 0.5)}}, 2, 2);
}

}  // namespace

TEST_CASE("Stretches follow each other and cover the tree, also where there are more than groups", "[parts]") {
  for (const uint32_t rays : {1u, 100u, 5000u, 200'000u})
    for (const uint32_t of : {1u, 2u, 7u, 1000u}) {
      const Metadata meta = square(rays);
      CostMap costs(meta, {});
      costs.add({{{{1, 1, 1}, {0.9 * rays, 1, 2}, {1, 0.8 * rays, 3}}}}, 0);
      uint64_t end = 0;
      for (uint32_t i = 0; i < of; ++i) {
        const TreeRange part = costs.stretch({i, of});
        REQUIRE(part.first == end);
        REQUIRE(part.end >= part.first);
        end = part.end;
      }
      CHECK(end == TreeRange().end);
    }
}

TEST_CASE("The order in which facets come does not matter", "[parts]") {
  std::mt19937_64 random(5);
  std::vector<Facet> facets(200);
  for (Facet& f : facets)
    for (Vec3& p : f.vertex) p = {random_in(random, 0, 3000), random_in(random, 0, 3000), random_in(random, 0, 10)};
  const Metadata meta = square(3000);
  CostMap a(meta, {}), b(meta, {});
  for (const Facet& f : facets) a.add(f, 0);
  std::ranges::reverse(facets);
  for (const Facet& f : facets) b.add(f, 0);
  for (uint32_t i = 0; i < 9; ++i) CHECK(a.stretch({i, 9}).end == b.stretch({i, 9}).end);
}

TEST_CASE("A stretch has what lies between its keys, at any height", "[parts]") {
  const TreeRange range{5, 300};
  for (int height = 0; height < 3; ++height)
    for (uint32_t v = 0; v < 64u >> (2 * height); ++v)
      for (uint32_t u = 0; u < 64u >> (2 * height); ++u) {
        bool all = true, any = false;
        const uint32_t side = 1u << (2 * height);
        for (uint32_t j = v * side; j < (v + 1) * side; ++j)
          for (uint32_t i = u * side; i < (u + 1) * side; ++i) {
            const uint64_t key = tree_key(i, j);
            const bool in = range.first <= key && key < range.end;
            all &= in, any |= in;
          }
        REQUIRE(range.has_all(height, u, v) == all);
        REQUIRE(range.has_any(height, u, v) == any);
      }
}

}  // namespace teracell
