// How a grid is cut into parts.
#include "mesher/tiles/shards.hpp"
#include "tests/support/stored.hpp"
#include "tests/support/test.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

Metadata square(uint32_t rays) {
  const Axis axis = Axis::uniform(0, 1, 0, rays, 0.5);
  return metadata_of({{axis, axis, Axis::uniform(0, 1, 0, 10, 0.5)}}, 2, 2);
}

}  // namespace

TEST_CASE("Stretches follow each other and cover the tree, also where there are more than groups", "[parts]") {
  for (const uint32_t rays : {1u, 100u, 5000u, 200'000u})
    for (const uint32_t of : {1u, 2u, 7u, rays > 10'000 ? 50u : 1000u}) {
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

TEST_CASE("The order in which the facets of a body come does not matter", "[parts]") {
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

TEST_CASE("Pieces follow each other, cover the tree, and hold whole index pages of large grids", "[parts]") {
  for (const uint32_t rays : {1u, 100u, 5000u, 200'000u}) {
    Metadata meta = square(rays);
    meta.chunk_rays = 64;
    CostMap costs(meta, {});
    costs.add({{{{1, 1, 1}, {0.9 * rays, 1, 2}, {1, 0.8 * rays, 3}}}}, 0);
    const auto pieces = costs.pieces();
    const bool large = rays > 100'000;
    CHECK(pieces.size() >= (rays == 1 ? 1u : rays == 100 ? 1u : large ? 100u : 20u));
    uint64_t end = 0;
    for (const auto& [piece, cost] : pieces) {
      REQUIRE(piece.first == end);
      REQUIRE(piece.end > piece.first);
      if (large) REQUIRE(piece.first % kChildren == 0);
      end = piece.end;
    }
    CHECK(end == TreeRange().end);
  }
}

TEST_CASE("Part 0, which also counts the facets, has fewer groups, and the others have equally many but for the last", "[parts]") {
  const Metadata meta = square(4096);  // 16 x 16 groups
  CostMap costs(meta, {});
  for (int i = 0; i < 10000; ++i) costs.add({{{{-9, -9, 1}, {-8, -9, 2}, {-9, -8, 3}}}}, 0);  // beside the grid
  const auto groups = [&](uint32_t i) {
    const TreeRange part = costs.stretch({i, 4});
    return std::min<uint64_t>(part.end, 256) - part.first;
  };
  CHECK(groups(0) < groups(1));
  CHECK(groups(2) == groups(1));
  CHECK(groups(3) <= groups(1));  // it has what is left: one group less for each part before it, at most
  CHECK(groups(3) + 3 >= groups(1));
}

TEST_CASE("The costliest part costs as little as it can, whatever order cheap and dear groups have", "[parts]") {
  const Metadata meta = square(4096);  // 16 x 16 groups
  std::mt19937_64 random(3);
  for (int round = 0; round < 20; ++round) {
    CostMap costs(meta, {});
    std::vector<uint64_t> cost(256);  // in what a group without facets costs
    for (uint32_t v = 0; v < 16; ++v)
      for (uint32_t u = 0; u < 16; ++u) {
        const uint64_t nines = random() % 3 == 0 ? random() % 10 : 0;  // nine facets without crossings, in all 16 tiles, cost as much as four groups
        const Vec3 from{256.0 * u + 0.2, 256.0 * v + 0.2, 1}, to{256.0 * u + 255.8, 256.0 * v + 255.8, 2};
        for (uint64_t i = 0; i < 9 * nines; ++i) costs.add({{from, to, to}}, 0);
        cost[tree_key(u, v)] = 1 + 4 * nines;
      }
    const uint32_t of = 2 + static_cast<uint32_t>(random() % 20);
    uint64_t longest = 0;
    for (uint32_t i = 0; i < of; ++i) {
      const TreeRange part = costs.stretch({i, of});
      longest = std::max(longest,
                         std::accumulate(&cost[std::min<uint64_t>(part.first, 256)], cost.data() + std::min<uint64_t>(part.end, 256), uint64_t{0}));
    }
    const auto parts_of = [&](uint64_t bound) {
      uint64_t parts = 1, sum = 0;
      for (const uint64_t c : cost) parts += sum + c > bound, sum = sum + c > bound ? c : sum + c;
      return parts;
    };
    CHECK(parts_of(longest * 98 / 100 - 1) > of);
  }
}

TEST_CASE("A key has a digit for each level, the highest first", "[parts]") {
  std::mt19937_64 random(7);
  for (int i = 0; i < 1000; ++i) {
    const auto u = static_cast<uint32_t>(random()), v = static_cast<uint32_t>(random());
    uint64_t expected = 0;
    for (int level = 15; level >= 0; --level) expected = 16 * expected + (v >> (2 * level)) % 4 * 4 + (u >> (2 * level)) % 4;
    REQUIRE(tree_key(u, v) == expected);
  }
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

}  // namespace teracell::mesher
