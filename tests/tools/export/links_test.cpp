// Links as records of a NumPy array.
#include "store/channels/link_reader.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"
#include "tools/export/formats.hpp"

namespace teracell::exports {
namespace {

using namespace testing;

TEST_CASE("Records of links have both materials, cells and places", "[export]") {
  const TempFolder folder;
  mesh_quietly(scene_of(folder, {{shapes::sphere({9, 9, 8}, 6.2, 2)}, {shapes::box({3, 3, 3}, {8.2, 8.3, 8.4}), oracle::Rule::kNonzero, 2}},
                        cube_grid_of(0, 1, 21)),
               folder / "g.tcell", {.links = true, .chunk_rays = 4});
  const GridReader reader(folder / "g.tcell");
  const std::vector<uint32_t> cells = all_cells(reader);
  const auto cell = [&](const Index3& c) { return cells[static_cast<size_t>((c[2] * 21 + c[1]) * 21 + c[0])]; };
  const Box box{{2, 3, 4}, {12, 21, 9}};
  std::vector<std::pair<int, CellLink>> expected;
  for (int d = 0; d < 3; ++d)
    LinkReader(reader).for_each(d, box, [&](std::span<const CellLink> found) {
      for (const CellLink& l : found) expected.push_back({d, l});
    });
  REQUIRE(expected.size() > 100);

  const ExportFormat& format = *export_format_named("links");
  format.write({reader, 0, box, folder / "l.npy", [](double) {}});
  const Bytes bytes = file_bytes(folder / "l.npy");
  ByteReader in(bytes, "npy");
  in.take(8);
  const auto header = in.take(in.fixed<uint16_t>());
  CHECK(std::string(header.begin(), header.end()).find("'shape': (" + std::to_string(expected.size()) + ", )") != std::string::npos);
  REQUIRE(in.remaining() == 32 * expected.size());
  for (const auto& [d, link] : expected) {
    Index3 upper = link.cell;
    ++upper[d];
    for (const int64_t i : link.cell) REQUIRE(in.fixed<int32_t>() == i);
    REQUIRE(in.fixed<uint32_t>() == static_cast<uint32_t>(d));
    REQUIRE(in.fixed<uint32_t>() == link.end);
    REQUIRE(in.fixed<uint32_t>() == link.begin);
    REQUIRE(in.fixed<int32_t>() == static_cast<int32_t>(link.patch));
    REQUIRE(in.fixed<uint16_t>() == cell(link.cell));
    REQUIRE(in.fixed<uint16_t>() == cell(upper));
  }
  CHECK_THROWS_WITH(format.write({reader, 1, {{0, 0, 0}, {2, 2, 2}}, folder / "coarse.npy", [](double) {}}), Catch::Contains("level 0, found 1"));
  CHECK_FALSE(std::filesystem::exists(folder / "coarse.npy"));
}

}  // namespace
}  // namespace teracell::exports
