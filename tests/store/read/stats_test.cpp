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

TEST_CASE("A material without cells has no volume and an empty box; an empty region has no cells") {
  const GridReader reader = reader_of(metadata_of(cube_grid_of(0, 1, 4), 0, 3), std::vector<Label>(64, 1));
  const auto stats = read_stats(reader, {{0, 0, 0}, {4, 4, 4}});
  REQUIRE(stats[1].volume == 64);
  REQUIRE((stats[2].cells == 0 && stats[2].volume == 0 && stats[2].box.empty()));
  for (const CellStats& s : read_stats(reader, {{2, 2, 2}, {2, 3, 3}})) REQUIRE((s.cells == 0 && s.box.empty()));
}

TEST_CASE("Statistics that reach out of their chunk are refused before any coordinate is looked up") {
  const GridReader reader = reader_of(forge(chunked_file(), {.page = [](int, std::vector<ChunkEntry>& entries) {
                                              for (ChunkEntry& e : entries)
                                                for (LabelStats& s : e.stats) s.hi[2] += 1000;
                                            }}));
  REQUIRE_THROWS_WITH(read_stats(reader, reader.meta().grid.box(0)), Catch::Contains("its statistics reach outside of it"));
}

}  // namespace
}  // namespace teracell
