// Shares of materials over HTTP: in arrays of Zarr, and of a cell.
#include <catch2/catch.hpp>

#include <fmt/format.h>

#include "store/fraction_reader.hpp"
#include "tests/server/served.hpp"
#include "tests/support/served_cells.hpp"

namespace teracell::testing {
namespace {

// A sphere and a box in a grid of 70 x 40 x 67 cells.
struct ServedShares {
  TempFolder folder;
  std::unique_ptr<Service> service;
  std::unique_ptr<GridReader> reader;
  explicit ServedShares(bool with_fractions = true) {
    const Grid space{{Axis::uniform(0, 1, 0, 70, 0.5), Axis::uniform(0, 1, 0, 40, 0.5), Axis::uniform(0, 1, 0, 67, 0.5)}};
    MeshOptions options;
    options.axis = 0;
    if (with_fractions) options.fractions = Subdivision{2, 4, 2};
    const std::vector<oracle::Body> bodies = {{shapes::sphere({30, 20, 30}, 13.3, 3), oracle::Rule::kNonzero, 1},
                                              {shapes::box({28.2, 10.6, 21.9}, {69.1, 30.4, 60.2}), oracle::Rule::kNonzero, 2}};
    Scene scene = scene_of(folder, bodies, space);
    scene.materials[2].name = "a/b";  // no segment of a path
    mesh_quietly(scene, folder / "g.tcell", options);
    ServiceOptions served;
    served.named = {folder.path()};
    service = std::make_unique<Service>(served);
    reader = std::make_unique<GridReader>(folder / "g.tcell");
  }
  Response get(const std::string& target) const {
    Request r;
    r.target = target;
    return handle(*service, r);
  }
  json parsed(const std::string& target) const {
    const Response r = get(target);
    REQUIRE(r.status == 200);
    return json::parse(*r.body);
  }
};

TEST_CASE("Zarr v3 has the shares of each material as float32, padded with 0", "[server][fractions]") {
  const ServedShares s;
  const json all = s.parsed("/zarr/g/zarr.json")["consolidated_metadata"]["metadata"];
  const FractionReader fractions(*s.reader);
  const Index3 n = s.reader->meta().grid.cells();
  const char* names[] = {"m0", "m1", "2"};  // by number where the name can't be one
  for (uint32_t material = 0; material < 3; ++material) {
    const std::string array = fmt::format("fraction/{}", names[material]);
    const json document = s.parsed("/zarr/g/" + array + "/zarr.json");
    REQUIRE(document == all[array]);
    REQUIRE(document["data_type"] == "float32");
    REQUIRE(document["codecs"][0]["configuration"]["endian"] == "little");
    REQUIRE(document["shape"] == json::array({67, 40, 70}));
    std::vector<float> expected(static_cast<size_t>(n[0] * n[1] * n[2]));
    fractions.read_box<float>({{0, 0, 0}, n}, material, 0, expected.data(), {1, n[0], n[0] * n[1]});
    for (int64_t kz = 0; kz < 2; ++kz)
      for (int64_t kx = 0; kx < 2; ++kx) {
        const std::string bytes = inflated(*s.get(fmt::format("/zarr/g/{}/c/{}/0/{}", array, kz, kx)).body, size_t{64} * 64 * 64 * 4);
        size_t differ = 0;
        for (int64_t i = 0; i < 64 * 64 * 64; ++i) {
          const int64_t x = kx * 64 + i % 64, y = i / 64 % 64, z = kz * 64 + i / 4096;
          float found = 0;
          std::memcpy(&found, bytes.data() + 4 * i, 4);
          const bool inside = x < n[0] && y < n[1] && z < n[2];
          differ += found != (inside ? expected[static_cast<size_t>((z * n[1] + y) * n[0] + x)] : 0);
        }
        REQUIRE(differ == 0);
      }
  }
  for (const char* none : {"fraction/m9/zarr.json", "fraction/m1/c/0/0/9", "fraction/m1/c/0/0", "fraction/a/b/zarr.json"})
    require_missing(s.get(std::string("/zarr/g/") + none));
  require_missing(ServedShares(false).get("/zarr/g/fraction/m1/zarr.json"));
}

TEST_CASE("A cell says what it is made of", "[server][fractions]") {
  const ServedShares s;
  const FractionReader fractions(*s.reader);
  size_t mixed = 0;
  for (int64_t x = 10; x < 50; ++x) {
    const json shares = s.parsed(fmt::format("/api/v1/grids/g/cell?i={}&j=20&k=30", x))["shares"];
    double sum = 0;
    for (const json& share : shares) {
      double expected = 0;
      fractions.read_box<double>({{x, 20, 30}, {x + 1, 21, 31}}, share["id"], 0, &expected, {1, 1, 1});
      REQUIRE(share["share"] == expected);
      sum += expected;
    }
    REQUIRE(sum == 1);
    mixed += shares.size() > 1;
  }
  REQUIRE(mixed > 0);
  CHECK_FALSE(s.parsed("/api/v1/grids/g/cell?i=5&j=5&k=5&level=1").contains("shares"));
  CHECK_FALSE(ServedShares(false).parsed("/api/v1/grids/g/cell?i=5&j=5&k=5").contains("shares"));
}

}  // namespace
}  // namespace teracell::testing
