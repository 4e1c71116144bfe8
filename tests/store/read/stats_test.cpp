// Statistics of boxes against counting cells.
#include "store/read/stats.hpp"

#include "tests/support/checked.hpp"
#include "tests/support/small_files.hpp"

namespace teracell {
namespace {

using namespace testing;

TEST_CASE("The statistics of any box of random cells in many small chunks are those of its cells") {
  for_random_cells([](Checked&& checked) { checked.stats(); });
}

TEST_CASE("The box of some labels is that of their cells, and empty where there are none") {
  for (int seed = 0; seed < 40; ++seed) {
    std::mt19937_64 random(static_cast<uint64_t>(seed));
    const Grid grid = random_grid(random, 30);
    const Index3 n = grid.cells();
    std::vector<Label> cells(static_cast<size_t>(n[0] * n[1] * n[2]));
    for (int i = 0; i < 6; ++i) cells[random() % cells.size()] = static_cast<Label>(1 + i / 2);
    std::vector<bool> labels(5);
    for (size_t i = 1; i < 5; ++i) labels[i] = random() % 2 == 0;
    Box expected;
    for (size_t i = 0; i < cells.size(); ++i) {
      if (!labels[cells[i]]) continue;
      const auto at = static_cast<int64_t>(i);
      const Index3 cell = {at % n[0], at / n[0] % n[1], at / (n[0] * n[1])};
      if (expected.empty()) expected = {n, {0, 0, 0}};
      for (size_t d = 0; d < 3; ++d) expected.lo[d] = std::min(expected.lo[d], cell[d]), expected.hi[d] = std::max(expected.hi[d], cell[d] + 1);
    }
    const Bytes file = stored_cells(with_tiny_chunks(metadata_of(grid, seed % 3, 5)), cells);
    INFO("seed " << seed);
    for (const Bytes& f : {file, without_amounts(file)}) {
      const Box found = read_box_of(reader_of(f), labels);
      CHECK(found.empty() == expected.empty());
      if (!expected.empty()) CHECK(found == expected);
    }
  }
}

TEST_CASE("What the metadata tell of the whole grid is what the index adds up to, and takes no index page to read") {
  for (int seed = 0; seed < 20; ++seed) {
    std::mt19937_64 random(static_cast<uint64_t>(seed));
    const Grid grid = random_grid(random, 20);
    std::vector<Label> cells(static_cast<size_t>(grid.cells()[0] * grid.cells()[1] * grid.cells()[2]));
    for (int i = 0; i < 9; ++i) cells[random() % cells.size()] = static_cast<Label>(i / 3);
    const Bytes file = stored_cells(with_tiny_chunks(metadata_of(grid, seed % 3, 4)), cells);
    const GridReader told = reader_of(file), counted = reader_of(without_amounts(file));
    REQUIRE(told.meta().amounts.size() == 4);
    REQUIRE(counted.meta().amounts.empty());
    const auto a = read_label_stats(told, grid.box(0)), b = read_label_stats(counted, grid.box(0));
    INFO("seed " << seed);
    for (size_t l = 0; l < 4; ++l) {
      CHECK(a[l].cells == b[l].cells);
      CHECK(a[l].volume == b[l].volume);
      CHECK(a[l].box == b[l].box);
      CHECK(told.meta().amounts[l] == LabelAmount{b[l].cells, b[l].box});
    }
  }
  const Bytes broken = forge(chunked_file(), {.page = [](int, std::vector<ChunkEntry>& entries) { entries[0].offset = ~uint64_t{0} >> 1; }});
  CHECK_NOTHROW(read_stats(reader_of(broken), reader_of(broken).meta().grid.box(0)));
  CHECK_THROWS_AS(read_stats(reader_of(without_amounts(broken)), reader_of(broken).meta().grid.box(0)), FormatError);
}

TEST_CASE("A material without cells has no volume and an empty box; an empty region has no cells") {
  const GridReader reader = reader_of(metadata_of(cube_grid_of(0, 1, 4), 0, 3), std::vector<Label>(64, 1));
  const auto stats = read_stats(reader, {{0, 0, 0}, {4, 4, 4}});
  REQUIRE(stats[1].volume == 64);
  REQUIRE((stats[2].cells == 0 && stats[2].volume == 0 && stats[2].box.empty()));
  for (const CellStats& s : read_stats(reader, {{2, 2, 2}, {2, 3, 3}})) REQUIRE((s.cells == 0 && s.box.empty()));
}

TEST_CASE("Statistics that reach out of their chunk are refused before any coordinate is looked up") {
  const GridReader reader = reader_of(without_amounts(forge(chunked_file(), {.page = [](int, std::vector<ChunkEntry>& entries) {
                                                              for (ChunkEntry& e : entries)
                                                                for (LabelStats& s : e.stats) s.hi[2] += 1000;
                                                            }})));
  REQUIRE_THROWS_WITH(read_stats(reader, reader.meta().grid.box(0)), Catch::Contains("its statistics reach outside of it"));
}

}  // namespace
}  // namespace teracell
