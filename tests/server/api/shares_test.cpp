// Shares of materials over HTTP: in arrays of Zarr, and of a cell.
#include "store/channels/fraction_reader.hpp"
#include "tests/server/served.hpp"
#include "tests/support/served_cells.hpp"

namespace teracell::server {

using namespace testing;
namespace {

// A sphere and a box in a grid of 70 x 40 x 67 cells.
struct ServedShares {
  TempFolder folder;
  std::unique_ptr<server::Service> service;
  std::unique_ptr<GridReader> reader;
  explicit ServedShares(bool with_fractions = true, bool by_body = false) {
    const Grid space = unit_grid({70, 40, 67});
    mesher::MeshOptions options{.axis = 0};
    if (with_fractions) options.fractions = Subdivision{2, 4, 2};
    const std::vector<oracle::Body> bodies = {{shapes::sphere({30, 20, 30}, 13.3, 3), oracle::Rule::kNonzero, 1},
                                              {shapes::box({28.2, 10.6, 21.9}, {69.1, 30.4, 60.2}), oracle::Rule::kNonzero, 2}};
    mesher::Scene scene = scene_of(folder, bodies, space);
    if (by_body) scene.label_by = mesher::LabelBy::kBody;
    scene.materials[1].color = "#ff0000", scene.materials[2].color = "#0000ff";
    scene.materials[2].name = "a/b";  // no segment of a path
    mesh_quietly(scene, folder / "g.tcell", options);
    service = std::make_unique<server::Service>(server::ServiceOptions{.named = {folder.path()}});
    reader = std::make_unique<GridReader>(folder / "g.tcell");
  }
  Response get(const std::string& target) const { return handle(*service, {.target = target}); }
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
  const char* names[] = {"m0", "m1", "id-2"};  // by id where the name can't be a segment
  for (uint32_t material = 0; material < 3; ++material) {
    const std::string array = fmt::format("fraction/{}", names[material]);
    const json document = s.parsed("/zarr/g/" + array + "/zarr.json");
    REQUIRE(document == all[array]);
    REQUIRE(document["data_type"] == "float32");
    REQUIRE(document["attributes"]["teracell"] == json({{"material", material}, {"name", s.reader->meta().materials[material].name}}));
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

// The members of each cell of a tile that was asked for with sets=1, row v = 0 first.
std::vector<std::vector<uint32_t>> members_of(const std::string& tile, size_t cells) {
  size_t at = 0;
  const auto next = [&] {
    REQUIRE(at + 2 <= tile.size());
    const uint32_t out = static_cast<uint8_t>(tile[at]) | static_cast<uint32_t>(static_cast<uint8_t>(tile[at + 1])) << 8;
    at += 2;
    return out;
  };
  std::vector<std::vector<uint32_t>> sets(next());
  REQUIRE(next() == 0);
  for (auto& set : sets) {
    set.resize(next());
    for (uint32_t& m : set) m = next();
  }
  const bool wide = sets.size() > 256;
  REQUIRE(tile.size() == at + cells * (wide ? 2 : 1));
  std::vector<std::vector<uint32_t>> out;
  for (size_t i = 0; i < cells; ++i) {
    if (wide) out.push_back(sets.at(next()));
    else out.push_back(sets.at(static_cast<uint8_t>(tile[at++])));
  }
  return out;
}

TEST_CASE("Slices show mixed cells by their shares, in tiles and in pictures, along all axes", "[server][fractions]") {
  const bool by_body = GENERATE(false, true);
  const ServedShares s(true, by_body);
  const FractionReader fractions(*s.reader);
  const Index3 n = s.reader->meta().grid.cells();
  const std::vector<uint32_t> cells = all_cells(*s.reader);
  const std::array<int64_t, 3> slice = {30, 20, 35};
  for (const int axis : {0, 1, 2}) {
    const RayFrame f = RayFrame::along(axis);
    const auto count = static_cast<size_t>(n[f.u] * n[f.v]);
    const std::string address = fmt::format("/api/v1/grids/g/tile/{}/{}/0/0_0", axis_name(axis), slice[static_cast<size_t>(axis)]);
    for (const char* bodies : by_body ? std::vector{"", "&bodies=1"} : std::vector{""}) {
      const auto plain = members_of(*s.get(address + ".bin?sets=1" + bodies).body, count);
      const auto shaded = members_of(*s.get(address + ".bin?sets=1&shares=1" + bodies).body, count);
      size_t mixed = 0;
      for (size_t i = 0; i < count; ++i) {
        Index3 c;
        c[f.w] = slice[static_cast<size_t>(axis)], c[f.u] = static_cast<int64_t>(i) % n[f.u], c[f.v] = static_cast<int64_t>(i) / n[f.u];
        std::map<uint32_t, double> share;
        for (const auto& [label, found] : fractions.cell(c)) share[*bodies ? label : s.reader->meta().labels[label].material] += found / 16.0;
        const uint32_t own = plain[i].at(0);
        if (share.size() < 2) {
          REQUIRE(shaded[i] == plain[i]);
          continue;
        }
        ++mixed;
        REQUIRE(shaded[i].size() == 16);
        REQUIRE(shaded[i][0] == own);
        double off = 0;
        for (const auto& [member, expected] : share)
          off = std::max(off, std::abs(static_cast<double>(std::ranges::count(shaded[i], member)) / 16 - expected));
        REQUIRE(off == 0);  // 16 sub-samples make 16 parts
        if (!*bodies) REQUIRE(own == cells[static_cast<size_t>((c[2] * n[1] + c[1]) * n[0] + c[0])]);
      }
      REQUIRE(mixed > 25);
    }
    const std::string png = *s.get(address + ".png").body;
    CHECK(*s.get(address + ".png?shares=0").body == png);
    CHECK(*s.get(address + ".png?shares=1").body != png);
    CHECK(*s.get(address + ".png?shares=1&outline=1").body != *s.get(address + ".png?shares=1").body);
  }
  CHECK(*s.get("/api/v1/grids/g/tile/z/9/1/0_0.bin?sets=1&shares=1").body == *s.get("/api/v1/grids/g/tile/z/9/1/0_0.bin?sets=1").body);
  CHECK(s.get("/api/v1/grids/g/tile/z/9/0/0_0.bin?shares=1").status == 400);
  CHECK(ServedShares(false).get("/api/v1/grids/g/slice/z/9.png?shares=1").status == 400);
}

TEST_CASE("A mixed cell says where the plane of its material lies", "[server][fractions]") {
  const ServedShares s;
  const json cell = s.parsed("/api/v1/grids/g/cell?i=16&j=20&k=30");  // the sphere's side towards -x
  REQUIRE(cell["shares"].size() == 2);
  const json& plane = cell["plane"];
  CHECK(plane["id"] == cell["materials"][0]["id"]);
  const double out = plane["id"] == 1 ? -1 : 1;
  CHECK(plane["normal"][0].get<double>() * out > 0.99);
  const auto n = plane["normal"].get<Vec3>();
  const double x = (plane["offset"].get<double>() - n[1] * 20.5 - n[2] * 30.5) / n[0];  // where it crosses the cell's middle
  CHECK(std::abs(x - 16.75) < 0.3);  // of two sub-samples along x
  CHECK_FALSE(s.parsed("/api/v1/grids/g/cell?i=30&j=20&k=20").contains("plane"));
}

}  // namespace
}  // namespace teracell::server
