// The rows of slices against the cells one by one.
#include "store/read/slice.hpp"

#include "tests/support/checked.hpp"

namespace teracell {
namespace {

using namespace testing;

TEST_CASE("Slices of random cells in many small chunks are the cells, for any part, order, threads and memory") {
  for_random_cells([](Checked&& checked) { checked.slices(); });
}

TEST_CASE("An exception of the sink ends the slice, whatever the threads") {
  std::mt19937_64 random(21);
  const GridReader reader = reader_of(with_tiny_chunks(metadata_of(cube_grid_of(0, 1, 40), 2, 3)), random_cells(random, {40, 40, 40}, 3));
  for (int slice = 0; slice < 3; ++slice)
    for (const int threads : {1, 3}) {
      int rows = 0;
      const auto run = [&] {
        for_each_row(reader, whole_slice(reader.meta(), slice, 7, 0), strongest_material(reader.meta()), true, threads,
                     [&](int64_t, std::span<const uint16_t>) {
                       if (++rows == 9) throw IoError("full disk");
                     });
      };
      REQUIRE_THROWS_AS(run(), IoError);
      REQUIRE(rows == 9);
    }
}

TEST_CASE("Levels, indices and regions of slices out of range are usage errors that name the range") {
  const GridReader reader = reader_of(metadata_of(unit_grid({8, 9, 10}), 2, 2), std::vector<Label>(720, 1));
  const Metadata& meta = reader.meta();
  REQUIRE(reader.levels() == 5);
  for (const int level : {-1, 5, 31, 1000}) REQUIRE_THROWS_WITH(whole_slice(meta, 2, 0, level), Catch::Contains("0 to 4"));
  for (const int64_t index : {int64_t{-1}, int64_t{10}, std::numeric_limits<int64_t>::max()})
    REQUIRE_THROWS_WITH(whole_slice(meta, 2, index, 0), Catch::Contains("0 to 9"));
  REQUIRE_THROWS_WITH(whole_slice(meta, 0, 4, 1), Catch::Contains("0 to 3"));
  const SliceView whole = whole_slice(meta, 2, 0, 0);
  for (const auto& edit : std::initializer_list<void (*)(SliceView&)>{[](SliceView& v) { v.u0 = -1; }, [](SliceView& v) { v.u1 = 9; },
                                                                      [](SliceView& v) { v.v0 = 9; }, [](SliceView& v) { v.v1 = 10; },
                                                                      [](SliceView& v) { v.u0 = 5, v.u1 = 5; }, [](SliceView& v) { v.index = 10; }}) {
    SliceView view = whole;
    edit(view);
    REQUIRE_THROWS_AS(for_each_row(reader, view, strongest_material(meta), true, 1, [](int64_t, std::span<const uint16_t>) {}), UsageError);
  }
}

}  // namespace
}  // namespace teracell
