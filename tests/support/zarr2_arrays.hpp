// Arrays of Zarr v2, read as their own documents say.
#pragma once
#include "tests/support/served_cells.hpp"

namespace teracell::testing {

// A chunk, decoded as the array's document says.
inline std::string zarr2_chunk(ServedCells& served, const std::string& array, const nlohmann::ordered_json& j, const std::string& key, size_t width) {
  REQUIRE(j["zarr_format"] == 2);
  REQUIRE(j["compressor"]["id"] == "zlib");
  REQUIRE(j["order"] == "C");
  REQUIRE(j["filters"].is_null());
  REQUIRE(j["dimension_separator"] == "/");
  size_t bytes = width;
  for (const auto& n : j["chunks"]) bytes *= n.get<size_t>();
  const server::Response r = served.get(array + "/" + key);
  REQUIRE(r.status == 200);
  return inflated(*r.body, bytes);
}

// The labels of an array, C order [z][y][x]; what is beyond them must be 0.
inline std::vector<uint32_t> read_zarr2_labels(ServedCells& served, const std::string& array) {
  const nlohmann::ordered_json j = served.json(array + "/.zarray");
  const size_t width = j["dtype"] == "<u2" ? 2 : 1;
  REQUIRE((width == 2 || j["dtype"] == "|u1"));
  const auto n = j["shape"].get<std::vector<int64_t>>(), c = j["chunks"].get<std::vector<int64_t>>();
  return joined_blocks(n, c, [&](int64_t kz, int64_t ky, int64_t kx) {
    return ids_of(zarr2_chunk(served, array, j, fmt::format("{}/{}/{}", kz, ky, kx), width), width);
  });
}

}  // namespace teracell::testing
