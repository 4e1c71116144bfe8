#include "store/info.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "store/json_text.hpp"

namespace teracell {
namespace {

using nlohmann::ordered_json;

// Counts above 2^53 lose digits in most JSON readers, so they come as text, too.
void put_count(ordered_json& j, const std::string& key, unsigned __int128 count) {
  if (count <= ~uint64_t{0}) j[key] = static_cast<uint64_t>(count);
  else j[key] = static_cast<double>(count);
  if (count >> 53 != 0) j[key + "_text"] = fmt::format("{}", count);
}

}  // namespace

double bits_per_crossing(const Metadata& meta) {
  return meta.crossings == 0 ? 0 : 8 * static_cast<double>(meta.levels()[0].bytes) / static_cast<double>(meta.crossings);
}

ordered_json info_json(const GridReader& reader) {
  const Metadata& meta = reader.meta();
  ordered_json j = {{"schema", 1}, {"units", meta.units}, {"ray_axis", axis_name(meta.ray_axis)}};
  ordered_json grid;
  for (const char* key : {"min", "max", "cells", "sample", "axes"}) grid[key] = ordered_json::array();
  for (const Axis& a : meta.grid.axis) {
    grid["min"].push_back(a.min());
    grid["max"].push_back(a.max());
    grid["cells"].push_back(a.cells());
    grid["sample"].push_back(a.sample());
    if (a.is_graded()) grid["axes"].push_back({{"type", "graded"}, {"planes", a.planes()}});
    else grid["axes"].push_back({{"type", "uniform"}, {"min", a.origin()}, {"step", a.step()}, {"first", a.first()}, {"cells", a.cells()}});
  }
  grid["cells_text"] = cell_count_text(meta.grid.cells());
  j["grid"] = grid;
  for (size_t i = 0; i < meta.materials.size(); ++i)
    j["materials"].push_back({{"id", i}, {"name", meta.materials[i].name}, {"color", meta.materials[i].color}, {"rank", meta.materials[i].rank}});
  for (int level = 0; level < reader.levels(); ++level) {
    ordered_json l = {{"level", level}, {"cells", meta.grid.cells(level)}, {"stored", reader.stored(level)}, {"chunks", 0}, {"bytes", 0},
                      {"changes", 0}};
    for (const LevelInfo& s : meta.levels())
      if (s.level == level) l["chunks"] = s.chunks, l["bytes"] = s.bytes, l["changes"] = s.changes;
    j["levels"].push_back(l);
  }
  j["chunk"] = {{"rays", meta.chunk_rays}, {"cells", meta.chunk_cells}};
  j["file"] = {{"bytes", reader.file_bytes()}, {"version", reader.version()}, {"hash", reader.hash()}};
  j["crossings"] = meta.crossings;
  j["bits_per_crossing"] = bits_per_crossing(meta);
  j["report"] = parse_json(reader.report(), reader.name() + ": report");
  return j;
}

ordered_json stats_json(const Metadata& meta, const Box& region, const std::vector<MaterialStats>& stats) {
  const auto box = [](const Box& b) { return ordered_json{b.lo[0], b.lo[1], b.lo[2], b.hi[0], b.hi[1], b.hi[2]}; };
  ordered_json j = {{"schema", 1}, {"region", box(region)}, {"materials", ordered_json::array()}};
  for (size_t i = 0; i < stats.size(); ++i) {
    ordered_json m = {{"id", i}, {"name", meta.materials[i].name}};
    put_count(m, "cells", stats[i].cells);
    m["volume"] = stats[i].volume;
    m["box"] = stats[i].cells == 0 ? ordered_json(nullptr) : box(stats[i].box);
    j["materials"].push_back(m);
  }
  return j;
}

ordered_json column_json(const Metadata& meta, int axis, int64_t a, int64_t b, const std::vector<ColumnRun>& runs) {
  ordered_json j = {{"schema", 1}, {"axis", axis_name(axis)}, {"at", {a, b}}, {"runs", ordered_json::array()}};
  const Axis& along = meta.grid.axis[axis];
  for (const ColumnRun& r : runs)
    j["runs"].push_back({{"from", r.from},
                         {"to", r.to},
                         {"min", along.plane(r.from)},
                         {"max", along.plane(r.to)},
                         {"material", r.material},
                         {"name", meta.materials[r.material].name}});
  return j;
}

}  // namespace teracell
