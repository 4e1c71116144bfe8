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
  std::vector<uint32_t> out(static_cast<size_t>(n[0] * n[1] * n[2]));
  bool padding = false;
  for (int64_t kz = 0; kz * c[0] < n[0]; ++kz)
    for (int64_t ky = 0; ky * c[1] < n[1]; ++ky)
      for (int64_t kx = 0; kx * c[2] < n[2]; ++kx) {
        const auto ids = ids_of(zarr2_chunk(served, array, j, fmt::format("{}/{}/{}", kz, ky, kx), width), width);
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

}  // namespace teracell::testing
