// Zarr v2 as OME-Zarr: every cell of every level.
#include "tests/support/zarr2_arrays.hpp"

namespace teracell::server {

using namespace testing;
namespace {

using nlohmann::ordered_json;

TEST_CASE("Zarr v2: every cell of every level", "[server]") {
  for (const uint32_t shift : {0u, 253u}) {
    ServedCells served(odd_grid(), 0, 7, shift);
    const ordered_json scales = served.json("/zarr2/g/.zattrs")["multiscales"][0];
    REQUIRE(scales["version"] == "0.4");
    REQUIRE(scales["datasets"].size() == 3);
    for (int level = 0; level < 9; ++level) {
      if (level < 3) REQUIRE(scales["datasets"][static_cast<size_t>(level)]["path"] == std::to_string(level));
      REQUIRE((read_zarr2_labels(served, fmt::format("/zarr2/g/{}", level)) == served.materials(level)));
    }
  }
}

TEST_CASE("Zarr v2: the consolidated document holds all others", "[server]") {
  ServedCells served(odd_grid(), 2, 3);
  const ordered_json all = served.json("/zarr2/g/.zmetadata")["metadata"];
  REQUIRE(all.size() == 2 + 9 * 2);
  for (const auto& [path, document] : all.items()) REQUIRE(document == served.json("/zarr2/g/" + path));
  REQUIRE(all["0/.zarray"]["fill_value"] == 0);
}

TEST_CASE("Zarr v2: what is not there is a 404 without a body", "[server]") {
  ServedCells served(odd_grid(), 2, 3);
  require_missing(served, {"/zarr2", "/zarr2/g", "/zarr2/g/zarr.json", "/zarr2/g/9/.zarray", "/zarr2/other/.zgroup", "/zarr2/g/0/2/0/0",
                           "/zarr2/g/0/0/3/0", "/zarr2/g/0/0/0/2", "/zarr2/g/0/0/0", "/zarr2/g/0/0/0/0/0", "/zarr2/g/0/0/0/+0", "/zarr2/g/0/0.0.0"});
}

}  // namespace
}  // namespace teracell::server
