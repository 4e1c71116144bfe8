// Zarr v3: a client that knows only the documents reads every cell of every level.
#include "tests/support/served_cells.hpp"

namespace teracell::server {

using namespace testing;
namespace {

using nlohmann::ordered_json;

// Reads the cells of an array as its document says. The padding must be the background.
std::vector<uint32_t> read_array(ServedCells& served, const std::string& array) {
  const ordered_json j = served.json(array + "/zarr.json");
  REQUIRE(j["zarr_format"] == 3);
  REQUIRE(j["node_type"] == "array");
  REQUIRE(j["fill_value"] == 0);
  REQUIRE(j["chunk_key_encoding"]["name"] == "default");
  REQUIRE(j["codecs"][0]["name"] == "bytes");
  REQUIRE(j["codecs"][1]["name"] == "gzip");
  REQUIRE(j["dimension_names"] == ordered_json::array({"z", "y", "x"}));
  const size_t width = j["data_type"] == "uint16" ? 2 : 1;
  if (width == 2) REQUIRE(j["codecs"][0]["configuration"]["endian"] == "little");
  const auto n = j["shape"].get<std::vector<int64_t>>(), c = j["chunk_grid"]["configuration"]["chunk_shape"].get<std::vector<int64_t>>();
  return joined_blocks(n, c, [&](int64_t kz, int64_t ky, int64_t kx) {
    const Response r = served.get(fmt::format("{}/c/{}/{}/{}", array, kz, ky, kx));
    REQUIRE(r.status == 200);
    REQUIRE(r.content_encoding.empty());
    return ids_of(inflated(*r.body, static_cast<size_t>(c[0] * c[1] * c[2]) * width), width);
  });
}

TEST_CASE("Zarr v3: every cell of every level, as an image and as labels of it, whatever the ray axis", "[server]") {
  for (int ray_axis = 0; ray_axis < 3; ++ray_axis) {
    ServedCells served(odd_grid(), ray_axis, 7);
    const ordered_json scales = served.json("/zarr/g/zarr.json")["attributes"]["ome"]["multiscales"][0]["datasets"];
    REQUIRE(scales.size() == 3);  // the last listed level is a single block; further ones exist
    for (int level = 0; level < 9; ++level) {
      const auto expected = served.materials(level);
      const std::string path = std::to_string(level);
      if (level < 3) REQUIRE(scales[static_cast<size_t>(level)]["path"] == path);
      REQUIRE((read_array(served, "/zarr/g/" + path) == expected));
      if (ray_axis == 0) REQUIRE((read_array(served, "/zarr/g/labels/material/" + path) == expected));
    }
  }
}

TEST_CASE("Zarr v3: ids above 255 take two bytes, little endian", "[server]") {
  ServedCells served(odd_grid(), 1, 9, 253);  // ids up to 261
  for (int level = 0; level < 9; ++level) {
    const auto expected = served.materials(level);
    REQUIRE(*std::ranges::max_element(expected) > 256);
    REQUIRE((read_array(served, fmt::format("/zarr/g/{}", level)) == expected));
  }
  ServedCells narrow(odd_grid(), 1, 9, 247);  // 256 materials with the background
  REQUIRE(narrow.json("/zarr/g/0/zarr.json")["data_type"] == "uint8");
  REQUIRE((read_array(narrow, "/zarr/g/0") == narrow.materials(0)));
}

TEST_CASE("Zarr v3: OME-Zarr gives the centre of each level's first cell, so that the levels coincide", "[server]") {
  ServedCells served(odd_grid(), 2, 3);
  const ordered_json ome = served.json("/zarr/g/zarr.json")["attributes"]["ome"];
  REQUIRE(ome["version"] == "0.5");
  const ordered_json& scales = ome["multiscales"][0];
  REQUIRE(scales["name"] == "g");
  for (size_t i = 0; i < 3; ++i)
    REQUIRE(scales["axes"][i] == ordered_json{{"name", std::string(1, "zyx"[i])}, {"type", "space"}, {"unit", "millimeter"}});
  for (int level = 0; level < 3; ++level)
    for (int axis = 0; axis < 3; ++axis) {
      const ordered_json& to_space = scales["datasets"][static_cast<size_t>(level)]["coordinateTransformations"];
      REQUIRE(to_space[0]["type"] == "scale");
      REQUIRE(to_space[1]["type"] == "translation");
      const double width = 0.1 * (1 << level), first = to_space[1]["translation"][static_cast<size_t>(2 - axis)];
      REQUIRE(to_space[0]["scale"][static_cast<size_t>(2 - axis)] == Approx(width));
      REQUIRE(first == Approx(odd_grid().axis[static_cast<size_t>(axis)].plane(0) + width / 2));
      if (level == 0) REQUIRE(first == odd_grid().axis[static_cast<size_t>(axis)].centre(0));
    }
}

TEST_CASE("Zarr v3: sample points that are not centres shift all levels by the same distance", "[server]") {
  Grid grid = odd_grid();
  grid.axis[0] = Axis::uniform(-3, 0.1, 5, 70, 0);
  ServedCells served(grid, 2, 3);
  const ordered_json scales = served.json("/zarr/g/zarr.json")["attributes"]["ome"]["multiscales"][0]["datasets"];
  for (int level = 0; level < 3; ++level) {
    const ordered_json& to_space = scales[static_cast<size_t>(level)]["coordinateTransformations"];
    // The lower face of a level's first voxel.
    REQUIRE(to_space[1]["translation"][2].get<double>() - to_space[0]["scale"][2].get<double>() / 2 == Approx(-2.5 - 0.05));
  }
}

TEST_CASE("Zarr v3: a grid with a graded axis is in index space, and the documents say so", "[server]") {
  ServedCells served(graded_grid(), 2, 3);
  const ordered_json attributes = served.json("/zarr/g/zarr.json")["attributes"];
  REQUIRE(attributes["teracell"] == ordered_json{{"units", "mm"}, {"space", "index"}});
  const ordered_json& scales = attributes["ome"]["multiscales"][0];
  REQUIRE_FALSE(scales["axes"][0].contains("unit"));
  const ordered_json& second = scales["datasets"][1]["coordinateTransformations"];
  REQUIRE(second[0]["scale"] == ordered_json::array({2.0, 2.0, 2.0}));
  REQUIRE(second[1]["translation"] == ordered_json::array({0.5, 0.5, 0.5}));
  REQUIRE((read_array(served, "/zarr/g/0") == served.materials(0)));
}

TEST_CASE("Zarr v3: the consolidated metadata equals that of all nodes", "[server]") {
  ServedCells served(odd_grid(), 2, 3);
  const ordered_json all = served.json("/zarr/g/zarr.json")["consolidated_metadata"]["metadata"];
  REQUIRE(all.size() == 9 + 2 + 9);
  for (const auto& [path, document] : all.items()) REQUIRE(document == served.json("/zarr/g/" + path + "/zarr.json"));
  REQUIRE(all["labels"]["attributes"]["ome"]["labels"] == ordered_json::array({"material"}));
}

TEST_CASE("Zarr v3: labels have names and colours", "[server]") {
  ServedCells served(odd_grid(), 2, 3);
  const ordered_json label = served.json("/zarr/g/labels/material/zarr.json")["attributes"]["ome"]["image-label"];
  REQUIRE(label["properties"].size() == 3);
  REQUIRE(label["properties"][2] == ordered_json{{"label-value", 2}, {"name", "m2"}});
  REQUIRE(label["colors"][2]["rgba"] == ordered_json(*parse_color(served.meta().materials[2].color)));
  REQUIRE(label["colors"][0]["rgba"][3] == 0);
}

TEST_CASE("Zarr v3: what is not there is a 404 without a body", "[server]") {
  ServedCells served(odd_grid(), 2, 3);
  require_missing(served, {"/zarr/g/.zattrs",
                           "/zarr/g/.zarray",
                           "/zarr/g/.zgroup",
                           "/zarr/g/0/.zarray",
                           "/zarr/g",
                           "/zarr/g/",
                           "/zarr",
                           "/zarr/",
                           "/zarr/other/zarr.json",
                           "/zarr/g/9/zarr.json",
                           "/zarr/g/00/zarr.json",
                           "/zarr/g/-1/zarr.json",
                           "/zarr/g/0/c/2/0/0",
                           "/zarr/g/0/c/0/3/0",
                           "/zarr/g/0/c/0/0/2",
                           "/zarr/g/0/c/-1/0/0",
                           "/zarr/g/0/c/0/0",
                           "/zarr/g/0/c/0/0/0/0",
                           "/zarr/g/0/c/0/0/00",
                           "/zarr/g/0/c/0/0/",
                           "/zarr/g/0/d/0/0/0",
                           "/zarr/g/1/c/0/1/1",
                           "/zarr/g/9/c/0/0/0",
                           "/zarr/g/0/c/0/0/999999999999999999",
                           "/zarr/g/0/c/0/0/99999999999999999999",
                           "/zarr/g/labels/other/zarr.json",
                           "/zarr/g/labels/material/9/zarr.json",
                           "/zarr/g/labels/0/c/0/0/0",
                           "/zarr/../g/zarr.json",
                           "/zarr/g/zarr.json?v=0123"});
}

}  // namespace
}  // namespace teracell::server
