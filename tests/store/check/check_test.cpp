// The document of what is found, and the sentences in it.
#include "store/check/check.hpp"

#include <sys/resource.h>

#include <numeric>

#include "store/base/error.hpp"
#include "store/check/check_json.hpp"
#include "store/check/kept.hpp"
#include "store/check/reported.hpp"
#include "tests/support/cube_grid.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

namespace teracell {
namespace {

using namespace testing;
using nlohmann::json;

// A plate two cells thick in the middle of the grid, a cell by itself, and air in a hollow cube.
struct CheckedScene {
  TempFolder folder;
  std::vector<Label> cells = std::vector<Label>(20 * 20 * 20);
  void box(const Index3& lo, const Index3& hi, Label label) {
    for (int64_t z = lo[2]; z < hi[2]; ++z)
      for (int64_t y = lo[1]; y < hi[1]; ++y)
        for (int64_t x = lo[0]; x < hi[0]; ++x) cells[static_cast<size_t>((z * 20 + y) * 20 + x)] = label;
  }
  CheckedScene() {
    box({2, 2, 2}, {18, 18, 4}, 1);
    box({1, 1, 8}, {2, 2, 9}, 1);
    box({5, 5, 6}, {12, 12, 13}, 2);
    box({8, 8, 9}, {9, 9, 10}, 0);
    box({0, 15, 15}, {3, 20, 20}, 2);
  }
};

TEST_CASE("What is found is said in sentences, with counts, places and boxes", "[check]") {
  for (const int axis : {0, 1, 2}) {
    CheckedScene scene;
    store_cells(scene.folder / "g.tcell", with_tiny_chunks(metadata_of(cube_grid(0, 2, 20), axis, 3)), scene.cells);
    const GridReader reader(scene.folder / "g.tcell");
    const json j = json::parse(findings_json(check(reader, {.threads = 2}, [](double) {})));
    CHECK(j["schema"] == 1);
    CHECK(j["grid_hash"] == reader.hash());
    std::vector<std::string> texts;
    for (const json& f : j["findings"])
      texts.push_back(f["level"].get<std::string>() + " " + f["kind"].get<std::string>() + ": " + f["text"].get<std::string>());
    CHECK(texts == std::vector<std::string>{
                       "warning island: 75 cells of 'm2' are connected to the rest of it through no face.",
                       "warning island: 1 cell of 'm1' is connected to the rest of it through no face.",
                       "note thin: A wall of 'm1' is 2 cells thick where it is thinnest: 512 cells are below 3.",
                       "note enclosed: 1 cell of 'm0' is enclosed: no way through faces leads to a side of the domain.",
                       "note cut: 'm2' reaches the side of the domain, with 43 cells.",
                   });
    const json& enclosed = j["findings"][3];
    CHECK(enclosed["cells"] == 1);
    CHECK(enclosed["box"] == json{8, 8, 9, 9, 9, 10});
    CHECK(enclosed["at"][2].get<double>() == Approx(0.95));
    CHECK(j["totals"]["island"] == json{{"findings", 2}, {"cells", 76}});
    REQUIRE(j["walls"].size() == 2);
    CHECK(j["walls"][0]["body"] == "m1");
    CHECK(j["walls"][0]["thinnest_cells"] == 1);
    CHECK(j["walls"][0]["histogram"] == json{1, 512, 0, 0, 0, 0, 0, 0});
    const auto cube = j["walls"][1]["histogram"].get<std::vector<int>>();
    CHECK(std::accumulate(cube.begin(), cube.end(), 0) == 7 * 7 * 7 - 1 + 3 * 5 * 5);
    CHECK(j["not_looked_at"][0].get<std::string>().find("no report of the mesher") != std::string::npos);
  }
}

TEST_CASE("Where the file keeps bodies apart, what is found is about bodies", "[check]") {
  CheckedScene scene;
  Metadata meta = metadata_of(cube_grid(0, 2, 20), 0, 3);
  meta.labels[1].body = "plate", meta.labels[2].body = "cube";
  store_cells(scene.folder / "g.tcell", meta, scene.cells);
  const Findings findings = check(GridReader(scene.folder / "g.tcell"), {}, [](double) {});
  const auto thin = std::ranges::find(findings.list, FindingKind::thin, &Finding::kind);
  REQUIRE(thin != findings.list.end());
  CHECK(thin->bodies == std::vector<std::string>{"plate"});
  CHECK(findings.walls[1].body == "cube");
}

TEST_CASE("Sheets have no walls, nor has a material that sheets alone have", "[check]") {
  const TempFolder folder;
  const shapes::Facets square = {{{Vec3{2, 2, 9.5}, Vec3{18, 2, 9.5}, Vec3{18, 18, 9.5}}}};
  const oracle::Body plate{.facets = shapes::box({2, 2, 4}, {18, 18, 6}), .material = 1}, sheet{.facets = square, .material = 2, .sheet = true};
  oracle::Body same = sheet;
  same.facets = shapes::translate(square, {0, 0, 5}), same.material = 1;
  const auto walls = [&](const std::vector<oracle::Body>& bodies, bool by_body) {
    mesher::Scene scene = scene_of(folder, bodies, cube_grid(0, 20, 20));
    scene.label_by = by_body ? mesher::LabelBy::kBody : mesher::LabelBy::kMaterial;
    mesh_quietly(scene, folder / "g.tcell");
    const Findings findings = check(GridReader(folder / "g.tcell"), {}, [](double) {});
    std::string out;
    for (const WallReport& wall : findings.walls) out += fmt::format("{} {} ", wall.body, *wall.thinnest);
    for (const Finding& f : findings.list)
      if (f.kind == FindingKind::thin) out += f.bodies[0] + " is thin ";
    return out;
  };
  CHECK(walls({plate, sheet}, true) == "body0 2 body0 is thin ");
  CHECK(walls({plate, sheet}, false) == "m1 2 m1 is thin ");
  CHECK(walls({plate, sheet, same}, true) == "body0 2 body0 is thin ");
  CHECK(walls({plate, sheet, same}, false) == "m1 1 m1 is thin m1 is thin ");
}

TEST_CASE("What is found is the same whether overlaps have labels of their own or not", "[check]") {
  const TempFolder folder;
  const std::vector<oracle::Body> bodies = {{.facets = shapes::box({0, 2, 4}, {18, 18, 6}), .material = 1},
                                            {.facets = shapes::box({3, 3, 3}, {9, 9, 17}), .material = 1},
                                            {.facets = shapes::box({6, 6, 5}, {15, 15, 17}), .material = 0},
                                            {.facets = shapes::box({12, 2, 2}, {13, 18, 8}), .material = 2}};
  const auto findings = [&](mesher::LabelBy by) {
    mesher::Scene scene = scene_of(folder, bodies, cube_grid(0, 20, 20));
    scene.label_by = by;
    mesh_quietly(scene, folder / "g.tcell");
    std::string out;
    const Findings all = check(GridReader(folder / "g.tcell"), {.thin_cells = 20}, [](double) {});
    for (const Finding& f : all.list) out += fmt::format("{} {}\n", f.text, static_cast<uint64_t>(f.cells));
    for (const WallReport& wall : all.walls) out += fmt::format("{} {}\n", wall.body, wall.thinnest.value_or(0));
    return out;
  };
  CHECK(findings(mesher::LabelBy::kOverlap) == findings(mesher::LabelBy::kBody));
}

Metadata reported_grid(const char* units) {
  Metadata meta = metadata_of(cube_grid(0, 2, 20), 0, 1);
  meta.units = units;
  return meta;
}

TEST_CASE("A cap is flat, or a guess that says how far the edge of its hole is off a plane; its cells are told", "[check]") {
  const auto found = [](const std::string& more) {
    Findings findings;
    add_reported(findings,
                 R"({"bodies":[{"name":"a","flips":[],"cells":5,"lost":{},"holes":[{"at":[0,0,1],"edges":3,"diameter":2,"width":1,"cap_area":1)" +
                     more + R"(}]}],"overlaps":{"pairs":0,"list":[]}})",
                 reported_grid("mm"));
    REQUIRE(findings.list.size() == 1);
    return findings.list[0];
  };
  const Finding flat = found(R"(,"off_plane":1e-7,"off_plane_cells":1e-6,"box":[-1,0.25,0.4,0.05,0.25,0.61])");
  CHECK(flat.text == "A hole of 'a', 2 mm long and 1 mm wide, was closed by a cap: it is flat, as the edge of the hole is.");
  CHECK(flat.box == Box{{0, 2, 4}, {1, 3, 7}});
  const Finding bent = found(R"(,"off_plane":0.25,"off_plane_cells":2.5,"box":[5,5,5,6,6,6])");
  CHECK(bent.text.ends_with("was closed by a cap: a guess, since the edge of the hole is up to 0.25 mm (2.5 cells) off a plane."));
  CHECK(!bent.box);
}

TEST_CASE("What the mesher reported becomes findings", "[check]") {
  const std::string report = R"({"schema":1,"bodies":[
    {"name":"a","facets":12,"flips":[{"at":[1,2,3],"edges":1}],"holes":[{"at":[0,0,1],"edges":3,"diameter":2,"width":0.5,"diameter_cells":4,"width_cells":1,"cap_area":1},
      {"at":[0,0,2],"edges":3,"diameter":2,"cap_area":1,"extruded":true}],"holes_left_out":5,
     "seams":{"number":2,"length":3,"widest_gap":0.25},"cells":100,"covered_cells":7,"lost_stretches":{"axis":"x","number":1,"at":[4,5,6]}},
    {"name":"b","facets":12,"flips":[],"holes":[],"cells":0,"lost_stretches":{"axis":"x","number":0,"at":null}},
    {"name":"c","facets":12,"flips":[],"holes":[],"cells":9,"lost":{"x":{"number":0,"at":null},"y":{"number":3,"widest":0.5,"at":[1,1,1]},"z":{"number":0}}}],
    "lost_gaps":[{"material":"air","axis":"z","number":2,"widest":0.125,"at":[0,0,0]}],"scene":{"bodies":[{"name":"not this"}]},"warnings":["x"]})";
  Findings findings;
  add_reported(findings, report, reported_grid("mm"));
  std::vector<std::string> texts;
  for (const Finding& f : findings.list) texts.push_back(f.text);
  CHECK(texts == std::vector<std::string>{
                     "Along 1 edge of 'a' the facets on both sides face opposite ways.",
                     "A hole of 'a', 2 mm long and 0.5 mm wide (1 cells), was closed by a cap: the surface there is a guess.",
                     "An outer loop of 'a' was closed by walls and a floor beyond the domain.",
                     "2 seams of 'a', 3 mm long in all, were stitched; the widest gap is 0.25 mm.",
                     "Along x, 1 stretch of 'a' lies between two sample points: what is there is thinner than a cell.",
                     "The body 'b' has no cell: it lies outside the domain, or between sample points.",
                     "Along y, no sample point meets 3 stretches of 'c'; the widest is 0.5 mm.",
                     "Along z, no sample point meets 2 gaps in 'air'; the widest is 0.125 mm.",
                     "7 cells in 'a' belong to stronger bodies.",
                 });
  CHECK(findings.totals[static_cast<size_t>(FindingKind::cap)].findings == 7);
  CHECK(findings.list[1].level == FindingLevel::warning);
  CHECK(findings.list[4].at == Vec3{4, 5, 6});
  CHECK(findings.not_looked_at.size() == 2);
}

TEST_CASE("Overlaps by pair take the place of what each body leaves to stronger ones", "[check]") {
  const std::string report = R"({"bodies":[{"name":"a","flips":[],"holes":[],"cells":5,"covered_cells":3,"lost":{}}],"overlaps":{"pairs":1200,"list":[
    {"bodies":["a","b"],"cells":3,"owner":"b","box":[0,1,2,3,4,5],"at":[0.5,1.5,2.5]},{"bodies":["a","c"],"cells":1,"owner":null,"box":[0,0,0,1,1,1],"at":[0,0,0]}]}})";
  Findings findings;
  add_reported(findings, report, reported_grid("m"));
  REQUIRE(findings.list.size() == 2);
  CHECK(findings.list[0].text == "'a' and 'b' overlap in 3 cells, which 'b' owns.");
  CHECK(findings.list[1].text == "'a' and 'c' overlap in 1 cell, which a third body owns in part.");
  CHECK(findings.list[0].box == Box{{0, 1, 2}, {3, 4, 5}});
  CHECK(findings.totals[static_cast<size_t>(FindingKind::overlap)].findings == 1200);
  CHECK(findings.not_looked_at.empty());
}

TEST_CASE("A report that is something else is an error in words", "[check]") {
  for (const char* report : {"", "[", R"({"bodies":[{"name":1}]})", R"({"bodies":[{}]})", R"({"bodies":[],"overlaps":3})"}) {
    CAPTURE(report);
    Findings findings;
    REQUIRE_THROWS_AS(add_reported(findings, report, reported_grid("m")), FormatError);
    REQUIRE_THROWS_WITH(add_reported(findings, report, reported_grid("m")), Catch::StartsWith("report: expected what the mesher writes"));
  }
}

TEST_CASE("Text for people says first how bad it is, lists some of each kind, and what was not looked at", "[check]") {
  Findings findings;
  CHECK(findings_text(findings, 5) == "nothing was found");
  for (int i = 0; i < 1003; ++i)
    add_finding(findings, {FindingKind::island, FindingLevel::warning, {"a"}, 2, Vec3{1, 2, 3}, std::nullopt, "An island."});
  findings.walls.push_back({"a", 2, Vec3{}, {0, 1234567, 0, 0, 0, 0, 0, 5}});
  findings.not_looked_at.push_back("This.");
  const std::string text = findings_text(findings, 2);
  CHECK(text.starts_with("0 errors, 1,000 warnings, 0 notes of 1,003 in all\n  warning  island        An island.  at (1, 2, 3)\n"));
  CHECK(text.find("island        and 1,001 more") != std::string::npos);
  CHECK(text.find("1,234,567") != std::string::npos);
  CHECK(text.ends_with("Not looked at:\n  This."));
  CHECK(findings.list.size() == kMostFindings);
}

TEST_CASE("Counts above 2^53 come as text too", "[check]") {
  Findings findings;
  add_finding(findings, {FindingKind::island, FindingLevel::warning, {"a"}, CellCount{1} << 70, std::nullopt, std::nullopt, ""});
  const json j = json::parse(findings_json(findings));
  CHECK(j["findings"][0]["cells_text"] == "1180591620717411303424");
  CHECK(j["totals"]["island"]["cells_text"] == "1180591620717411303424");
}

TEST_CASE("The document beside a grid counts only for the cells that it was made for", "[check]") {
  const TempFolder folder;
  const auto grid = folder / "a.b.tcell";
  const Metadata meta = metadata_of(unit_grid({9, 7, 5}), 2, 2);
  std::vector<Label> cells(9 * 7 * 5, 0);
  const GridReader reader = reader_of(meta, cells);
  cells.back() = 1;
  const GridReader other = reader_of(meta, cells);
  CHECK(kept_findings(grid) == folder / "a.b.check.json");
  CHECK(read_kept_findings(grid, reader).empty());
  const auto put = [&](const std::string& text) { std::ofstream(folder / "a.b.check.json") << text; };
  Findings findings;
  const auto expect = [&](bool by_reader, bool by_other) {
    put(findings_json(findings) + "\n");
    CHECK(read_kept_findings(grid, reader) == (by_reader ? with_grid_hash(findings_json(findings), reader.hash()) : ""));
    CHECK(read_kept_findings(grid, other) == (by_other ? with_grid_hash(findings_json(findings), other.hash()) : ""));
    CHECK(has_kept_findings(grid, reader) == by_reader);
    CHECK(has_kept_findings(grid, other) == by_other);
  };
  expect(false, false);
  findings.hash = reader.hash();
  expect(true, false);
  findings.cells_hash = other.cells_hash();
  expect(true, true);
  findings.hash = "123";
  expect(false, true);
  const std::string whole = findings_json(findings);
  for (size_t size = 0; size < whole.size(); ++size) {
    put(whole.substr(0, size));
    CHECK_FALSE(has_kept_findings(grid, other));
    std::string changed = whole;
    changed[size] ^= 1;
    put(changed);
    CHECK(read_kept_findings(grid, other).empty());
  }
  put(whole);
  CHECK(has_kept_findings(grid, other));
  rlimit limit;
  REQUIRE(getrlimit(RLIMIT_NOFILE, &limit) == 0);
  const rlimit none{0, limit.rlim_max};
  REQUIRE(setrlimit(RLIMIT_NOFILE, &none) == 0);  // no file can be opened
  CHECK_NOTHROW(has_kept_findings(grid, other));
  REQUIRE(setrlimit(RLIMIT_NOFILE, &limit) == 0);
  for (const char* text : {"", "{}", "nonsense", R"({"schema":1,"grid_hash":")", R"({"schema":1,"grid_hash":"","cells_hash":")"}) {
    put(text);
    CHECK(read_kept_findings(grid, reader).empty());
  }
}

}  // namespace
}  // namespace teracell
