// Boxes, runs and columns against the cells one by one; and all ways of reading on meshed scenes and thin grids.
#include "store/read/query.hpp"

#include "tests/support/checked.hpp"

namespace teracell {
namespace {

using namespace testing;

TEST_CASE("Meshed scenes of several bodies are read as their cells along every ray axis, at every level, in every way") {
  for (uint64_t seed = 0; seed < rounds(6); ++seed) {
    std::mt19937_64 random(seed);
    std::vector<oracle::Body> bodies;
    const auto number = [&] { return random_int(random, 0, 40) / 4.0; };
    for (uint32_t material = 1; material <= 4; ++material) {
      const Vec3 lo = {number(), number(), number()};
      const Vec3 hi = {lo[0] + 1 + number(), lo[1] + 1 + number(), lo[2] + 1 + number()};
      if (material % 2 == 0) bodies.push_back({shapes::box(lo, hi), oracle::Rule::kNonzero, material});
      else bodies.push_back({shapes::sphere(lo, 1 + number() / 2, 2, 0.25), oracle::Rule::kNonzero, material});
    }
    Grid grid{{Axis::uniform(0, 0.5, 0, 20 + random_int(random, 0, 9), 0.5), Axis::uniform(0, 0.5, 0, 17, 0.5), Axis::uniform(0, 0.5, 0, 25, 0.5)}};
    if (seed % 2 == 1) grid.axis[random() % 3] = graded_axis(random, 19);
    const TempFolder folder;
    const mesher::Scene scene = scene_of(folder, bodies, grid);
    const std::vector<uint32_t> cells = oracle::materials(bodies, grid);
    for (int axis = 0; axis < 3; ++axis) {
      if (kSanitized && axis != static_cast<int>(seed % 3)) continue;
      INFO("seed " << seed << ", rays along " << axis_name(axis));
      mesh_quietly(scene, folder / "g.tcell", {.axis = axis, .threads = 2});
      const GridReader reader(folder / "g.tcell");
      Checked(reader, cells, seed).everything();
    }
  }
}

TEST_CASE("Boxes, runs and columns of random cells in many small chunks are the cells") {
  for_random_cells([](Checked&& checked) { checked.queries(); });
}

TEST_CASE("Grids one cell thin, or of one cell, are read like any other") {
  std::mt19937_64 random(20);
  for (const Index3& n : {Index3{1, 1, 1}, Index3{1, 1, 70}, Index3{70, 1, 1}, Index3{1, 70, 1}, Index3{33, 1, 18}, Index3{2, 2, 2}}) {
    const Grid grid = unit_grid(n);
    const std::vector<Label> cells = random_cells(random, n, 3);
    for (int axis = 0; axis < 3; ++axis) {
      if (kSanitized && n[axis] > 2) continue;
      const GridReader reader = reader_of(with_tiny_chunks(metadata_of(grid, axis, 3)), cells);
      Checked(reader, cells, 20).everything();
    }
  }
}

TEST_CASE("Labels that keep bodies apart join in columns, statistics and slices to their material") {
  const Axis axis = Axis::uniform(0, 1, 0, 8, 0.5), one = Axis::uniform(0, 1, 0, 1, 0.5);
  Metadata meta = metadata_of({{one, one, axis}}, 2, 3);
  meta.labels = {{0, ""}, {1, "a"}, {1, "b"}, {2, "c"}};
  const GridReader reader = reader_of(meta, {0, 1, 1, 2, 2, 3, 3, 0});
  const auto runs = read_column(reader, 2, 0, 0);
  REQUIRE(runs.size() == 4);
  REQUIRE((runs[1].from == 1 && runs[1].to == 5 && runs[1].material == 1));
  const auto stats = read_stats(reader, meta.grid.box(0));
  REQUIRE(static_cast<uint64_t>(stats[1].cells) == 4);
  REQUIRE(stats[1].box == Box{{0, 0, 1}, {1, 1, 5}});
  REQUIRE(all_cells(reader) == std::vector<uint32_t>{0, 1, 1, 1, 1, 2, 2, 0});
}

TEST_CASE("Levels that are not there, and columns outside the grid, are usage errors") {
  const GridReader reader = reader_of(metadata_of(unit_grid({8, 9, 10}), 2, 2), std::vector<Label>(720, 1));
  const Metadata& meta = reader.meta();
  REQUIRE(reader.levels() == 5);
  for (const int level : {-1, 5, 31, 1000}) {
    uint32_t cell;
    REQUIRE_THROWS_AS(read_box<uint32_t>(reader, level, {{0, 0, 0}, {1, 1, 1}}, strongest_material(meta), 0, &cell, {1, 1, 1}), UsageError);
    REQUIRE_THROWS_AS(for_each_run(reader, level, {{0, 0, 0}, {1, 1, 1}}, [](const BoxRun&) {}), UsageError);
  }
  for (const auto& [a, b] : {std::pair<int64_t, int64_t>{-1, 0}, {8, 0}, {0, -1}, {0, 9}})
    REQUIRE_THROWS_WITH(read_column(reader, 2, a, b), Catch::Contains("0 to 7") && Catch::Contains("0 to 8"));
}

TEST_CASE("A box beyond the grid is refused by all that do not fill what lies outside") {
  const Grid grid = unit_grid({5, 6, 7});
  const GridReader reader = meshed_reader({{shapes::box({1, 1, 1}, {3, 3, 3})}}, grid);
  for (const Box& box : {Box{{0, 0, 0}, {6, 6, 7}}, Box{{-1, 0, 0}, {5, 6, 7}}, Box{{0, 0, 0}, {5, 6, int64_t{1} << 40}}}) {
    REQUIRE_THROWS_AS(for_each_run(reader, 0, box, [](const BoxRun&) {}), UsageError);
    REQUIRE_THROWS_AS(read_stats(reader, box), UsageError);
  }
}

}  // namespace
}  // namespace teracell
