// Grids that keep bodies apart: tiles, cells and statistics by body.
#include "tests/server/served.hpp"

namespace teracell::server {
namespace {

using namespace testing;

constexpr uint32_t kBodies = 6;  // labels but the background; bodies of odd labels are of material 1, the others of material 2

Metadata with_bodies(const Grid& grid, uint32_t bodies) {
  Metadata meta = metadata_of(grid, 2, 3);
  meta.labels.resize(1);
  for (uint32_t label = 1; label <= bodies; ++label) meta.labels.push_back({2 - label % 2, fmt::format("body {}", label)});
  return meta;
}

struct ServedBodies {
  TempFolder folder;
  std::vector<Label> cells;
  Metadata meta;
  std::unique_ptr<Service> service;

  ServedBodies(const Grid& grid, std::vector<Label> of_cells, uint32_t bodies) : cells(std::move(of_cells)), meta(with_bodies(grid, bodies)) {
    store_cells(folder / "g.tcell", meta, cells);
    service = std::make_unique<Service>(ServiceOptions{.named = {folder.path()}});
  }
  std::string get(const std::string& target) {
    const Response response = handle(*service, {.target = "/api/v1/grids/g/" + target});
    INFO(target);
    REQUIRE(response.status == 200);
    return *response.body;
  }
};

ServedBodies random_bodies() {
  std::mt19937_64 random(11);
  return {grid(), random_cells(random, kCells, kBodies + 1), kBodies};
}

unsigned u16(const std::string& bytes, size_t at) {
  return static_cast<unsigned>(static_cast<uint8_t>(bytes.at(at)) | static_cast<uint8_t>(bytes.at(at + 1)) << 8);
}

// A tile whose sets have numbers of two bytes, and perhaps more than 256 different sets.
struct Tile {
  unsigned flags = 0;
  std::vector<Mask> sets;
  std::vector<unsigned> cells;  // numbers of sets
};

Tile tile_of(const std::string& bytes) {
  Tile tile{u16(bytes, 2), {}, {}};
  size_t at = 4;
  for (unsigned i = u16(bytes, 0); i > 0; --i) {
    Mask mask = 0;
    for (unsigned m = 0; m < u16(bytes, at); ++m) mask |= Mask{1} << u16(bytes, at + 2 + 2 * m);
    at += 2 + 2 * u16(bytes, at);
    tile.sets.push_back(mask);
  }
  const size_t width = tile.sets.size() > 256 ? 2 : 1;
  for (; at < bytes.size(); at += width) tile.cells.push_back(width == 2 ? u16(bytes, at) : static_cast<uint8_t>(bytes[at]));
  return tile;
}

TEST_CASE("Tiles by body have the sets of labels of every level", "[server]") {
  ServedBodies s = random_bodies();
  for (int level = 0; level < s.meta.grid.levels(); ++level) {
    const auto sets = level_by_hand(s.meta.grid, s.cells, level);
    const Index3 n = s.meta.grid.cells(level);
    const Tile tile = tile_of(s.get(fmt::format("tile/z/{}/{}/0_0.bin?sets=1&bodies=1", n[2] / 2, level)));
    CHECK(tile.flags == 0);
    REQUIRE(tile.cells.size() == static_cast<size_t>(n[0] * std::min<int64_t>(n[1], 512)));
    bool same = true;
    for (size_t i = 0; i < tile.cells.size(); ++i) same &= tile.sets.at(tile.cells[i]) == sets[static_cast<size_t>(n[2] / 2 * n[1] * n[0]) + i];
    REQUIRE(same);
  }
}

TEST_CASE("Statistics and cells by body are those that are counted, and those by material stay as they are", "[server]") {
  ServedBodies s = random_bodies();
  const json j = json::parse(s.get("stats?region=3,100,5,20,400,9&bodies=1"));
  std::vector<uint64_t> counted(kBodies + 1);
  for (int64_t z = 5; z < 9; ++z)
    for (int64_t y = 100; y < 400; ++y)
      for (int64_t x = 3; x < 20; ++x) ++counted[s.cells[static_cast<size_t>((z * kCells[1] + y) * kCells[0] + x)]];
  REQUIRE(j["bodies"].size() == kBodies + 1);
  for (uint32_t label = 0; label <= kBodies; ++label) {
    const json& body = j["bodies"][label];
    CHECK(body["label"] == label);
    CHECK(body["name"] == (label == 0 ? "" : fmt::format("body {}", label)));
    CHECK(body["material"] == (label == 0 ? 0 : 2 - label % 2));
    CHECK(body["cells"] == counted[label]);
    CHECK(body["volume"].get<double>() == Approx(static_cast<double>(counted[label]) * 0.125));
  }
  CHECK(j["materials"][1]["cells"] == counted[1] + counted[3] + counted[5]);
  CHECK(j["materials"] == json::parse(s.get("stats?region=3,100,5,20,400,9"))["materials"]);

  const Label label = s.cells[static_cast<size_t>((7 * kCells[1] + 300) * kCells[0] + 11)];
  const json cell = json::parse(s.get("cell?i=11&j=300&k=7"));
  const uint32_t material = s.meta.labels[label].material;
  CHECK(cell["bodies"] == json::array({{{"label", label}, {"name", s.meta.labels[label].body}, {"material", material}}}));
}

TEST_CASE("Where a tile has more sets of bodies than can be numbered, the first body of each material stands for all of them", "[server]") {
  if (kSanitized) return;  // two million runs
  constexpr uint32_t kMany = 60;  // of eight cells below a cell there are nearly always eight different ones
  const Index3 n = {1024, 1024, 2};
  std::mt19937_64 random(12);
  std::vector<Label> cells(static_cast<size_t>(n[0] * n[1] * n[2]));
  for (Label& label : cells) label = static_cast<Label>(random_int(random, 0, kMany));
  const auto axis = [&](int d) { return Axis::uniform(0, 1, 0, n[d], 0.5); };
  ServedBodies s({{axis(0), axis(1), axis(2)}}, cells, kMany);
  const Tile tile = tile_of(s.get("tile/z/0/1/0_0.bin?sets=1&bodies=1"));
  CHECK(tile.flags == 2);
  bool same = true;
  for (size_t i = 0; i < tile.cells.size(); ++i) {
    Mask expected = 0;  // labels 0, 1 and 2 are the first of materials 0, 1 and 2
    for (size_t c = 0; c < 8; ++c) {
      const size_t x = 2 * (i % 512) + c % 2, y = 2 * (i / 512) + c / 2 % 2, z = c / 4;
      const Label label = cells[(z * 1024 + y) * 1024 + x];
      expected |= Mask{1} << (label == 0 ? 0 : 2 - label % 2);
    }
    same &= tile.sets.at(tile.cells[i]) == expected;
  }
  REQUIRE(same);
}

TEST_CASE("A grid that keeps materials has no bodies to tell of", "[server]") {
  Served s;
  for (const char* target : {"tile/z/0/0/0_0.bin?sets=1&bodies=1", "stats?bodies=1"}) {
    CHECK(s.get(std::string("/api/v1/grids/g/") + target).status == 400);
    CHECK(s.error(std::string("/api/v1/grids/g/") + target) == "bodies: grid 'g' keeps materials, not bodies");
  }
  CHECK(!s.parsed("/api/v1/grids/g/cell?i=0&j=0&k=0").contains("bodies"));
  ServedBodies apart = random_bodies();
  const Request request{.target = "/api/v1/grids/g/tile/z/0/0/0_0.bin?bodies=1"};
  CHECK(handle(*apart.service, request).status == 400);
}

}  // namespace
}  // namespace teracell::server
