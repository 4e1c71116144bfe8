// What is told of a file in JSON.
#include "store/whole/info.hpp"

#include "tests/support/small_files.hpp"

namespace teracell {
namespace {

using namespace testing;
using nlohmann::ordered_json;

TEST_CASE("Of a file are told its grid, materials, levels, chunks and report") {
  Metadata meta =
      with_tiny_chunks(metadata_of({{Axis::uniform(-1, 0.5, 2, 9, 0.25), Axis::graded({0, 1, 3}, 0.5), Axis::uniform(0, 1, 0, 3, 0.5)}}, 0, 2));
  meta.units = "mm";
  std::vector<Label> cells(54, 0);
  cells[6] = 1;
  const GridReader reader = reader_of(meta, cells);
  const ordered_json j = ordered_json::parse(info_json(reader));
  REQUIRE(j["schema"] == 1);
  REQUIRE(j["units"] == "mm");
  REQUIRE(j["ray_axis"] == "x");
  REQUIRE(j["grid"]["min"] == ordered_json{0.0, 0.0, 0.0});
  REQUIRE(j["grid"]["max"] == ordered_json{4.5, 3.0, 3.0});
  REQUIRE(j["grid"]["cells"] == ordered_json{9, 2, 3});
  REQUIRE(j["grid"]["cells_text"] == "54");
  REQUIRE(j["grid"]["sample"] == ordered_json{0.25, 0.5, 0.5});
  REQUIRE(j["grid"]["axes"][0] == ordered_json{{"type", "uniform"}, {"min", -1.0}, {"step", 0.5}, {"first", 2}, {"cells", 9}});
  REQUIRE(j["grid"]["axes"][1] == ordered_json{{"type", "graded"}, {"planes", {0.0, 1.0, 3.0}}});
  REQUIRE(j["materials"][1] == ordered_json{{"id", 1}, {"name", "m1"}, {"color", "#808080"}, {"rank", 0}});
  REQUIRE(j["levels"].size() == 5);
  uint64_t bytes = 0;
  for (const ordered_json& level : j["levels"]) {
    REQUIRE(level["stored"] == (level["level"] != 1));
    bytes += level["bytes"].get<uint64_t>();
  }
  REQUIRE(j["levels"][0]["chunks"] == 1);  // one cell differs: all other chunks are uniform
  REQUIRE(j["levels"][0]["changes"] == 2);
  REQUIRE(j["levels"][1] == ordered_json{{"level", 1}, {"cells", {5, 1, 2}}, {"stored", false}, {"chunks", 0}, {"bytes", 0}, {"changes", 0}});
  REQUIRE((bytes > 0 && bytes < reader.file_bytes()));
  REQUIRE(j["chunk"] == ordered_json{{"rays", 4}, {"cells", 4}});
  REQUIRE(j["file"] ==
          ordered_json{{"bytes", reader.file_bytes()}, {"version", "3.2"}, {"hash", reader.hash()}, {"labels_hash", reader.meta().labels_hash}});
  REQUIRE(j["crossings"] == 1234);
  REQUIRE(j["bits_per_crossing"] == 8 * j["levels"][0]["bytes"].get<double>() / 1234);
  REQUIRE(j["report"] == ordered_json{{"schema", 1}});
}

TEST_CASE("Labels are listed where the file keeps bodies apart") {
  const TempFolder folder;
  Metadata meta = metadata_of(unit_grid({2, 1, 1}), 0, 2);
  store_cells(folder / "materials", meta, {0, 1});
  REQUIRE(!ordered_json::parse(info_json(GridReader(folder / "materials"))).contains("labels"));
  meta.labels[1].body = "bolt";
  store_cells(folder / "bodies", meta, {0, 1});
  REQUIRE(ordered_json::parse(info_json(GridReader(folder / "bodies")))["labels"] ==
          ordered_json{{{"material", 0}, {"body", ""}}, {{"material", 1}, {"body", "bolt"}}});
}

TEST_CASE("A file without crossings has no bits for them") { REQUIRE(bits_per_crossing(metadata_of({}, 2, 2)) == 0); }

TEST_CASE("Counts that JSON readers would round come as text too, past 64 bits as well") {
  const Metadata meta = metadata_of({}, 2, 4);
  std::vector<CellStats> stats(4);
  stats[1] = {(uint64_t{1} << 53) - 1, 2.5, {{1, 2, 3}, {4, 5, 6}}};
  stats[2] = {uint64_t{1} << 53, 1, {{0, 0, 0}, {1, 1, 1}}};
  stats[3] = {static_cast<unsigned __int128>(1) << 64, 1, {{0, 0, 0}, {1, 1, 1}}};
  const ordered_json j = ordered_json::parse(stats_json(meta, {{0, 1, 2}, {7, 8, 9}}, stats));
  REQUIRE(j["region"] == ordered_json{0, 1, 2, 7, 8, 9});
  const ordered_json& m = j["materials"];
  REQUIRE(m[0] == ordered_json{{"id", 0}, {"name", "m0"}, {"cells", 0}, {"volume", 0.0}, {"box", nullptr}});
  REQUIRE(m[1] == ordered_json{{"id", 1}, {"name", "m1"}, {"cells", 9007199254740991}, {"volume", 2.5}, {"box", {1, 2, 3, 4, 5, 6}}});
  REQUIRE(m[2]["cells_text"] == "9007199254740992");
  REQUIRE(m[3]["cells_text"] == "18446744073709551616");
  REQUIRE(m[3]["cells"].is_number_float());
}

TEST_CASE("The runs of a column have their cells, planes and materials") {
  const Axis axis = Axis::uniform(10, 0.5, 0, 8, 0.5);
  const ordered_json j = ordered_json::parse(column_json(metadata_of({{axis, axis, axis}}, 2, 2), 1, 3, 4, {{0, 2, 0}, {2, 8, 1}}));
  REQUIRE(j["axis"] == "y");
  REQUIRE(j["at"] == ordered_json{3, 4});
  REQUIRE(j["runs"][0] == ordered_json{{"from", 0}, {"to", 2}, {"min", 10.0}, {"max", 11.0}, {"material", 0}, {"name", "m0"}});
  REQUIRE(j["runs"][1] == ordered_json{{"from", 2}, {"to", 8}, {"min", 11.0}, {"max", 14.0}, {"material", 1}, {"name", "m1"}});
}

}  // namespace
}  // namespace teracell
