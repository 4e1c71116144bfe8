// Zarr v2 for xarray: every cell of every level, and where it lies.
#include "tests/support/zarr2_arrays.hpp"

namespace teracell::server {

using namespace testing;
namespace {

using nlohmann::ordered_json;

std::vector<double> read_coordinates(ServedCells& served, const std::string& array) {
  const ordered_json j = served.json(array + "/.zarray");
  REQUIRE(j["dtype"] == "<f8");
  REQUIRE(j["fill_value"].is_null());
  const auto n = j["shape"][0].get<size_t>(), c = j["chunks"][0].get<size_t>();
  std::vector<double> out;
  for (size_t k = 0; k * c < n; ++k) {
    const std::string bytes = zarr2_chunk(served, array, j, std::to_string(k), 8);
    for (size_t i = 0; i < c && out.size() < n; ++i) {
      uint64_t bits = 0;
      for (size_t b = 0; b < 8; ++b) bits |= uint64_t{static_cast<uint8_t>(bytes[8 * i + b])} << (8 * b);
      out.push_back(std::bit_cast<double>(bits));
    }
  }
  return out;
}

TEST_CASE("xarray: every cell of every level", "[server]") {
  for (const uint32_t shift : {0u, 253u}) {
    ServedCells served(odd_grid(), 0, 7, shift);
    for (int level = 0; level < 9; ++level) REQUIRE((read_zarr2_labels(served, fmt::format("/xarray/g/{}/label", level)) == served.materials(level)));
  }
}

TEST_CASE("xarray: the coordinates are the sample points of the cells to the last bit, and above level 0 the middles of the cells", "[server]") {
  for (const Grid& grid : {odd_grid(), graded_grid()}) {
    ServedCells served(grid, 2, 3);
    for (int level = 0; level < 9; ++level)
      for (int axis = 0; axis < 3; ++axis) {
        const Axis& a = grid.axis[static_cast<size_t>(axis)];
        std::vector<double> expected;
        for (int64_t i = 0; i < grid.cells(level)[static_cast<size_t>(axis)]; ++i)
          expected.push_back(level == 0 ? a.centre(i) : (a.plane(i << level) + a.plane(std::min(a.cells(), (i + 1) << level))) / 2);
        REQUIRE(read_coordinates(served, fmt::format("/xarray/g/{}/{}", level, axis_name(axis))) == expected);
      }
  }
}

TEST_CASE("xarray: a long axis has its coordinates in several chunks", "[server]") {
  const Axis one = Axis::uniform(0, 1, 0, 1, 0.5), length = Axis::uniform(7, 0.25, 0, 70000, 0.5);
  ServedCells served({{length, one, one}}, 0, 2);
  const auto x = read_coordinates(served, "/xarray/g/0/x");
  REQUIRE(x.size() == 70000);
  for (int64_t i = 0; i < 70000; ++i)
    if (x[static_cast<size_t>(i)] != length.centre(i)) FAIL("cell " << i);
  require_missing(served.get("/xarray/g/0/x/2"));
  require_missing(served.get("/xarray/g/0/y/1"));
}

TEST_CASE("xarray: a level has dimensions, no fill value, and the consolidated documents", "[server]") {
  ServedCells served(odd_grid(), 2, 3);
  for (const int level : {0, 3, 8}) {
    const std::string group = fmt::format("/xarray/g/{}/", level);
    const ordered_json all = served.json(group + ".zmetadata");
    REQUIRE(all["zarr_consolidated_format"] == 1);
    REQUIRE(all["metadata"].size() == 2 + 4 * 2);
    for (const auto& [path, document] : all["metadata"].items()) REQUIRE(document == served.json(group + path));
    REQUIRE(all["metadata"][".zgroup"] == ordered_json{{"zarr_format", 2}});
    REQUIRE(all["metadata"]["label/.zarray"]["fill_value"].is_null());
    REQUIRE(all["metadata"]["label/.zattrs"]["_ARRAY_DIMENSIONS"] == ordered_json::array({"z", "y", "x"}));
    REQUIRE(all["metadata"]["label/.zattrs"]["materials"] == ordered_json::array({"m0", "m1", "m2"}));
    REQUIRE(all["metadata"]["y/.zattrs"] == ordered_json{{"_ARRAY_DIMENSIONS", ordered_json::array({"y"})}, {"units", "mm"}});
  }
}

TEST_CASE("xarray: what is not there is a 404 without a body", "[server]") {
  ServedCells served(odd_grid(), 2, 3);
  require_missing(served,
                  {"/xarray", "/xarray/g", "/xarray/g/.zgroup", "/xarray/g/9/.zgroup", "/xarray/g/0/.zarray", "/xarray/g/0/label/2/0/0",
                   "/xarray/g/0/label/0/0", "/xarray/g/0/x/1", "/xarray/g/0/w/0", "/xarray/g/0/x/-0", "/xarray/g/0/label/0", "/xarray/g/x/.zarray"});
}

}  // namespace
}  // namespace teracell::server
