// Links: equal to where rational arithmetic finds that labels change between sample points, whatever the ray axis, engine, threads, chunks and
// interruptions.
#include "store/channels/link_reader.hpp"
#include "store/whole/verify.hpp"
#include "tests/support/cube_grid.hpp"
#include "tests/support/every_way.hpp"
#include "tests/support/ties.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;
using oracle::Body;
using oracle::Rule;
using shapes::Facets;

// By axis and lower cell: end and begin.
using Changes = std::map<std::pair<int, Index3>, std::pair<uint32_t, uint32_t>>;

// Written from the definition. `cells` are the materials in the grid; a sheet shares its own with no other body.
Changes expected_links(const std::vector<Body>& bodies, const Grid& grid, const std::vector<uint32_t>& cells) {
  const Index3 n = grid.cells();
  const auto number = [&](const Index3& c) { return static_cast<size_t>((c[2] * n[1] + c[1]) * n[0] + c[0]); };
  std::vector<std::vector<int>> windings(bodies.size());
  std::map<std::pair<int, Index3>, std::vector<std::vector<std::pair<uint32_t, int>>>> steps;  // of each body
  for (size_t b = 0; b < bodies.size(); ++b) {
    if (!bodies[b].sheet) windings[b] = oracle::winding_numbers(bodies[b].facets, grid, bodies[b].facets[0].vertex[0]);
    for (const oracle::Interval& interval : oracle::intervals(bodies[b].facets, grid)) {
      auto& here = steps[{interval.axis, interval.lower}];
      here.resize(bodies.size());
      here[b] = interval.steps;
    }
  }
  // The strongest body that `has`, or -1: of equal priority the later one.
  const auto strongest = [&](auto&& has) {
    int found = -1;
    for (size_t b = 0; b < bodies.size(); ++b)
      if (has(b) && (found < 0 || bodies[b].priority >= bodies[static_cast<size_t>(found)].priority)) found = static_cast<int>(b);
    return found;
  };
  Changes out;
  for (int axis = 0; axis < 3; ++axis)
    for (int64_t z = 0; z < n[2]; ++z)
      for (int64_t y = 0; y < n[1]; ++y)
        for (int64_t x = 0; x < n[0]; ++x) {
          const Index3 lower = {x, y, z};
          Index3 upper = lower;
          if (++upper[axis] == n[axis] || cells[number(lower)] == cells[number(upper)]) continue;
          auto& [end, begin] = out[{axis, lower}];
          const auto here = steps.find({axis, lower});
          const auto steps_of = [&](size_t b) { return here == steps.end() ? std::vector<std::pair<uint32_t, int>>() : here->second[b]; };
          const auto label_at = [&](uint32_t k) {  // by solids alone
            const int owner = strongest([&](size_t b) {
              if (bodies[b].sheet) return false;
              int winding = windings[b][number(lower)];
              for (const auto& [from, step] : steps_of(b)) winding += from <= k ? step : 0;
              return bodies[b].rule == Rule::kNonzero ? winding != 0 : winding % 2 != 0;
            });
            return owner < 0 ? 0 : bodies[static_cast<size_t>(owner)].material;
          };
          const auto sheet_of = [&](const Index3& c) {
            const auto owner = std::ranges::find_if(bodies, [&](const Body& body) { return body.sheet && body.material == cells[number(c)]; });
            return owner == bodies.end() ? -1 : static_cast<int>(owner - bodies.begin());
          };
          const int a = sheet_of(lower), b = sheet_of(upper);
          if (a >= 0 || b >= 0) {
            const int first = strongest([&](size_t body) { return static_cast<int>(body) == a || static_cast<int>(body) == b; });
            for (const int sheet : {first, first == a ? b : a})
              if (end == 0 && sheet >= 0)
                for (const auto& [k, step] : steps_of(static_cast<size_t>(sheet))) end = end == 0 ? k : std::min(end, k);
            begin = end;
            continue;
          }
          if (label_at(0) != cells[number(lower)] || label_at(65536) != cells[number(upper)]) continue;  // a kept cell
          std::vector<uint32_t> ks = {65536};
          if (here != steps.end())
            for (const auto& of_body : here->second)
              for (const auto& [k, step] : of_body) ks.push_back(k);
          std::ranges::sort(ks);
          for (const uint32_t k : ks)
            if (end == 0 && label_at(k) != cells[number(lower)]) end = k;
          for (size_t i = ks.size(); i-- > 0 && label_at(ks[i]) == cells[number(upper)];) begin = ks[i];
        }
  return out;
}

Changes links_of(const GridReader& reader) {
  const LinkReader links(reader);
  const Index3 n = reader.meta().grid.cells();
  Changes out;
  for (int axis = 0; axis < 3; ++axis)
    links.for_each(axis, {{0, 0, 0}, n}, [&](std::span<const CellLink> found) {
      for (const CellLink& l : found) REQUIRE(out.insert({{axis, l.cell}, {l.end, l.begin}}).second);
    });
  return out;
}

// Names the first one that differs.
void expect_same(const Changes& found, const Changes& expected) {
  const auto [a, b] = std::mismatch(found.begin(), found.end(), expected.begin(), expected.end());
  const auto name = [](Changes::const_iterator link, const Changes& of) {
    if (link == of.end()) return std::string("no other one");
    const auto& [axis, c] = link->first;
    return fmt::format("along {} from {}, {}, {}: end {}, begin {}", axis_name(axis), c[0], c[1], c[2], link->second.first, link->second.second);
  };
  REQUIRE(name(a, found) == name(b, expected));
}

// Along x, y and z, by each engine.
void expect_exact_links(const std::vector<Body>& bodies, const Grid& grid, const std::vector<size_t>& kept = {}) {
  const TempFolder folder;
  Scene scene = scene_of(folder, bodies, grid);
  for (const size_t b : kept) scene.bodies[b].thin = Thin::kKeep;
  MeshOptions options;
  options.chunk_rays = 4;  // several chunks and tile groups
  options.links = true;
  std::optional<Changes> expected;
  for_engines_and_axes(scene, options, [&](const GridReader& reader, const auto&) {
    if (!expected) expected = expected_links(bodies, grid, all_cells(reader));
    expect_same(links_of(reader), *expected);
    verify(reader, 1, [](double) {});
  });
}

TEST_CASE("A wall between two sample points is at its place") {
  const Changes links = links_of(meshed_reader({{shapes::box({0.75, 1, 1}, {2.5, 3, 3})}}, cube_grid_of(0, 1, 4), {.links = true}));
  CHECK(links.at({0, {0, 1, 1}}) == std::pair(16384u, 16384u));
  CHECK(links.at({0, {1, 1, 1}}) == std::pair(65536u, 65536u));  // the sample point on the face counts as outside
  CHECK(links.at({1, {1, 0, 1}}) == std::pair(32768u, 32768u));
  CHECK(links.size() == 8 + 4 + 4);
}

TEST_CASE("Of two sheets side by side the one tells the place that is crossed between their cells") {
  const Grid grid = cube_grid_of(0, 1, 6);
  for (const int priority : {1, -1}) {
    std::vector<Body> bodies;
    for (const double x : {2.2, 3.3})
      bodies.push_back({{Facet{{Vec3{x, 0, 0}, Vec3{x, 9, 0}, Vec3{x, 0, 9}}}}, Rule::kNonzero, static_cast<uint32_t>(x) - 1});
    bodies[0].priority = priority;
    for (Body& body : bodies) body.sheet = true;
    expect_exact_links(bodies, grid);
    const Changes links = links_of(meshed_reader(bodies, grid, {.links = true}));
    CHECK(links.at({0, {2, 1, 1}}) == std::pair(52429u, 52429u));  // 0.8 from the sample point
  }
}

// Along the rays a grid of several segments; the others have one.
TEST_CASE("Links of long rays are those of rays along another axis") {
  const TempFolder folder;
  const auto n = static_cast<int64_t>(2 * Metadata{}.chunk_cells + 1000);
  const Axis across = Axis::uniform(0, 1, 0, 5, 0.5);
  for (int axis = 0; axis < 3; ++axis) {
    Grid grid{{across, across, across}};
    grid.axis[axis] = Axis::uniform(0, 1, 0, n, 0.5);
    const double segment = Metadata{}.chunk_cells;
    Vec3 lo{1.25, 1.25, 1.25}, hi{3.4, 3.4, 3.4}, middle{2.3, 2.3, 2.3};
    lo[axis] = segment - 0.25, hi[axis] = segment + 500;  // its end lies between the last cell of a segment and the next one
    middle[axis] = 2 * segment;
    const Facets begin = shapes::box(lo, hi);
    lo[axis] = static_cast<double>(n) - 500, hi[axis] = static_cast<double>(n) - 3;
    const std::vector<Body> bodies = {{begin}, {shapes::sphere(middle, 1.9, 2), Rule::kNonzero, 2, 1}, {shapes::box(lo, hi), Rule::kNonzero, 3}};
    std::optional<Changes> expected;
    for_axes(scene_of(folder, bodies, grid), {.links = true}, [&](const GridReader& reader, const auto&) {
      REQUIRE((reader.shape(0).segments > 2) == (reader.meta().ray_axis == axis));
      const Changes found = links_of(reader);
      if (!expected) expected = found;
      expect_same(found, *expected);
    });
    CHECK(expected->size() > 8 * 900);
    Index3 before = {2, 2, 2};
    before[axis] = static_cast<int64_t>(segment) - 1;
    CHECK(expected->at({axis, before}) == std::pair(16384u, 16384u));
  }
}

TEST_CASE("Chunks are shorter where walls along the rays have links of every cell", "[long]") {
  const TempFolder folder;
  std::vector<Body> bodies;
  for (int i = 0; i < 8; ++i) bodies.push_back({shapes::box({8. * i + 2.2, 1.3, 1.3}, {8. * i + 5.1, 62.2, 16300.4})});
  const Axis across = Axis::uniform(0, 1, 0, 64, 0.5);
  const Scene scene = scene_of(folder, bodies, {{across, across, Axis::uniform(0, 1, 0, 16384, 0.5)}});
  MeshOptions options{.axis = 2};
  mesh_quietly(scene, folder / "g.tcell", options);
  CHECK(GridReader(folder / "g.tcell").shape(0).segments == 1);
  options.links = true;
  mesh_quietly(scene, folder / "g.tcell", options);
  const GridReader reader(folder / "g.tcell");
  CHECK(reader.shape(0).segments > 7);
  uint64_t links = 0;
  LinkReader(reader).for_each(0, {{0, 0, 8000}, {64, 64, 8001}}, [&](std::span<const CellLink> found) { links += found.size(); });
  CHECK(links == 2 * 8 * 61);
}

TEST_CASE("Links of random scenes full of ties are where rational arithmetic finds them, along every axis and by every engine") {
  for_seeds(0, rounds(20), [](auto& random) {
    const int n = random_int(random, 3, 9);
    const Grid grid = shapes::grid_of_ties(random, n);
    expect_exact_links(shapes::bodies_of_ties(random, n, 4), grid);
  });
}

TEST_CASE("Links of decimal lattices, slopes and needles are where rational arithmetic finds them") {
  for_seeds(100, rounds(10), [](auto& random) {
    expect_exact_links(shapes::decimal_bodies(random, 2), cube_grid_of(0, 1.1 / 5, 5));
    expect_exact_links({{shapes::needle(random)}, {shapes::sphere({4, 5, 3}, 6.3, 2), Rule::kNonzero, 2}}, cube_grid_of(-7, 5, 5));
  });
}

TEST_CASE("Links at sheets and at kept cells") {
  for_seeds(0, rounds(8), [](auto& random) {
    const auto at = [&] { return random_int(random, 20, 60) / 10.0; };
    std::vector<Body> bodies = {{shapes::box({1.2, 1.2, 1.2}, {4.7, 4.7, 6.7}), Rule::kNonzero, 1, random_int(random, 0, 2)},
                                {shapes::sphere({at(), at(), at()}, 2.2, 2), Rule::kNonzero, 2, random_int(random, 0, 2), true},
                                {shapes::box({2.6, at() / 10, 1}, {2.9, 7, 8}), Rule::kNonzero, 3, random_int(random, 0, 2)},
                                {shapes::sphere({at(), at(), at()}, 3.1, 1), Rule::kNonzero, 4, random_int(random, 0, 2), true}};
    expect_exact_links(bodies, cube_grid_of(0, 1, 9), {2});
  });
}

}  // namespace
}  // namespace teracell::mesher
