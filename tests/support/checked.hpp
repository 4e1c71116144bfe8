// Everything that reads cells, held against the cells themselves: level 0 one by one, coarser sets by brute force from it.
#pragma once
#include "store/read/query.hpp"
#include "store/read/slice.hpp"
#include "store/read/stats.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

namespace teracell::testing {

// A file and its cells: every way of reading is held against them.
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

  // read_box on some threads with axes in any order in memory, either way, steps and gaps between them; what lies in the gaps must stay.
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
    int64_t first = 0;  // where the cell box.lo lies
    for (int d = 0; d < 3; ++d) {
      if (random() % 4 > 0) continue;
      first += stride[d] * (box.hi[d] - box.lo[d] - 1);
      stride[d] = -stride[d];
    }
    constexpr T kUntouched = 199, kOutside = 200;
    std::vector<T> found(static_cast<size_t>(size), kUntouched), expected = found;
    const Index3 n = grid().cells(level);
    for_cells(box, [&](int64_t x, int64_t y, int64_t z) {
      const bool inside = x >= 0 && y >= 0 && z >= 0 && x < n[0] && y < n[1] && z < n[2];
      expected[static_cast<size_t>(first + (x - box.lo[0]) * stride[0] + (y - box.lo[1]) * stride[1] + (z - box.lo[2]) * stride[2])] =
          inside ? static_cast<T>(at(level, x, y, z)) : kOutside;
    });
    read_box<T>(reader, level, box, as_mask, kOutside, found.data() + first, stride, static_cast<int>(random_int(random, 1, 3)));
    REQUIRE(found == expected);
  }

  // read_lattice against read_box of all cells between.
  void lattice(int level) {
    const Box all = random_box(level, 3);
    Lattice some{all.lo};
    int64_t size = 1;
    Index3 stride{}, in_all{1, all.hi[0] - all.lo[0], 0};
    in_all[2] = in_all[1] * (all.hi[1] - all.lo[1]);
    for (const int d : {1, 2, 0}) {
      some.step[d] = random_int(random, 1, 7);
      some.count[d] = (all.hi[d] - all.lo[d] - 1) / some.step[d] + 1;
      stride[d] = size;
      size *= some.count[d];
    }
    std::vector<uint16_t> whole(static_cast<size_t>(in_all[2] * (all.hi[2] - all.lo[2]))), found(static_cast<size_t>(size), 199), expected = found;
    read_box<uint16_t>(reader, level, all, as_mask, 200, whole.data(), in_all);
    for_cells({{0, 0, 0}, some.count}, [&](int64_t x, int64_t y, int64_t z) {
      expected[static_cast<size_t>(x * stride[0] + y * stride[1] + z * stride[2])] =
          whole[static_cast<size_t>(x * some.step[0] + y * some.step[1] * in_all[1] + z * some.step[2] * in_all[2])];
    });
    read_lattice<uint16_t>(reader, level, some, as_mask, 200, found.data(), stride, static_cast<int>(random_int(random, 1, 3)));
    REQUIRE(found == expected);
  }

  void boxes(int level) {
    box<uint32_t>(level, grid().box(level));
    for (int i = 0; i < 6; ++i) {
      box<uint8_t>(level, random_box(level, 0));
      box<uint16_t>(level, random_box(level, 3));
      box<uint32_t>(level, random_box(level, 3));
      lattice(level);
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
      const RayFrame f = RayFrame::along(axis);
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
    std::vector<CellStats> expected(reader.meta().materials.size());
    for_cells(box, [&](int64_t x, int64_t y, int64_t z) {
      CellStats& s = expected[strongest(at(0, x, y, z))];
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
    const RayFrame f = RayFrame::along(view.axis);
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
    INFO("slice across " << axis_name(view.axis) << " at " << view.index << ", top down " << top_down << ", " << threads << " threads, " << held
                         << " cells held");
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
          const RayFrame f = RayFrame::along(axis);
          view.u0 = part.lo[f.u], view.u1 = part.hi[f.u], view.v0 = part.lo[f.v], view.v1 = part.hi[f.v];
        }
        for (const bool top_down : {true, false})
          for (const int threads : {1, random_int(random, 2, 3)})
            for (const int64_t held : {kHeldCells, int64_t{1} << random_int(random, 0, 14)}) rows(view, top_down, threads, held);
      }
    }
  }

  template <class F>
  void at_every_level(F&& f) {
    REQUIRE(reader.levels() == static_cast<int>(levels.size()));
    for (int level = 0; level < reader.levels(); ++level) {
      INFO("level " << level << (reader.stored(level) ? "" : ", derived"));
      f(level);
    }
  }

  void queries() {
    at_every_level([&](int level) {
      boxes(level);
      runs(level, grid().box(level));
      for (int i = 0; i < 6; ++i) runs(level, random_box(level, 0));
    });
    columns();
  }

  void slices() {
    at_every_level([&](int level) { slices(level); });
  }

  void stats() {
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

  void everything() {
    queries();
    slices();
    stats();
  }
};

inline Axis graded_axis(std::mt19937_64& random, int cells) {
  std::vector<double> planes = {-1};
  for (int i = 0; i < cells; ++i) planes.push_back(planes.back() + random_int(random, 1, 8) / 8.0);
  return Axis::graded(planes, 0.5);
}

inline Grid random_grid(std::mt19937_64& random, int most) {
  Grid grid;
  for (Axis& axis : grid.axis) {
    const int cells = random_int(random, 1, most);
    axis = random_int(random, 0, 3) == 0 ? graded_axis(random, cells) : Axis::uniform(-1, 0.25, random_int(random, 0, 3), cells, 0.5);
  }
  return grid;
}

// Random cells in many small chunks and pages, with rays along every axis.
template <class F>
void for_random_cells(F&& f) {
  for (uint64_t seed = 0; seed < (kSanitized ? 3 : 6); ++seed) {
    std::mt19937_64 random(seed);
    const Grid grid = random_grid(random, 40);
    const std::vector<Label> cells = random_cells(random, grid.cells(), 5);
    const TempFolder folder;
    for (int axis = 0; axis < 3; ++axis) {
      if (kSanitized && axis != static_cast<int>(seed % 3)) continue;
      INFO("seed " << seed << ", rays along " << axis_name(axis));
      Metadata meta = metadata_of(grid, axis, 5);
      meta.chunk_rays = std::array<uint32_t, 3>{4, 8, 12}[seed % 3];
      meta.chunk_cells = 16;
      meta.page_chunks = 2;
      store_cells(folder / "g.tcell", meta, cells);
      const GridReader reader(folder / "g.tcell");
      f(Checked(reader, cells, seed));
    }
  }
}

}  // namespace teracell::testing
