#include "mesher/report/report_json.hpp"

#include "store/base/error.hpp"
#include "store/format/report_json.hpp"
#include "tests/support/test.hpp"

namespace teracell::mesher {
namespace {

using nlohmann::ordered_json;

// A report with every key in it.
Report full_report() {
  BodyReport solid;
  solid.name = "hull \"aft\"";
  solid.facets = 12;
  solid.counts = {1, 2, 1, 3};
  solid.fill = {{Fill::kNonzero, 2, "facets are oriented alike"}, {Fill::kDistinct, 1, "asked for"}};
  solid.stitch = 0.25;
  solid.seams = {2, 3.5, 1e-6, 4};
  solid.holes = {{{1, 2, 3}, 9, 1.5, 2.25, 15, true, 0.5, 0.25, 5, 2, {{0, 1, 2, 3, 4, 5}}}, {{0, 0, 0.1}, 3, 1, 1, 10}};
  solid.flips = {{{4, 5, 6}, 7}};
  solid.cells = (static_cast<unsigned __int128>(1) << 100) + 1;
  solid.covered = static_cast<unsigned __int128>(1) << 70;
  solid.lost_axis = 0;
  solid.lost_pairs = 5;
  solid.first_lost_pair = Vec3{0.5, 0.5, 0.5};
  solid.lost = {LostReport{3, 65535, 0.125, Vec3{7, 8, 9}}, LostReport{}, LostReport{}};
  BodyReport sheet;
  sheet.name = "plate";
  sheet.sheet = true;
  sheet.cells = 17;
  Report report;
  report.bodies = {solid, sheet};
  report.crossings = 123;
  report.warnings = {"look", "here"};
  report.inputs = {{"a.stl", "STL (binary)", "00ff", 684}, {"b.ply", "PLY (ASCII)", "ff00", 1}};
  report.axis = 1;
  report.axis_asked_for = true;
  report.crossings_expected = {1, 2, 1e30};
  report.lost_gaps = {{"steel", 2, {1, 2, 3.0, Vec3{1, 1, 1}}}};
  report.overlaps = {3,
                     {{{"hull \"aft\"", "plate"}, static_cast<unsigned __int128>(1) << 90, "plate", {{0, 1, 2}, {3, 4, 1 << 30}}, {0.5, 1.5, 2.5}},
                      {{"plate", "rib"}, 7, std::nullopt, {{0, 0, 0}, {1, 1, 7}}, {0.1, 0, 0}}}};
  return report;
}

Scene small_scene() {
  Scene scene;
  scene.materials = {{"air", "#00000000"}, {"steel", "#102030"}};
  return scene;
}

}  // namespace

TEST_CASE("A report that is read is written as it was", "[report]") {
  Scene scene = small_scene();
  const std::string json = report_json(full_report(), scene);
  CHECK(report_json(parse_report(json), scene) == json);
}

TEST_CASE("Counts beyond 64 bits are whole in a report, as numbers and as texts", "[report]") {
  const Report report = full_report();
  const std::string json = report_json(report, small_scene());
  CHECK(json.find("\"cells\":1267650600228229401496703205377,\"cells_text\":\"1267650600228229401496703205377\"") != json.npos);
  CHECK(json.find("\"covered_cells\":1180591620717411303424,\"covered_cells_text\":\"1180591620717411303424\"") != json.npos);
  const Report read = parse_report(json);
  CHECK(read.bodies[0].cells == report.bodies[0].cells);
  CHECK(read.bodies[0].covered == report.bodies[0].covered);
  CHECK(read.bodies[1].cells == 17);
}

TEST_CASE("What the CAD kernel said of an input stands with it, and is read as it was written", "[report][cad]") {
  Report report = full_report();
  CadReport said;
  said.kernel = "OpenCASCADE 7.6.3", said.key = "00ff", said.hash = "ff00", said.deflection = 0.125, said.angle = 12, said.parts_left_out = 5;
  CadPartReport& nut = said.parts.emplace_back();
  nut.path = "/as1/ナット", nut.instances = 8, nut.faces = 10, nut.faces_without_facets = 1, nut.closed = true;
  nut.facet_volume = 291.5, nut.kernel_volume = 291.75, nut.sender_volume = 350;
  said.parts.emplace_back().path = "/as1/open";
  report.inputs.push_back({"as1.step", "STEP", "0f", 77, "in", 25.4, said});
  const std::string text = report_json(report, small_scene());
  const auto json = ordered_json::parse(text);
  CHECK_FALSE(json["inputs"][0].contains("cad"));
  const auto& cad = json["inputs"][2]["cad"];
  CHECK(cad["kernel"] == "OpenCASCADE 7.6.3");
  CHECK(cad["facets_hash"] == "ff00");
  CHECK(cad["deflection"] == 0.125);
  const auto& part = cad["parts"][0];
  CHECK(part["path"] == "/as1/ナット");
  CHECK(part["instances"] == 8);
  CHECK(part["faces"] == 10);
  CHECK(part["faces_without_facets"] == 1);
  CHECK(part["closed"] == true);
  CHECK(part["facet_volume"] == 291.5);
  CHECK(part["kernel_volume"] == 291.75);
  CHECK(part["sender_volume"] == 350);
  CHECK(cad["parts"][1]["kernel_volume"].is_null());
  CHECK(cad["parts_left_out"] == 5);
  const Report read = parse_report(text);
  REQUIRE(read.inputs[2].cad);
  CHECK(read.inputs[2].cad->parts[0].sender_volume == 350);
  CHECK_FALSE(read.inputs[0].cad);
  CHECK(report_json(read, small_scene()) == text);
}

TEST_CASE("Overlaps are listed by pair, with their owner if it is one of the two", "[report]") {
  const auto json = ordered_json::parse(report_json(full_report(), small_scene()));
  CHECK(json["overlaps"]["pairs"] == 3);
  CHECK(json["overlaps"]["list"][0]["cells_text"] == "1237940039285380274899124224");
  CHECK(json["overlaps"]["list"][0]["owner"] == "plate");
  CHECK(json["overlaps"]["list"][1].dump() == R"({"bodies":["plate","rib"],"cells":7,"owner":null,"box":[0,0,0,1,1,7],"at":[0.1,0.0,0.0]})");
}

TEST_CASE("What one run was like stands beside the report's own keys, and its warnings in their place", "[report]") {
  RunReport run;
  run.trust = {{"hull", {100, 3, 0.4, {1, 2, 3}, {0, 0, 0}, {4, 4, 4}}}, {"deck", {50, 0, -1, {}, {}, {}}}};
  run.phases = {{"read", 0.5}, {"cast", 1.25}};
  run.threads = 2;
  run.engine = "scan";
  run.file_bytes = 1000;
  const auto json = ordered_json::parse(report_json(full_report(), small_scene(), run, {"doubtful"}));
  CHECK(json["warnings"] == ordered_json{"doubtful"});
  CHECK(json["bodies"].size() == 2);
  CHECK(
      json["trust"].dump() ==
      R"([{"body":"hull","points":100,"disagree":3,"at":[1.0,2.0,3.0],"box":[[0.0,0.0,0.0],[4.0,4.0,4.0]]},{"body":"deck","points":50,"disagree":0}])");
  CHECK(json["phases"].dump() == R"([{"name":"read","seconds":0.5},{"name":"cast","seconds":1.25}])");
  CHECK(json["file_bytes"] == 1000);
  CHECK(run.seconds() == 1.75);
}

TEST_CASE("Reports of earlier versions are read: keys that they lack keep their defaults", "[report]") {
  const Report report = parse_report(R"({"schema":1,"bodies":[{"name":"a","facets":12,"degenerate":0,"duplicates":0,"shells":1,
    "fill":[{"rule":"nonzero","shells":1,"why":"closed"}],"holes":[{"at":[0,0,0],"edges":3,"diameter":1,"diameter_cells":2,"cap_area":1}],"flips":[],"cells":8}]})");
  REQUIRE(report.bodies.size() == 1);
  CHECK(report.bodies[0].cells == 8);
  CHECK(report.bodies[0].seams.number == 0);
  CHECK_FALSE(report.bodies[0].holes[0].width);
  CHECK_FALSE(report.bodies[0].lost);
  CHECK_FALSE(report.lost_gaps);
  CHECK_FALSE(report.overlaps);
}

TEST_CASE("What is no report is a format error", "[report]") {
  for (const char* text : {"", "null", "[]", "{}", R"({"bodies":3})", R"({"bodies":[{"name":1}]})",
                           R"({"bodies":[],"ray_axis":{"axis":"w","crossings_expected":[1,2,3]}})"})
    CHECK_THROWS_AS(parse_report(text), FormatError);
  std::string json = report_json(full_report(), small_scene());
  const size_t rule = json.find("nonzero");
  json.replace(rule, 7, "nonsens");
  CHECK_THROWS_AS(parse_report(json), FormatError);
}

TEST_CASE("A report of very many bodies is cut to what a file holds, and says how many it leaves out", "[report]") {
  if (kSanitized) return;  // a gigabyte of bodies
  Report report;
  BodyReport body;
  body.name = std::string(200, 'b');
  body.flips.assign(4, {{1, 2, 3}, 4});
  report.bodies.assign(150'000, body);
  report.inputs.assign(150'000, {"a.stl", "STL (binary)", std::string(32, '0'), 684});
  const std::string json = report_json(report, small_scene());
  CHECK(json.size() < size_t{1} << 26);
  const Report read = parse_report(json);
  CHECK(read.bodies_left_out > 0);
  CHECK(read.bodies.size() + read.bodies_left_out == 150'000);
  uint64_t listed = 0, left_out = 0;
  for (const BodyReport& b : read.bodies) listed += b.flips.size(), left_out += b.flips_left_out;
  CHECK(listed == 30'000);
  CHECK(listed + left_out == 4 * read.bodies.size());
}

}  // namespace teracell::mesher
