// Zarr v2, as OME-Zarr and for xarray: every cell of every level, and where it lies.
#include <algorithm>
#include <bit>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "tests/support/served_cells.hpp"

namespace teracell::testing {
namespace {

using nlohmann::ordered_json;

// A chunk, decoded as the array's document says.
std::string chunk_of(ServedCells& served, const std::string& array, const ordered_json& j, const std::string& key, size_t width) {
  REQUIRE(j["zarr_format"] == 2);
  REQUIRE(j["compressor"]["id"] == "zlib");
  REQUIRE(j["order"] == "C");
  REQUIRE(j["filters"].is_null());
  REQUIRE(j["dimension_separator"] == "/");
  size_t bytes = width;
  for (const auto& n : j["chunks"]) bytes *= n.get<size_t>();
  const Response r = served.get(array + "/" + key);
  REQUIRE(r.status == 200);
  return inflated(*r.body, bytes);
}

std::vector<uint32_t> read_labels(ServedCells& served, const std::string& array) {
  const ordered_json j = served.json(array + "/.zarray");
  const size_t width = j["dtype"] == "<u2" ? 2 : 1;
  REQUIRE((width == 2 || j["dtype"] == "|u1"));
  const auto n = j["shape"].get<std::vector<int64_t>>(), c = j["chunks"].get<std::vector<int64_t>>();
  std::vector<uint32_t> out(static_cast<size_t>(n[0] * n[1] * n[2]));
  bool padding = false;
  for (int64_t kz = 0; kz * c[0] < n[0]; ++kz)
    for (int64_t ky = 0; ky * c[1] < n[1]; ++ky)
      for (int64_t kx = 0; kx * c[2] < n[2]; ++kx) {
        const auto ids = ids_of(chunk_of(served, array, j, fmt::format("{}/{}/{}", kz, ky, kx), width), width);
        for (size_t i = 0; i < ids.size(); ++i) {
          const auto k = static_cast<int64_t>(i);
          const int64_t z = kz * c[0] + k / (c[1] * c[2]), y = ky * c[1] + k / c[2] % c[1], x = kx * c[2] + k % c[2];
          if (z < n[0] && y < n[1] && x < n[2]) out[static_cast<size_t>((z * n[1] + y) * n[2] + x)] = ids[i];
          else padding |= ids[i] != 0;
        }
      }
  REQUIRE_FALSE(padding);
  return out;
}

std::vector<double> read_coordinates(ServedCells& served, const std::string& array) {
  const ordered_json j = served.json(array + "/.zarray");
  REQUIRE(j["dtype"] == "<f8");
  REQUIRE(j["fill_value"].is_null());
  const auto n = j["shape"][0].get<size_t>(), c = j["chunks"][0].get<size_t>();
  std::vector<double> out;
  for (size_t k = 0; k * c < n; ++k) {
    const std::string bytes = chunk_of(served, array, j, std::to_string(k), 8);
    for (size_t i = 0; i < c && out.size() < n; ++i) {
      uint64_t bits = 0;
      for (size_t b = 0; b < 8; ++b) bits |= uint64_t{static_cast<uint8_t>(bytes[8 * i + b])} << (8 * b);
      out.push_back(std::bit_cast<double>(bits));
    }
  }
  return out;
}

TEST_CASE("Zarr v2: every cell of every level, for all clients and for xarray", "[server]") {
  for (const uint32_t shift : {0u, 253u}) {
    ServedCells served(odd_grid(), 0, 7, shift);
    const ordered_json scales = served.json("/zarr2/g/.zattrs")["multiscales"][0];
    REQUIRE(scales["version"] == "0.4");
    REQUIRE(scales["datasets"].size() == 3);
    for (int level = 0; level < 9; ++level) {
      const auto expected = served.materials(level);
      if (level < 3) REQUIRE(scales["datasets"][static_cast<size_t>(level)]["path"] == std::to_string(level));
      REQUIRE((read_labels(served, fmt::format("/zarr2/g/{}", level)) == expected));
      REQUIRE((read_labels(served, fmt::format("/xarray/g/{}/label", level)) == expected));
    }
  }
}

TEST_CASE("Zarr v2: the coordinates are the sample points of the cells to the last bit, and above level 0 the middles of the cells", "[server]") {
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

TEST_CASE("Zarr v2: a long axis has its coordinates in several chunks", "[server]") {
  const Axis one = Axis::uniform(0, 1, 0, 1, 0.5), length = Axis::uniform(7, 0.25, 0, 70000, 0.5);
  ServedCells served({{length, one, one}}, 0, 2);
  const auto x = read_coordinates(served, "/xarray/g/0/x");
  REQUIRE(x.size() == 70000);
  for (int64_t i = 0; i < 70000; ++i)
    if (x[static_cast<size_t>(i)] != length.centre(i)) FAIL("cell " << i);
  require_missing(served.get("/xarray/g/0/x/2"));
  require_missing(served.get("/xarray/g/0/y/1"));
}

TEST_CASE("Zarr v2: xarray finds dimensions, no fill value, and the consolidated documents", "[server]") {
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
  const ordered_json all = served.json("/zarr2/g/.zmetadata")["metadata"];
  REQUIRE(all.size() == 2 + 9 * 2);
  for (const auto& [path, document] : all.items()) REQUIRE(document == served.json("/zarr2/g/" + path));
  REQUIRE(all["0/.zarray"]["fill_value"] == 0);
}

TEST_CASE("Zarr v2: what is not there is a 404 without a body", "[server]") {
  ServedCells served(odd_grid(), 2, 3);
  for (const char* path : {"/zarr2",
                           "/zarr2/g",
                           "/zarr2/g/zarr.json",
                           "/zarr2/g/9/.zarray",
                           "/zarr2/other/.zgroup",
                           "/zarr2/g/0/2/0/0",
                           "/zarr2/g/0/0/3/0",
                           "/zarr2/g/0/0/0/2",
                           "/zarr2/g/0/0/0",
                           "/zarr2/g/0/0/0/0/0",
                           "/zarr2/g/0/0/0/+0",
                           "/zarr2/g/0/0.0.0",
                           "/xarray",
                           "/xarray/g",
                           "/xarray/g/.zgroup",
                           "/xarray/g/9/.zgroup",
                           "/xarray/g/0/.zarray",
                           "/xarray/g/0/label/2/0/0",
                           "/xarray/g/0/label/0/0",
                           "/xarray/g/0/x/1",
                           "/xarray/g/0/w/0",
                           "/xarray/g/0/x/-0",
                           "/xarray/g/0/label/0",
                           "/xarray/g/x/.zarray"}) {
    INFO(path);
    require_missing(served.get(path));
  }
}

}  // namespace
}  // namespace teracell::testing
