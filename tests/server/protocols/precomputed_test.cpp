// Neuroglancer precomputed: every block of every size on every level, smaller at the edges.
#include "store/read/slice.hpp"
#include "tests/support/served_cells.hpp"

namespace teracell::server {

using namespace testing;
namespace {

using nlohmann::ordered_json;

// All blocks of one size hold the cells of the level and no further byte.
void check_blocks(ServedCells& served, const ordered_json& scale, const Index3& block, size_t width, const std::vector<uint32_t>& expected) {
  const Index3 n = scale["size"];
  std::vector<uint32_t> found(expected.size(), ~0u);
  for (int64_t z = 0; z < n[2]; z += block[2])
    for (int64_t y = 0; y < n[1]; y += block[1])
      for (int64_t x = 0; x < n[0]; x += block[0]) {
        const Index3 hi = {std::min(x + block[0], n[0]), std::min(y + block[1], n[1]), std::min(z + block[2], n[2])};
        const Response r =
            served.get(fmt::format("/precomputed/g/{}/{}-{}_{}-{}_{}-{}", scale["key"].get<std::string>(), x, hi[0], y, hi[1], z, hi[2]));
        REQUIRE(r.status == 200);
        REQUIRE(r.body->size() == static_cast<size_t>((hi[0] - x) * (hi[1] - y) * (hi[2] - z)) * width);
        const auto ids = ids_of(*r.body, width);
        size_t i = 0;
        for (int64_t k = z; k < hi[2]; ++k)
          for (int64_t j = y; j < hi[1]; ++j)
            for (int64_t l = x; l < hi[0]; ++l) found[static_cast<size_t>((k * n[1] + j) * n[0] + l)] = ids[i++];
      }
  REQUIRE((found == expected));
}

void check_all(ServedCells& served) {
  const ordered_json info = served.json("/precomputed/g/info");
  REQUIRE(info["@type"] == "neuroglancer_multiscale_volume");
  REQUIRE(info["type"] == "segmentation");
  REQUIRE(info["num_channels"] == 1);
  const size_t width = info["data_type"] == "uint16" ? 2 : 1;
  REQUIRE((width == 2) == (served.meta().materials.size() > 256));
  REQUIRE(info["scales"].size() == static_cast<size_t>(served.meta().grid.levels()));
  for (int level = 0; level < served.meta().grid.levels(); ++level) {
    const ordered_json& scale = info["scales"][static_cast<size_t>(level)];
    REQUIRE(scale["encoding"] == "raw");
    REQUIRE(scale["size"] == served.meta().grid.cells(level));
    REQUIRE(scale["voxel_offset"] == Index3{0, 0, 0});
    REQUIRE(scale["chunk_sizes"].size() == 3);
    for (const auto& block : scale["chunk_sizes"]) check_blocks(served, scale, block, width, served.materials(level));
  }
}

TEST_CASE("Precomputed: every cell of every level in blocks of every size, smaller at the edges", "[server]") {
  ServedCells narrow(odd_grid(), 2, 7);
  check_all(narrow);
  ServedCells wide(unit_grid({300, 9, 270}), 0, 9, 253);  // several blocks on a side, two bytes per id
  check_all(wide);
}

TEST_CASE("Precomputed: the resolution is a cell in nanometres, twice as wide on each level", "[server]") {
  ServedCells served(odd_grid(), 2, 3);
  const ordered_json info = served.json("/precomputed/g/info");
  REQUIRE(info["scales"][0]["resolution"] == std::vector<double>{100000, 100000, 100000});
  REQUIRE(info["scales"][3]["resolution"] == std::vector<double>{800000, 800000, 800000});
  REQUIRE(info["teracell"]["space"] == "physical");
  ServedCells graded(graded_grid(), 2, 3);
  const ordered_json other = graded.json("/precomputed/g/info");
  REQUIRE(other["scales"][0]["resolution"] == std::vector<double>{1, 1, 1});
  REQUIRE(other["scales"][3]["resolution"] == std::vector<double>{8, 8, 8});
  REQUIRE(other["teracell"]["space"] == "index");
}

TEST_CASE("Precomputed: segments have the materials' names and volumes; volumes of graded grids would take too long", "[server]") {
  ServedCells served(odd_grid(), 2, 4);
  const ordered_json j = served.json("/precomputed/g/" + served.json("/precomputed/g/info")["segment_properties"].get<std::string>() + "/info");
  REQUIRE(j["@type"] == "neuroglancer_segment_properties");
  REQUIRE(j["inline"]["ids"] == ordered_json::array({"1", "2", "3"}));
  REQUIRE(j["inline"]["properties"][0] == ordered_json{{"id", "label"}, {"type", "label"}, {"values", {"m1", "m2", "m3"}}});
  REQUIRE(j["inline"]["properties"][1]["id"] == "volume_mm3");
  const auto cells = served.materials(0);
  for (uint32_t m = 1; m < 4; ++m)
    REQUIRE(j["inline"]["properties"][1]["values"][m - 1] == Approx(0.001 * static_cast<double>(std::ranges::count(cells, m))));
  ServedCells graded(graded_grid(), 2, 4);
  REQUIRE(graded.json("/precomputed/g/segprops/info")["inline"]["properties"].size() == 1);
}

TEST_CASE("Precomputed: what is not there is a 404 without a body", "[server]") {
  ServedCells served(odd_grid(), 2, 3);
  REQUIRE(served.get("/precomputed/g/s0/0-70_0-130_66-67").status == 200);
  require_missing(served, {"/precomputed",
                           "/precomputed/g",
                           "/precomputed/other/info",
                           "/precomputed/g/info/",
                           "/precomputed/g/s9/0-1_0-1_0-1",
                           "/precomputed/g/0/0-70_0-130_66-67",
                           "/precomputed/g/s0/0-70_0-130_67-68",
                           "/precomputed/g/s0/0-256_0-256_0-1",
                           "/precomputed/g/s0/0-70_0-130_0-2",
                           "/precomputed/g/s0/0-70_0-129_0-1",
                           "/precomputed/g/s0/1-70_0-130_0-1",
                           "/precomputed/g/s0/00-70_0-130_0-1",
                           "/precomputed/g/s0/0-70_0-130",
                           "/precomputed/g/s0/0-70_0-130_0",
                           "/precomputed/g/s0/",
                           "/precomputed/g/s0/70-70_0-130_0-1",
                           "/precomputed/g/s0/0-70-70_0-130_0-1",
                           "/precomputed/g/s/0-70_0-130_0-1",
                           "/precomputed/g/manifest.ocdbt",
                           "/precomputed/g/segprops",
                           "/precomputed/g/s0/0-70_0-130_0-1_0-1",
                           "/precomputed/g/s0/0-70_0-130_999999999999999999-1000000000000000000"});
}

}  // namespace
}  // namespace teracell::server
