// Stretches that join a tile's crossings.
#include "mesher/thin/marks.hpp"

#include "tests/support/test.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

Tile tile_of(uint32_t rays) { return {RayFrame::along(2), std::vector<double>(rays), {0}, nullptr}; }

std::vector<std::vector<uint64_t>> by_ray(const Crossings& crossings) {
  std::vector<std::vector<uint64_t>> out;
  for (size_t ray = 0; ray + 1 < crossings.begin.size(); ++ray)
    out.emplace_back(crossings.all.begin() + crossings.begin[ray], crossings.all.begin() + crossings.begin[ray + 1]);
  return out;
}

struct Stretch {
  uint32_t layer, from, to;
  friend bool operator==(const Stretch&, const Stretch&) = default;
};

// A ray's stretches: each is a step up and a step down, one after the other. What comes before them are crossings.
std::vector<Stretch> marks_in(const std::vector<uint64_t>& ray, size_t crossings) {
  std::vector<Stretch> out;
  REQUIRE((ray.size() - crossings) % 2 == 0);
  for (size_t i = crossings; i < ray.size(); i += 2) {
    REQUIRE((Crossing::is_mark(ray[i]) && Crossing::is_mark(ray[i + 1])));
    REQUIRE((Crossing::step(ray[i]) == 1 && Crossing::step(ray[i + 1]) == -1));
    REQUIRE(Crossing::layer(ray[i]) == Crossing::layer(ray[i + 1]));
    out.push_back({Crossing::layer(ray[i]), Crossing::cell(ray[i]), Crossing::cell(ray[i + 1])});
  }
  return out;
}

std::vector<std::vector<Stretch>> joined(Marks& marks, uint32_t rays) {
  Crossings crossings{std::vector<uint32_t>(rays + 1), {}};
  marks.join(tile_of(rays), crossings);
  std::vector<std::vector<Stretch>> out;
  for (const auto& ray : by_ray(crossings)) out.push_back(marks_in(ray, 0));
  return out;
}

TEST_CASE("Marks that continue one another are one, those of another layer, of another ray or behind a gap are not") {
  Marks marks;
  marks.reset(3);
  marks.add(0, 4, 5, 6);
  marks.add(0, 4, 6, 7);
  marks.add(0, 4, 4, 5);   // before it
  marks.add(0, 4, 4, 7);   // again
  marks.add(1, 4, 7, 8);
  marks.add(0, 4, 8, 9);   // a gap
  marks.add(0, 6, 9, 10);  // another layer
  marks.add(0, 4, 9, 10);  // of this one the last mark is not layer 4's
  using Stretches = std::vector<Stretch>;
  const auto rays = joined(marks, 3);
  CHECK(rays[0] == Stretches{{4, 4, 7}, {4, 8, 9}, {6, 9, 10}, {4, 9, 10}});
  CHECK(rays[1] == Stretches{{4, 7, 8}});
  CHECK(rays[2].empty());
}

TEST_CASE("A reset forgets all marks, and those of the last tile don't grow") {
  Marks marks;
  marks.reset(2);
  marks.add(0, 1, 2, 3);
  marks.reset(2);
  CHECK(joined(marks, 2)[0].empty());
  marks.add(0, 1, 3, 4);
  CHECK(joined(marks, 2)[0] == std::vector<Stretch>{{1, 3, 4}});
}

TEST_CASE("Marks join the crossings of their rays behind them, and crossings stay as they are") {
  std::mt19937_64 random(1);
  Marks marks;
  for (size_t round = 0; round < rounds(100); ++round) {
    const auto rays = static_cast<uint32_t>(random_int(random, 1, 20));
    Crossings crossings{{0}, {}};
    for (uint32_t ray = 0; ray < rays; ++ray) {
      for (int i = random_int(random, 0, 3); i > 0; --i)
        crossings.all.push_back(Crossing::pack(random() % 50, static_cast<uint32_t>(random() % 9), random() % 2));
      crossings.begin.push_back(static_cast<uint32_t>(crossings.all.size()));
    }
    const auto before = by_ray(crossings);
    marks.reset(rays);
    std::vector<std::set<std::pair<uint32_t, uint32_t>>> cells(rays), found(rays);  // layer and cell
    for (int i = random_int(random, 0, 60); i > 0; --i) {
      const auto ray = static_cast<uint32_t>(random() % rays), layer = static_cast<uint32_t>(random() % 2),
                 from = static_cast<uint32_t>(random() % 10);
      const uint32_t to = from + 1 + static_cast<uint32_t>(random() % 3);
      marks.add(ray, layer, from, to);
      for (uint32_t cell = from; cell < to; ++cell) cells[ray].insert({layer, cell});
    }
    marks.join(tile_of(rays), crossings);
    const auto after = by_ray(crossings);
    REQUIRE(after.size() == rays);
    REQUIRE(crossings.begin.back() == crossings.all.size());
    for (uint32_t ray = 0; ray < rays; ++ray) {
      REQUIRE(std::vector(after[ray].begin(), after[ray].begin() + static_cast<ptrdiff_t>(before[ray].size())) == before[ray]);
      for (const Stretch& s : marks_in(after[ray], before[ray].size()))
        for (uint32_t cell = s.from; cell < s.to; ++cell) found[ray].insert({s.layer, cell});
      REQUIRE(found[ray] == cells[ray]);
    }
  }
}

}  // namespace
}  // namespace teracell::mesher
