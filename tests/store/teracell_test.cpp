// The C API, through the shared library, against the reader that it stands on and against the cells.
#include "store/teracell.h"

#include "store/whole/info.hpp"
#include "tests/support/checked.hpp"

using namespace teracell;
using namespace teracell::testing;

namespace {

struct Close {
  void operator()(tc_grid* grid) const { tc_close(grid); }
};
using Handle = std::unique_ptr<tc_grid, Close>;

Handle opened(const std::filesystem::path& path) {
  tc_grid* grid = nullptr;
  REQUIRE(tc_open(path.c_str(), &grid) == TC_OK);
  return Handle(grid);
}

// Random cells with many small chunks, as a file, and through both libraries.
struct Opened {
  explicit Opened(uint64_t seed = 5, int ray_axis = 1, uint32_t labels = 5)
      : random(seed), axes(random_grid(random, 30)), cells(random_cells(random, axes.cells(), labels)) {
    store_cells(folder / "g.tcell", with_tiny_chunks(metadata_of(axes, ray_axis, labels)), cells);
    grid = opened(folder / "g.tcell");
    reader.emplace(folder / "g.tcell");
  }
  Box random_box(int level) {
    const Index3 n = axes.cells(level);
    Box box;
    for (int d = 0; d < 3; ++d) {
      box.lo[d] = random_int(random, -4, static_cast<int>(n[d]) + 2);
      box.hi[d] = box.lo[d] + random_int(random, 0, static_cast<int>(n[d]) + 3);
    }
    return box;
  }
  Box inside(const Box& box, int level) const {
    const Index3 n = axes.cells(level);
    Box out;
    for (int d = 0; d < 3; ++d) out.lo[d] = std::clamp<int64_t>(box.lo[d], 0, n[d]), out.hi[d] = std::clamp<int64_t>(box.hi[d], out.lo[d], n[d]);
    return out;
  }

  TempFolder folder;
  std::mt19937_64 random;
  Grid axes;
  std::vector<Label> cells;
  Handle grid;
  std::optional<GridReader> reader;
};

int64_t volume(const Box& b) { return (b.hi[0] - b.lo[0]) * (b.hi[1] - b.lo[1]) * (b.hi[2] - b.lo[2]); }

template <class T>
void expect_box(Opened& o, int level, int type, bool mapped) {
  const Box box = o.random_box(level);
  const int64_t nx = box.hi[0] - box.lo[0], ny = box.hi[1] - box.lo[1];
  const std::vector<uint32_t> map = {7, 200, 0, 13, 99};
  const SetValue id = strongest_material(o.reader->meta());
  std::vector<T> found(static_cast<size_t>(volume(box)), 1), expected = found;
  const Index3 stride = {1, nx, nx * ny};
  read_box<T>(
      *o.reader, level, box, [&](const std::vector<Label>& set) { return mapped ? map[id(set)] : id(set); }, 42, expected.data(), stride);
  REQUIRE(tc_read_box(o.grid.get(), level, box.lo.data(), box.hi.data(), type, found.data(), stride.data(), 42, mapped ? map.data() : nullptr,
                      static_cast<int64_t>(map.size()), 1 + static_cast<int>(o.random() % 3)) == TC_OK);
  REQUIRE(found == expected);
}

// What a call says that must fail.
std::string message_of(int status, int expected) {
  REQUIRE(status == expected);
  return tc_error();
}

}  // namespace

TEST_CASE("Boxes that reach outside are read in every type, at every level, with and without a map", "[api][threads]") {
  for (int axis = 0; axis < 3; ++axis) {
    Opened o(static_cast<uint64_t>(axis), axis);
    REQUIRE(tc_levels(o.grid.get()) == o.reader->levels());
    for (int level = 0; level < o.reader->levels(); ++level)
      for (const bool mapped : {false, true}) {
        expect_box<uint8_t>(o, level, TC_U8, mapped);
        expect_box<uint16_t>(o, level, TC_U16, mapped);
        expect_box<uint32_t>(o, level, TC_U32, mapped);
      }
  }
}

TEST_CASE("Every third cell is read as from the box", "[api]") {
  Opened o;
  const int64_t first[3] = {-3, 1, 2}, count[3] = {6, 4, 5}, step[3] = {3, 5, 1}, stride[3] = {1, 6, 24};
  std::vector<uint8_t> found(120), expected(120);
  read_lattice<uint8_t>(*o.reader, 0, {{-3, 1, 2}, {6, 4, 5}, {3, 5, 1}}, strongest_material(o.reader->meta()), 9, expected.data(), {1, 6, 24});
  REQUIRE(tc_read_lattice(o.grid.get(), 0, first, count, step, TC_U8, found.data(), stride, 9, nullptr, 0, 1) == TC_OK);
  CHECK(found == expected);
  const int64_t none[3] = {0, 1, 1};
  CHECK_THAT(message_of(tc_read_lattice(o.grid.get(), 0, first, count, none, TC_U8, found.data(), stride, 9, nullptr, 0, 1), TC_USAGE),
             Catch::Contains("steps above 0"));
}

TEST_CASE("Runs cover the part of a box that lies in the grid, once, with all their materials", "[api]") {
  Opened o;
  for (int level = 0; level < o.reader->levels(); ++level) {
    const Box box = o.random_box(level), inside = o.inside(box, level);
    struct Seen {
      int64_t cells = 0;
      bool wrong = false;
      int axis;
      const Opened& o;
      int level;
    } seen{0, false, tc_ray_axis(o.grid.get()), o, level};
    REQUIRE(tc_runs(
                o.grid.get(), level, box.lo.data(), box.hi.data(),
                [](void* user, const tc_run* run) {
                  Seen& s = *static_cast<Seen*>(user);
                  s.cells += run->length;
                  Box one{{run->start[0], run->start[1], run->start[2]}, {run->start[0] + 1, run->start[1] + 1, run->start[2] + 1}};
                  one.hi[s.axis] = run->start[s.axis] + run->length;
                  std::vector<uint32_t> values(static_cast<size_t>(run->length));
                  const auto mask = [](const std::vector<Label>& set) { return static_cast<uint32_t>(mask_of(set)); };
                  const Index3 line = {1, 1, 1};
                  read_box<uint32_t>(*s.o.reader, s.level, one, mask, 0, values.data(), line);
                  uint32_t expected = 0;
                  for (uint32_t i = 0; i < run->count; ++i) expected |= 1u << run->materials[i];
                  for (const uint32_t v : values) s.wrong = s.wrong || v != expected;
                  s.wrong = s.wrong || run->material != static_cast<uint32_t>(31 - __builtin_clz(expected));  // the last is the strongest
                  return 0;
                },
                &seen) == TC_OK);
    CHECK(seen.cells == volume(inside));
    CHECK_FALSE(seen.wrong);
  }
  const int64_t lo[3] = {0, 0, 0}, hi[3] = {3, 3, 3};
  CHECK(tc_runs(
            o.grid.get(), 0, lo, hi, [](void*, const tc_run*) { return 1; }, nullptr) == TC_STOPPED);
}

TEST_CASE("Columns, counts and uniform boxes are those of the reader", "[api]") {
  Opened o;
  const Index3 n = o.axes.cells();
  for (int axis = 0; axis < 3; ++axis) {
    const RayFrame f = RayFrame::along(axis);
    const std::vector<ColumnRun> expected = read_column(*o.reader, axis, n[f.u] / 2, n[f.v] / 3);
    std::vector<tc_column_run> runs(expected.size());
    int64_t count = 0;
    REQUIRE(tc_column(o.grid.get(), axis, n[f.u] / 2, n[f.v] / 3, INT64_MIN, INT64_MAX, runs.data(), sizeof runs[0], 1, &count) == TC_OK);
    CHECK(count == static_cast<int64_t>(expected.size()));
    REQUIRE(tc_column(o.grid.get(), axis, n[f.u] / 2, n[f.v] / 3, 0, n[axis], runs.data(), sizeof runs[0], count, &count) == TC_OK);
    for (size_t i = 0; i < expected.size(); ++i)
      CHECK((runs[i].from == expected[i].from && runs[i].to == expected[i].to && runs[i].material == expected[i].material));
  }
  for (int i = 0; i < 20; ++i) {
    const Box box = o.random_box(0), inside = o.inside(box, 0);
    std::vector<tc_cells> found(5);
    REQUIRE(tc_stats(o.grid.get(), box.lo.data(), box.hi.data(), found.data(), sizeof found[0], 5) == TC_OK);
    const auto expected = read_stats(*o.reader, inside);
    for (size_t m = 0; m < 5; ++m) {
      CHECK((found[m].cells == static_cast<uint64_t>(expected[m].cells) && found[m].cells_high == 0 && found[m].volume == expected[m].volume));
      CHECK((std::ranges::equal(found[m].lo, expected[m].box.lo) && std::ranges::equal(found[m].hi, expected[m].box.hi)));
    }
    if (inside.empty()) continue;
    int uniform = -1;
    uint32_t material = 77;
    REQUIRE(tc_uniform(o.grid.get(), 0, box.lo.data(), box.hi.data(), &uniform, &material) == TC_OK);
    const auto kinds = std::ranges::count_if(expected, [](const CellStats& m) { return m.cells > 0; });
    CHECK(uniform == (kinds == 1));
    CHECK((uniform ? expected[material].cells > 0 : material == 77));
  }
  const int64_t lo[3] = {1, 1, 1}, hi[3] = {2, 2, 2};
  int uniform = 0;
  uint32_t material = 0;
  REQUIRE(tc_uniform(o.grid.get(), 0, lo, hi, &uniform, &material) == TC_OK);
  CHECK((uniform == 1 && material == o.cells[static_cast<size_t>((1 * n[1] + 1) * n[0] + 1)]));
}

TEST_CASE("Planes, sample points, materials and information are those of the grid", "[api]") {
  const Opened o;
  for (int level = 0; level < o.reader->levels(); ++level) {
    int64_t n[3];
    REQUIRE(tc_shape(o.grid.get(), level, n) == TC_OK);
    CHECK(std::ranges::equal(n, o.axes.cells(level)));
    for (int axis = 0; axis < 3; ++axis) {
      const Axis& a = o.axes.axis[axis];
      std::vector<double> planes(static_cast<size_t>(n[axis] + 1)), samples(static_cast<size_t>(n[axis]));
      REQUIRE(tc_planes(o.grid.get(), level, axis, 0, n[axis] + 1, planes.data()) == TC_OK);
      REQUIRE(tc_samples(o.grid.get(), level, axis, 0, n[axis], samples.data()) == TC_OK);
      for (int64_t i = 0; i <= n[axis]; ++i) CHECK(planes[static_cast<size_t>(i)] == a.plane(std::min(a.cells(), i << level)));
      for (int64_t i = 0; i < n[axis]; ++i) {
        const int64_t last = std::min(a.cells(), (i + 1) << level) - 1;
        CHECK(samples[static_cast<size_t>(i)] == Approx((a.centre(i << level) + a.centre(last)) / 2).margin(1e-12));
        if (level == 0) CHECK(samples[static_cast<size_t>(i)] == a.centre(i));
      }
    }
  }
  REQUIRE(tc_material_count(o.grid.get()) == 5);
  tc_material materials[5];
  REQUIRE(tc_materials(o.grid.get(), 0, 5, materials, sizeof materials[0]) == TC_OK);
  for (int i = 0; i < 5; ++i) {
    const MaterialInfo& m = o.reader->meta().materials[static_cast<size_t>(i)];
    CHECK((m.name == materials[i].name && m.rank == materials[i].rank));
  }
  const char* json = nullptr;
  REQUIRE(tc_info(o.grid.get(), &json) == TC_OK);
  CHECK(json == info_json(*o.reader));
  CHECK(std::string(tc_units(o.grid.get())) == o.reader->meta().units);
  CHECK(std::string(tc_hash(o.grid.get())) == o.reader->hash());
  CHECK(std::string(tc_version()).starts_with("0."));
}

TEST_CASE("Wrong arguments are refused with a message, before anything is written", "[api]") {
  Opened o;
  tc_grid* g = o.grid.get();
  const int64_t lo[3] = {0, 0, 0}, hi[3] = {2, 2, 2}, far[3] = {INT64_MAX, 2, 2}, stride[3] = {1, 2, 4};
  std::vector<uint8_t> out(8, 55);
  const auto read = [&](int level, const int64_t* a, const int64_t* b, int type, uint32_t outside, const uint32_t* map, int64_t size, int threads) {
    return message_of(tc_read_box(g, level, a, b, type, out.data(), stride, outside, map, size, threads), TC_USAGE);
  };
  const uint32_t map[5] = {0, 1, 256, 3, 4};
  CHECK_THAT(read(99, lo, hi, TC_U8, 0, nullptr, 0, 1), Catch::Contains("level") && Catch::Contains("99"));
  CHECK_THAT(read(0, lo, far, TC_U8, 0, nullptr, 0, 1), Catch::Contains("hi") && Catch::Contains("2^53"));
  CHECK_THAT(read(0, nullptr, hi, TC_U8, 0, nullptr, 0, 1), Catch::Contains("NULL"));
  CHECK_THAT(read(0, lo, hi, TC_U8, 256, nullptr, 0, 1), Catch::Contains("outside") && Catch::Contains("255"));
  CHECK_THAT(read(0, lo, hi, TC_U8, 0, map, 5, 1), Catch::Contains("material 'm2'") && Catch::Contains("256"));
  CHECK_THAT(read(0, lo, hi, TC_U16, 0, map, 4, 1), Catch::Contains("5 materials, found 4"));
  for (const int type : {0, 3, 8, -1}) CHECK_THAT(read(0, lo, hi, type, 0, nullptr, 0, 1), Catch::Contains("type: expected TC_U8"));
  CHECK_THAT(read(0, lo, hi, TC_U8, 0, nullptr, 0, -1), Catch::Contains("threads"));
  const int64_t everywhere[3] = {1, 0, 4};
  CHECK_THAT(message_of(tc_read_box(g, 0, lo, hi, TC_U8, out.data(), everywhere, 0, nullptr, 0, 1), TC_USAGE),
             Catch::Contains("strides other than 0"));
  CHECK(out == std::vector<uint8_t>(8, 55));
  double value = 0;
  CHECK_THAT(message_of(tc_planes(g, 0, 3, 0, 1, &value), TC_USAGE), Catch::Contains("axis"));
  CHECK_THAT(message_of(tc_samples(g, 0, 0, 0, INT64_MAX, &value), TC_USAGE), Catch::Contains("cells"));
  CHECK_THAT(message_of(tc_samples(g, 0, 0, INT64_MIN, 1, &value), TC_USAGE), Catch::Contains("cells"));
  tc_cells few[4];
  CHECK_THAT(message_of(tc_stats(g, lo, hi, few, sizeof few[0], 4), TC_USAGE), Catch::Contains("5"));
  CHECK_THAT(message_of(tc_materials(g, 3, 3, nullptr, sizeof(tc_material)), TC_USAGE), Catch::Contains("0 to 5"));
  int64_t count = 0;
  CHECK_THAT(message_of(tc_column(g, 0, 1000, 0, 0, 9, nullptr, sizeof(tc_column_run), 0, &count), TC_USAGE), Catch::Contains("outside the grid"));
  CHECK(message_of(tc_shape(nullptr, 0, nullptr), TC_USAGE) != "");
}

// A program whose header has larger structures than the library finds 0 in what the library does not know; smaller ones never were.
TEST_CASE("Structures are written in the size that the caller has", "[api]") {
  Opened o;
  struct Larger {
    tc_cells known;
    uint64_t later;
  };
  std::vector<Larger> larger(5);
  std::memset(larger.data(), 0xee, sizeof larger[0] * larger.size());
  std::vector<tc_cells> found(5);
  const int64_t lo[3] = {0, 0, 0}, hi[3] = {20, 20, 20};
  REQUIRE(tc_stats(o.grid.get(), lo, hi, found.data(), sizeof found[0], 5) == TC_OK);
  REQUIRE(tc_stats(o.grid.get(), lo, hi, &larger[0].known, sizeof larger[0], 5) == TC_OK);
  for (size_t i = 0; i < 5; ++i) CHECK((std::memcmp(&larger[i].known, &found[i], sizeof found[i]) == 0 && larger[i].later == 0));
  for (const size_t size : {size_t{0}, sizeof found[0] - 1, SIZE_MAX})
    CHECK_THAT(message_of(tc_stats(o.grid.get(), lo, hi, found.data(), size, 5), TC_USAGE), Catch::Contains("sizeof(tc_cells)"));
}

TEST_CASE("A grid that has two owners lives until both have closed it", "[api]") {
  Opened o;
  tc_grid* const second = tc_share(o.grid.get());
  CHECK(second == o.grid.get());
  o.grid.reset();
  int64_t n[3];
  CHECK(tc_shape(second, 0, n) == TC_OK);
  tc_close(second);
  CHECK(tc_share(nullptr) == nullptr);
}

TEST_CASE("Files that are not there, are no grid or are damaged are errors of their kinds", "[api]") {
  Opened o;
  tc_grid* grid = nullptr;
  CHECK_THAT(message_of(tc_open((o.folder / "none.tcell").c_str(), &grid), TC_IO), Catch::Contains("none.tcell"));
  CHECK(tc_errno() == ENOENT);
  CHECK(grid == nullptr);
  write_bytes(o.folder / "short.tcell", Bytes(100, 7));
  CHECK(tc_open((o.folder / "short.tcell").c_str(), &grid) == TC_FORMAT);
  CHECK(tc_errno() == 0);
  Bytes bytes = file_bytes(o.folder / "g.tcell");
  for (size_t i = 40; i < 600; ++i) bytes[i] ^= 0x55;  // chunks
  write_bytes(o.folder / "bad.tcell", bytes);
  const Handle bad = opened(o.folder / "bad.tcell");
  const int64_t lo[3] = {0, 0, 0}, hi[3] = {30, 30, 30}, stride[3] = {1, 30, 900};
  std::vector<uint8_t> out(27000);
  CHECK_THAT(message_of(tc_read_box(bad.get(), 0, lo, hi, TC_U8, out.data(), stride, 0, nullptr, 0, 2), TC_FORMAT), Catch::Contains("bad.tcell"));
  tc_close(nullptr);
}

TEST_CASE("What lies outside is filled by many threads, part by part, and can be stopped between parts", "[api][threads]") {
  Opened o;
  const int64_t n = 300, stride[3] = {n, 1, n * n};  // 27 million cells
  for (const auto& [from, size] : {std::pair<int64_t, int64_t>(1000, n), {-n / 2, n}}) {
    const int64_t lo[3] = {from, from, from}, hi[3] = {from + size, from + size, from + size};
    for (const int threads : {1, 3}) {
      std::vector<uint8_t> out(static_cast<size_t>(n * n * n), 1), expected(out.size(), 77);
      if (from < 0)
        read_box<uint8_t>(*o.reader, 0, {{from, from, from}, {hi[0], hi[1], hi[2]}}, strongest_material(o.reader->meta()), 77, expected.data(),
                          {n, 1, n * n});
      REQUIRE(tc_read_box(o.grid.get(), 0, lo, hi, TC_U8, out.data(), stride, 77, nullptr, 0, threads) == TC_OK);
      CHECK(out == expected);
      int asked = 0;
      tc_watch({[](void* user) { return ++*static_cast<int*>(user) > 2 ? 1 : 0; }, &asked});
      CHECK(tc_read_box(o.grid.get(), 0, lo, hi, TC_U8, out.data(), stride, 77, nullptr, 0, threads) == TC_STOPPED);
      tc_watch({nullptr, nullptr});
      CHECK(asked == 3);
    }
  }
}

TEST_CASE("A function of the caller stops what takes too long, in its own thread alone", "[api]") {
  Opened o;
  const int64_t lo[3] = {0, 0, 0}, hi[3] = {30, 30, 30}, stride[3] = {1, 30, 900};
  std::vector<uint8_t> out(27000);
  int asked = 0;
  const tc_watcher impatient{[](void* user) { return ++*static_cast<int*>(user) > 3 ? 1 : 0; }, &asked};
  CHECK(tc_watch(impatient).watch == nullptr);
  for (const int threads : {1, 2}) {
    asked = 0;
    CHECK(tc_read_box(o.grid.get(), 0, lo, hi, TC_U8, out.data(), stride, 0, nullptr, 0, threads) == TC_STOPPED);
    CHECK(asked == 4);
  }
  std::thread([&] { CHECK(tc_read_box(o.grid.get(), 0, lo, hi, TC_U8, out.data(), stride, 0, nullptr, 0, 1) == TC_OK); }).join();
  CHECK(tc_watch({[](void* user) {  // a call from the watcher is refused, and what it sets is for later calls
                    int64_t n[3];
                    tc_watch({nullptr, nullptr});
                    return tc_shape(static_cast<tc_grid*>(user), 0, n) == TC_USAGE ? 1 : 0;
                  },
                  o.grid.get()})
            .user == &asked);
  CHECK(tc_read_box(o.grid.get(), 0, lo, hi, TC_U8, out.data(), stride, 0, nullptr, 0, 1) == TC_STOPPED);
  CHECK(tc_read_box(o.grid.get(), 0, lo, hi, TC_U8, out.data(), stride, 0, nullptr, 0, 1) == TC_OK);
}
