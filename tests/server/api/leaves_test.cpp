// Leaves over HTTP, against their definition.
#include <thread>

#include "store/refine/leaf_levels.hpp"
#include "tests/server/served.hpp"
#include "tests/support/random.hpp"
#include "tests/support/refined.hpp"

namespace teracell::server {
namespace {

using namespace testing;

struct ServedBlobs {
  TempFolder folder;
  Metadata meta;
  std::vector<Label> cells;
  std::unique_ptr<server::Service> service;

  explicit ServedBlobs(int seed) {
    std::mt19937_64 random(static_cast<uint64_t>(seed));
    const Index3 n{random_int(random, 3, 60), random_int(random, 3, 60), random_int(random, 3, 60)};
    cells = blobs(random, n, 3);
    meta = metadata_of(unit_grid(n), seed % 3, 3);
    store_cells(folder / "g.tcell", meta, cells);
    service = std::make_unique<server::Service>(ServiceOptions{.named = {folder.path()}});
  }
  Response get(const std::string& target) const { return handle(*service, {.target = "/api/v1/grids/g/" + target}); }
};

// For each cell of a tile.
std::string levels_by_definition(const std::vector<Leaf>& leaves, const SliceView& view) {
  const RayFrame f = RayFrame::along(view.axis);
  std::string out;
  for (int64_t v = view.v0; v < view.v1; ++v)
    for (int64_t u = view.u0; u < view.u1; ++u) {
      const Box cell = f.box({u, v, view.index}, {u + 1, v + 1, view.index + 1});
      uint8_t level = 255;
      for (const Leaf& leaf : leaves) {
        bool holds = leaf.level >= view.level;
        for (size_t d = 0; d < 3; ++d) holds = holds && cell.lo[d] >> (leaf.level - view.level) == leaf.cell[d];
        if (holds) level = static_cast<uint8_t>(leaf.level);
      }
      out.push_back(static_cast<char>(level));
    }
  return out;
}

TEST_CASE("Tiles of leaves have the level of the leaf at each cell, for any order in which they are asked for", "[server]") {
  for (int seed = 0; seed < 9; ++seed) {
    const ServedBlobs s(seed);
    std::mt19937_64 random(static_cast<uint64_t>(seed));
    const int coarsest = static_cast<int>(random_int(random, 0, 6)), layers = static_cast<int>(random_int(random, 1, 3));
    const auto leaves = leaves_by_definition(s.meta, s.cells, {.coarsest = coarsest, .layers = layers}, s.meta.grid.box(0));
    for (int i = 0; i < 6; ++i) {
      const int axis = static_cast<int>(random_int(random, 0, 2)), level = static_cast<int>(random_int(random, 0, s.meta.grid.levels() - 1));
      const SliceView view = whole_slice(s.meta, axis, random_int(random, 0, s.meta.grid.cells(level)[axis] - 1), level);
      const std::string target = "leaves/" + std::string(axis_name(axis)) + "/" + std::to_string(view.index) + "/" + std::to_string(level) +
                                 "/0_0.bin?refine=" + std::to_string(coarsest) + "," + std::to_string(layers);
      INFO("seed " << seed << ": " << target);
      const Response r = s.get(target);
      REQUIRE(r.status == 200);
      REQUIRE(*r.body == levels_by_definition(leaves, view));
    }
  }
}

TEST_CASE("Leaves are counted by level and material, also of a region, and wishes count", "[server]") {
  const ServedBlobs s(4);
  const Index3 n = s.meta.grid.cells();
  const std::string region = "1,0,2," + std::to_string(n[0]) + "," + std::to_string(n[1] - 1) + "," + std::to_string(n[2]);
  for (const auto& [query, wants, box] : std::vector<std::tuple<std::string, std::string, Box>>{
           {"", "", s.meta.grid.box(0)},
           {"&region=" + region, "", {{1, 0, 2}, {n[0], n[1] - 1, n[2]}}},
           {"&want=interface=1,box:0,0,0,2,2,2=0", "interface=1,box:0,0,0,2,2,2=0", s.meta.grid.box(0)}}) {
    std::map<std::pair<int, std::string>, uint64_t> expected;
    const auto leaves = leaves_by_definition(s.meta, s.cells, parse_refinement(s.meta, 3, 1, wants), box);
    for (const Leaf& leaf : leaves) ++expected[{leaf.level, s.meta.materials[s.meta.labels[leaf.label].material].name}];
    const Response r = s.get("leaves.json?refine=3,1" + query);
    REQUIRE(r.status == 200);
    const json found = json::parse(*r.body);
    CHECK(found["total"] == leaves.size());
    REQUIRE(found["leaves"].size() == expected.size());
    for (const json& row : found["leaves"]) CHECK(expected.at({row["level"], row["material"]}) == row["leaves"]);
  }
}

TEST_CASE("Threads that ask for leaves at once get the same answers as one", "[server][threads]") {
  const ServedBlobs s(7), alone(7);
  std::vector<std::string> targets;
  for (int i = 0; i < 24; ++i)
    targets.push_back("leaves/" + std::string(axis_name(i % 3)) + "/" + std::to_string(i % 3) + "/0/0_0.bin?refine=" + std::to_string(5 + i % 2) +
                      ",1");
  targets.push_back("leaves.json?refine=5,1");
  std::vector<std::string> found(targets.size());
  {
    std::vector<std::jthread> threads;
    for (size_t t = 0; t < 3; ++t)
      threads.emplace_back([&, t] {
        for (size_t i = t; i < targets.size(); i += 3) found[i] = *s.get(targets[i]).body;
      });
  }
  for (size_t i = 0; i < targets.size(); ++i) CHECK(found[i] == *alone.get(targets[i]).body);
}

TEST_CASE("What makes no sense of leaves is refused in words", "[server]") {
  const ServedBlobs s(1);
  const auto error = [&](const std::string& target) {
    const Response r = s.get(target);
    CHECK(r.status == 400);
    return json::parse(*r.body)["error"]["message"].get<std::string>();
  };
  CHECK_THAT(error("leaves.json"), Catch::Contains("missing refine"));
  CHECK_THAT(error("leaves.json?refine=99,1"), Catch::Contains("refine") && Catch::Contains("99"));
  CHECK_THAT(error("leaves.json?refine=3,1&want=material:nobody=0"), Catch::Contains("nobody"));
  CHECK_THAT(error("leaves/z/0/0/0_0.bin?refine=3,1&sets=1"), Catch::Contains("sets"));
  CHECK(s.get("leaves/z/0/0/0_0.png?refine=3,1").status == 404);
  CHECK(s.get("leaves/z/0/0/9_0.bin?refine=3,1").status == 404);
}

}  // namespace
}  // namespace teracell::server
