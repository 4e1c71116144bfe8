// Differences of two grids over HTTP.
#include "tests/server/served.hpp"

namespace teracell::server {
namespace {

using namespace testing;

const std::string kTarget = "/api/v1/grids/g/diff?with=h";

// A second grid "h" beside "g": its materials 3 and 4 have other names, and its rays lie along `ray_axis`.
std::vector<Label> add_other(Served& s, int ray_axis, uint32_t seed, const Grid& of = grid()) {
  std::mt19937_64 random(seed);
  std::vector<Label> cells = s.cells;
  for (Label& label : cells)
    if (random() % 40 == 0) label = static_cast<Label>(random() % kMaterials);
  Metadata meta = metadata_of(of, ray_axis, kMaterials);
  meta.materials[3].name = "t\xc3\xb6n\"";
  meta.materials[4].name = meta.materials[1].name + "?";
  cells.resize(static_cast<size_t>(of.cells()[0] * of.cells()[1] * of.cells()[2]));
  store_cells(s.folder / "h.tcell", meta, cells);
  s.service->grids().look(true);
  return cells;
}

TEST_CASE("What differs is counted by pair of names, cell by cell, whatever the ray axes", "[server]") {
  for (const int ray_axis : {0, 1, 2}) {
    Served s;
    const std::vector<Label> other = add_other(s, ray_axis, 3);
    const auto name = [&](const char* id, Label label) { return s.service->grids().find(id)->meta().materials[label].name; };
    std::map<std::pair<std::string, std::string>, uint64_t> expected;
    uint64_t same = 0;
    for (size_t i = 0; i < other.size(); ++i) {
      const std::string from = name("g", s.cells[i]), to = name("h", other[i]);
      if (from == to) ++same;
      else ++expected[{from, to}];
    }
    const json found = s.parsed(kTarget);
    CHECK(found["cells"] == other.size());
    CHECK(found["same"] == same);
    REQUIRE(found["changes"].size() == expected.size());
    for (const json& change : found["changes"]) CHECK(change["cells"] == expected.at({change["from"], change["to"]}));
    // The nearest cell of a change, against a search through all cells.
    const Index3 n = grid().cells(), near = {n[0] / 2, n[1] / 2, n[2] / 2};
    const auto away = [&](const Index3& c) {
      return (c[0] - near[0]) * (c[0] - near[0]) + (c[1] - near[1]) * (c[1] - near[1]) + (c[2] - near[2]) * (c[2] - near[2]);
    };
    for (const bool in_slice : {false, true}) {
      std::optional<Index3> best;
      Index3 c;
      size_t i = 0;
      for (c[2] = 0; c[2] < n[2]; ++c[2])
        for (c[1] = 0; c[1] < n[1]; ++c[1])
          for (c[0] = 0; c[0] < n[0]; ++c[0], ++i)
            if (s.cells[i] == 1 && other[i] == 2 && (!in_slice || c[1] == near[1]) && (!best || away(c) < away(*best))) best = c;
      const auto name_of = [&](const char* id, Label label) { return percent_encoded(name(id, label)); };
      const json nearest =
          s.parsed(fmt::format("/api/v1/grids/g/changed?with=h&from={}&to={}&cell={},{},{}{}", name_of("g", 1), name_of("h", 2), near[0], near[1],
                               near[2], in_slice ? fmt::format("&region=0,{},0,37,{},21", near[1], near[1] + 1) : ""))["cell"];
      REQUIRE(nearest.is_null() == !best.has_value());
      if (best) CHECK(away(nearest.get<Index3>()) == away(*best));
    }
  }
}

TEST_CASE("A grid does not differ from itself", "[server]") {
  Served s;
  const json found = s.parsed("/api/v1/grids/g/diff?with=g");
  CHECK(found["same"] == found["cells"]);
  CHECK(found["changes"].empty());
}

TEST_CASE("Grids of unequal cells are refused in words", "[server]") {
  Served s;
  Grid shorter = grid();
  shorter.axis[1] = Axis::uniform(2, 0.25, 0, 500, 0.5);
  add_other(s, 2, 3, shorter);
  CHECK(s.get(kTarget).status == 400);
  CHECK(s.error(kTarget) ==
        "h.tcell: its cells are not those of g.tcell: expected 530 cells along y, found 500; only grids of equal cells can be compared");
  CHECK(s.error("/api/v1/grids/g/diff") == "missing with: expected the id of the grid to compare with, as /api/v1/grids lists it");
}

TEST_CASE("Differences are kept, and made anew when either grid is replaced", "[server]") {
  Served s;
  add_other(s, 2, 3);
  const Response first = s.get(kTarget);
  REQUIRE(first.status == 200);
  CHECK(first.cache_control == "no-cache");
  Request again{.target = kTarget};
  CHECK(s.service->is_cached(again));
  again.if_none_match = first.etag;
  CHECK(handle(*s.service, again).status == 304);
  std::filesystem::remove(s.folder / "h.tcell");
  s.service->grids().look(true);
  CHECK(s.get(kTarget).status == 404);
  add_other(s, 2, 4);
  const Response second = handle(*s.service, again);
  REQUIRE(second.status == 200);
  CHECK(second.etag != first.etag);
  CHECK(*second.body != *first.body);
}

}  // namespace
}  // namespace teracell::server
