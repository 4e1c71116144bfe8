// Everything that reads cells, against the cells themselves: level 0 one by one, coarser sets by brute force from it.
#include "store/slice.hpp"

#include <catch2/catch.hpp>

#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

namespace teracell {
namespace {

using namespace testing;

// A file and its cells, and every way of reading held against them.
struct Checked {
  const GridReader& reader;
  const std::vector<Label> cells;  // of level 0; materials and labels are numbered alike
  std::mt19937_64 random;
  std::vector<std::vector<Mask>> levels;

  Checked(const GridReader& r, std::vector<Label> c, uint64_t seed) : reader(r), cells(std::move(c)), random(seed) {
    for (int level = 0; level < grid().levels(); ++level) levels.push_back(level_by_hand(grid(), cells, level));
  }

  const Grid& grid() const { return reader.meta().grid; }
  Mask at(int level, int64_t x, int64_t y, int64_t z) const {
    const Index3 n = grid().cells(level);
    return levels[static_cast<size_t>(level)][static_cast<size_t>((z * n[1] + y) * n[0] + x)];
  }
  // The strongest material: of metadata_of() the last, of the mesher's scenes here too.
  static uint32_t strongest(Mask set) { return 63 - static_cast<uint32_t>(__builtin_clzll(set)); }
  static uint32_t as_mask(const std::vector<Label>& set) { return static_cast<uint32_t>(mask_of(set)); }

  // A box within the level, or reaching up to `halo` cells beyond it.
  Box random_box(int level, int halo) {
    const Index3 n = grid().cells(level);
    Box box;
    for (int d = 0; d < 3; ++d) {
      box.lo[d] = random_int(random, -halo, static_cast<int>(n[d]) + halo - 1);
      box.hi[d] = random_int(random, static_cast<int>(box.lo[d]) + 1, static_cast<int>(n[d]) + halo);
    }
    return box;
  }

  template <class F>
  static void for_cells(const Box& box, F&& f) {
    for (int64_t z = box.lo[2]; z < box.hi[2]; ++z)
      for (int64_t y = box.lo[1]; y < box.hi[1]; ++y)
        for (int64_t x = box.lo[0]; x < box.hi[0]; ++x) f(x, y, z);
  }

  // read_box with axes in any order in memory, steps and gaps between them; what lies in the gaps must stay.
  template <class T>
  void box(int level, const Box& box) {
    std::array<int, 3> order = {0, 1, 2};
    std::ranges::shuffle(order, random);
    Index3 stride;
    int64_t size = 1;
    for (const int d : order) {
      stride[d] = size * random_int(random, 1, 2);
      size = stride[d] * (box.hi[d] - box.lo[d]);
    }
    constexpr T kUntouched = 199, kOutside = 200;
    std::vector<T> found(static_cast<size_t>(size), kUntouched), expected = found;
    const Index3 n = grid().cells(level);
    for_cells(box, [&](int64_t x, int64_t y, int64_t z) {
      const bool inside = x >= 0 && y >= 0 && z >= 0 && x < n[0] && y < n[1] && z < n[2];
      expected[static_cast<size_t>((x - box.lo[0]) * stride[0] + (y - box.lo[1]) * stride[1] + (z - box.lo[2]) * stride[2])] =
          inside ? static_cast<T>(at(level, x, y, z)) : kOutside;
    });
    read_box<T>(reader, level, box, as_mask, kOutside, found.data(), stride);
    REQUIRE(found == expected);
  }

  void boxes(int level) {
    box<uint32_t>(level, grid().box(level));
    for (int i = 0; i < 6; ++i) {
      box<uint8_t>(level, random_box(level, 0));
      box<uint16_t>(level, random_box(level, 3));
      box<uint32_t>(level, random_box(level, 3));
    }
    box<uint16_t>(level, {{-7, -7, -7}, {-5, -5, -5}});  // all of it outside
    std::vector<uint16_t> nothing;
    read_box<uint16_t>(reader, level, {{1, 0, 0}, {1, 1, 1}}, as_mask, 0, nothing.data(), {1, 1, 1});
  }

  // The runs of a box cover each of its cells once, ascend along a ray, and are as long as they can be in a chunk.
  void runs(int level, const Box& box) {
    const int w = reader.meta().ray_axis;
    const auto chunk = static_cast<int64_t>(reader.meta().chunk_cells);
    std::vector<int> covered(levels[static_cast<size_t>(level)].size(), 0);
    size_t wrong = 0, count = 0, expected = 0;
    const Index3 n = grid().cells(level);
    for_each_run(reader, level, box, [&](const BoxRun& run) {
      ++count;
      Index3 end = run.start;
      for (Index3& e = end; e[w] < run.start[w] + run.length; ++e[w]) {
        wrong += at(level, e[0], e[1], e[2]) != mask_of(*run.set);
        ++covered[static_cast<size_t>((e[2] * n[1] + e[1]) * n[0] + e[0])];
      }
    });
    for_cells(box, [&](int64_t x, int64_t y, int64_t z) {
      wrong += covered[static_cast<size_t>((z * n[1] + y) * n[0] + x)]-- != 1;
      Index3 before = {x, y, z};
      --before[w];
      const bool starts = before[w] < box.lo[w] || (before[w] + 1) % chunk == 0;
      expected += starts || at(level, before[0], before[1], before[2]) != at(level, x, y, z);
    });
    for (const int c : covered) wrong += c != 0;
    REQUIRE(wrong == 0);
    REQUIRE(count == expected);
  }

  void columns() {
    for (int axis = 0; axis < 3; ++axis) {
      const Frame f = Frame::along(axis);
      const Index3 n = grid().cells();
      for (int i = 0; i < 12; ++i) {
        Index3 cell;
        cell[f.u] = random_int(random, 0, static_cast<int>(n[f.u]) - 1);
        cell[f.v] = random_int(random, 0, static_cast<int>(n[f.v]) - 1);
        int64_t next = 0;
        bool good = true;
        uint32_t last = ~0u;
        for (const ColumnRun& run : read_column(reader, axis, cell[f.u], cell[f.v])) {
          good &= run.from == next && run.to > run.from && run.material != last;
          for (cell[axis] = run.from; cell[axis] < run.to; ++cell[axis]) good &= at(0, cell[0], cell[1], cell[2]) == Mask{1} << run.material;
          next = run.to, last = run.material;
        }
        INFO("column along " << axis_name(axis));
        REQUIRE(good);
        REQUIRE(next == n[axis]);
      }
    }
  }

  void stats(const Box& box) {
    std::vector<MaterialStats> expected(reader.meta().materials.size());
    for_cells(box, [&](int64_t x, int64_t y, int64_t z) {
      MaterialStats& s = expected[strongest(at(0, x, y, z))];
      const Index3 cell = {x, y, z};
      double volume = 1;
      for (int d = 0; d < 3; ++d) {
        s.box.lo[d] = s.cells == 0 ? cell[d] : std::min(s.box.lo[d], cell[d]);
        s.box.hi[d] = s.cells == 0 ? cell[d] + 1 : std::max(s.box.hi[d], cell[d] + 1);
        volume *= grid().axis[d].plane(cell[d] + 1) - grid().axis[d].plane(cell[d]);
      }
      s.cells += 1;
      s.volume += volume;
    });
    const auto found = read_stats(reader, box);
    REQUIRE(found.size() == expected.size());
    for (size_t m = 0; m < found.size(); ++m) {
      REQUIRE(static_cast<uint64_t>(found[m].cells) == static_cast<uint64_t>(expected[m].cells));
      REQUIRE(found[m].volume == Approx(expected[m].volume).epsilon(1e-10));
      REQUIRE(found[m].box == expected[m].box);
    }
  }

  void rows(const SliceView& view, bool top_down, int threads, int64_t held = kHeldCells) {
    const Frame f = Frame::along(view.axis);
    int64_t next = top_down ? view.v1 - 1 : view.v0, u = view.u0;
    bool good = true;
    const auto take = [&](int64_t v, std::span<const uint16_t> values) {
      good &= v == next && !values.empty() && u + static_cast<int64_t>(values.size()) <= view.u1;
      Index3 cell;
      cell[view.axis] = view.index, cell[f.v] = v;
      for (size_t i = 0; good && i < values.size(); ++i) {
        cell[f.u] = u++;
        good = values[i] == at(view.level, cell[0], cell[1], cell[2]);
      }
      if (u == view.u1) u = view.u0, next += top_down ? -1 : 1;
    };
    for_each_row(reader, view, as_mask, top_down, threads, take, held);
    INFO("slice across " << axis_name(view.axis) << " at " << view.index << ", top down " << top_down << ", " << threads << " threads, " << held << " cells held");
    REQUIRE(good);
    REQUIRE((u == view.u0 && next == (top_down ? view.v0 - 1 : view.v1)));
  }

  void slices(int level) {
    const Index3 n = grid().cells(level);
    for (int axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < 3; ++i) {
        SliceView view = whole_slice(reader.meta(), axis, random_int(random, 0, static_cast<int>(n[axis]) - 1), level);
        if (i > 0) {
          const Box part = random_box(level, 0);
          const Frame f = Frame::along(axis);
          view.u0 = part.lo[f.u], view.u1 = part.hi[f.u], view.v0 = part.lo[f.v], view.v1 = part.hi[f.v];
        }
        for (const bool top_down : {true, false})
          for (const int threads : {1, random_int(random, 2, 3)})
            for (const int64_t held : {kHeldCells, int64_t{1} << random_int(random, 0, 14)}) rows(view, top_down, threads, held);
      }
    }
  }

  void everything() {
    REQUIRE(reader.levels() == static_cast<int>(levels.size()));
    for (int level = 0; level < reader.levels(); ++level) {
      INFO("level " << level << (reader.stored(level) ? "" : ", derived"));
      boxes(level);
      runs(level, grid().box(level));
      for (int i = 0; i < 6; ++i) runs(level, random_box(level, 0));
      slices(level);
    }
    columns();
    stats(grid().box(0));
    for (int i = 0; i < 10; ++i) {
      const Box part = random_box(0, 0);
      stats(part);
      for (int d = 0; d < 3; ++d) {  // slabs: whole chunks cut along one axis
        Box slab = grid().box(0);
        slab.lo[d] = part.lo[d], slab.hi[d] = part.hi[d];
        stats(slab);
      }
    }
  }
};

Axis graded_axis(std::mt19937_64& random, int cells) {
  std::vector<double> planes = {-1};
  for (int i = 0; i < cells; ++i) planes.push_back(planes.back() + random_int(random, 1, 8) / 8.0);
  return Axis::graded(planes, 0.5);
}

Grid random_grid(std::mt19937_64& random, int most) {
  Grid grid;
  for (Axis& axis : grid.axis) {
    const int cells = random_int(random, 1, most);
    axis = random_int(random, 0, 3) == 0 ? graded_axis(random, cells) : Axis::uniform(-1, 0.25, random_int(random, 0, 3), cells, 0.5);
  }
  return grid;
}

TEST_CASE("Meshed scenes of several bodies are read as their cells along every ray axis, at every level, in every way") {
  for (uint64_t seed = 0; seed < 6; ++seed) {
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
    const Scene scene = scene_of(folder, bodies, grid);
    const std::vector<uint32_t> cells = oracle::materials(bodies, grid);
    for (int axis = 0; axis < 3; ++axis) {
      INFO("seed " << seed << ", rays along " << axis_name(axis));
      MeshOptions options;
      options.axis = axis;
      options.threads = 2;
      mesh_quietly(scene, folder / "g.tcell", options);
      const GridReader reader(folder / "g.tcell");
      Checked(reader, cells, seed).everything();
    }
  }
}

TEST_CASE("Random cells in many small chunks and pages are read as they are along every ray axis, in every way") {
  for (uint64_t seed = 0; seed < 6; ++seed) {
    std::mt19937_64 random(seed);
    const Grid grid = random_grid(random, 40);
    const std::vector<Label> cells = random_cells(random, grid.cells(), 5);
    const TempFolder folder;
    for (int axis = 0; axis < 3; ++axis) {
      INFO("seed " << seed << ", rays along " << axis_name(axis));
      Metadata meta = metadata_of(grid, axis, 5);
      meta.chunk_rays = std::array<uint32_t, 3>{4, 8, 12}[seed % 3];
      meta.chunk_cells = 16;
      meta.page_chunks = 2;
      store_cells(folder / "g.tcell", meta, cells);
      const GridReader reader(folder / "g.tcell");
      REQUIRE_NOTHROW(reader.verify(2, [](double) {}));
      Checked(reader, cells, seed).everything();
    }
  }
}

TEST_CASE("Grids one cell thin, or of one cell, are read like any other") {
  std::mt19937_64 random(20);
  for (const Index3& n : {Index3{1, 1, 1}, Index3{1, 1, 70}, Index3{70, 1, 1}, Index3{1, 70, 1}, Index3{33, 1, 18}, Index3{2, 2, 2}}) {
    const Grid grid{{Axis::uniform(0, 1, 0, n[0], 0.5), Axis::uniform(0, 1, 0, n[1], 0.5), Axis::uniform(0, 1, 0, n[2], 0.5)}};
    const std::vector<Label> cells = random_cells(random, n, 3);
    const TempFolder folder;
    for (int axis = 0; axis < 3; ++axis) {
      store_cells(folder / "g.tcell", with_tiny_chunks(metadata_of(grid, axis, 3)), cells);
      const GridReader reader(folder / "g.tcell");
      REQUIRE_NOTHROW(reader.verify(1, [](double) {}));
      Checked(reader, cells, 20).everything();
    }
  }
}

TEST_CASE("Where one material must stand for a set it is the one of least rank, the background last") {
  Metadata meta = metadata_of({}, 2, 4);
  meta.materials[0].rank = 3, meta.materials[1].rank = 2, meta.materials[2].rank = 0, meta.materials[3].rank = 1;
  meta.labels = {{0, ""}, {3, "a"}, {1, "b"}, {2, "c"}, {3, "d"}};
  const SetValue material = strongest_material(meta);
  REQUIRE(material({0}) == 0);
  REQUIRE(material({0, 2}) == 1);
  REQUIRE(material({0, 1, 2}) == 3);
  REQUIRE(material({0, 1, 2, 3, 4}) == 2);
  REQUIRE(material({1, 4}) == 3);
}

TEST_CASE("Labels that keep bodies apart join in columns, statistics and slices to their material") {
  const Axis axis = Axis::uniform(0, 1, 0, 8, 0.5), one = Axis::uniform(0, 1, 0, 1, 0.5);
  Metadata meta = metadata_of({{one, one, axis}}, 2, 3);
  meta.labels = {{0, ""}, {1, "a"}, {1, "b"}, {2, "c"}};
  const TempFolder folder;
  store_cells(folder / "g.tcell", meta, {0, 1, 1, 2, 2, 3, 3, 0});
  const GridReader reader(folder / "g.tcell");
  const auto runs = read_column(reader, 2, 0, 0);
  REQUIRE(runs.size() == 4);
  REQUIRE((runs[1].from == 1 && runs[1].to == 5 && runs[1].material == 1));
  const auto stats = read_stats(reader, meta.grid.box(0));
  REQUIRE(static_cast<uint64_t>(stats[1].cells) == 4);
  REQUIRE(stats[1].box == Box{{0, 0, 1}, {1, 1, 5}});
  REQUIRE(all_cells(reader) == std::vector<uint32_t>{0, 1, 1, 1, 1, 2, 2, 0});
}

TEST_CASE("A material without cells has no volume and an empty box; an empty region has no cells") {
  const Axis axis = Axis::uniform(0, 1, 0, 4, 0.5);
  const TempFolder folder;
  store_cells(folder / "g.tcell", metadata_of({{axis, axis, axis}}, 0, 3), std::vector<Label>(64, 1));
  const GridReader reader(folder / "g.tcell");
  const auto stats = read_stats(reader, {{0, 0, 0}, {4, 4, 4}});
  REQUIRE(stats[1].volume == 64);
  REQUIRE((stats[2].cells == 0 && stats[2].volume == 0 && stats[2].box.empty()));
  for (const MaterialStats& s : read_stats(reader, {{2, 2, 2}, {2, 3, 3}})) REQUIRE((s.cells == 0 && s.box.empty()));
}

TEST_CASE("An exception of the sink ends the slice, whatever the threads") {
  const Axis axis = Axis::uniform(0, 1, 0, 40, 0.5);
  std::mt19937_64 random(21);
  const TempFolder folder;
  store_cells(folder / "g.tcell", with_tiny_chunks(metadata_of({{axis, axis, axis}}, 2, 3)), random_cells(random, {40, 40, 40}, 3));
  const GridReader reader(folder / "g.tcell");
  for (int slice = 0; slice < 3; ++slice)
    for (const int threads : {1, 3}) {
      int rows = 0;
      const auto run = [&] {
        for_each_row(reader, whole_slice(reader.meta(), slice, 7, 0), strongest_material(reader.meta()), true, threads, [&](int64_t, std::span<const uint16_t>) {
          if (++rows == 9) throw IoError("full disk");
        });
      };
      REQUIRE_THROWS_AS(run(), IoError);
      REQUIRE(rows == 9);
    }
}

TEST_CASE("Levels, indices, columns and regions out of range are usage errors that name the range") {
  const TempFolder folder;
  const auto axis = [](int64_t n) { return Axis::uniform(0, 1, 0, n, 0.5); };
  store_cells(folder / "g.tcell", metadata_of({{axis(8), axis(9), axis(10)}}, 2, 2), std::vector<Label>(720, 1));
  const GridReader reader(folder / "g.tcell");
  const Metadata& meta = reader.meta();
  REQUIRE(reader.levels() == 5);
  for (const int level : {-1, 5, 31, 1000}) {
    uint32_t cell;
    REQUIRE_THROWS_WITH(whole_slice(meta, 2, 0, level), Catch::Contains("0 to 4"));
    REQUIRE_THROWS_AS(read_box<uint32_t>(reader, level, {{0, 0, 0}, {1, 1, 1}}, strongest_material(meta), 0, &cell, {1, 1, 1}), UsageError);
    REQUIRE_THROWS_AS(for_each_run(reader, level, {{0, 0, 0}, {1, 1, 1}}, [](const BoxRun&) {}), UsageError);
  }
  for (const int64_t index : {int64_t{-1}, int64_t{10}, std::numeric_limits<int64_t>::max()}) REQUIRE_THROWS_WITH(whole_slice(meta, 2, index, 0), Catch::Contains("0 to 9"));
  REQUIRE_THROWS_WITH(whole_slice(meta, 0, 4, 1), Catch::Contains("0 to 3"));
  for (const auto& [a, b] : {std::pair<int64_t, int64_t>{-1, 0}, {8, 0}, {0, -1}, {0, 9}}) REQUIRE_THROWS_WITH(read_column(reader, 2, a, b), Catch::Contains("0 to 7") && Catch::Contains("0 to 8"));
  const SliceView whole = whole_slice(meta, 2, 0, 0);
  for (const auto& edit : std::initializer_list<void (*)(SliceView&)>{[](SliceView& v) { v.u0 = -1; }, [](SliceView& v) { v.u1 = 9; }, [](SliceView& v) { v.v0 = 9; },
                                                                      [](SliceView& v) { v.v1 = 10; }, [](SliceView& v) { v.u0 = 5, v.u1 = 5; }, [](SliceView& v) { v.index = 10; }}) {
    SliceView view = whole;
    edit(view);
    REQUIRE_THROWS_AS(for_each_row(reader, view, strongest_material(meta), true, 1, [](int64_t, std::span<const uint16_t>) {}), UsageError);
  }
}

TEST_CASE("A box beyond the grid is refused by all that do not fill what lies outside") {
  const TempFolder folder;
  const Grid grid{{Axis::uniform(0, 1, 0, 5, 0.5), Axis::uniform(0, 1, 0, 6, 0.5), Axis::uniform(0, 1, 0, 7, 0.5)}};
  mesh_quietly(scene_of(folder, {{shapes::box({1, 1, 1}, {3, 3, 3})}}, grid), folder / "g.tcell");
  const GridReader reader(folder / "g.tcell");
  for (const Box& box : {Box{{0, 0, 0}, {6, 6, 7}}, Box{{-1, 0, 0}, {5, 6, 7}}, Box{{0, 0, 0}, {5, 6, int64_t{1} << 40}}}) {
    REQUIRE_THROWS_AS(for_each_run(reader, 0, box, [](const BoxRun&) {}), UsageError);
    REQUIRE_THROWS_AS(read_stats(reader, box), UsageError);
  }
}

}  // namespace
}  // namespace teracell
