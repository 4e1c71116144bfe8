#include "store/whole/info.hpp"

#include <algorithm>
#include <utility>

#include "store/grid/cell_widths.hpp"
#include "store/text/json_text.hpp"
#include "store/text/json_writer.hpp"
#include "store/text/text.hpp"

namespace teracell::inline store {
namespace {

// Counts above 2^53 lose digits in most JSON readers, so they come as text, too.
// A list with an item for each of `all`, written by item(i).
template <class T, class F>
void write_all(JsonWriter& out, const char* key, const T& all, F&& item) {
  out.key(key).begin_array();
  for (size_t i = 0; i < std::size(all); ++i) item(i);
  out.end_array();
}

void write_grid(JsonWriter& out, const Grid& grid) {
  out.begin_object();
  write_all(out, "min", grid.axis, [&](size_t d) { out.value(grid.axis[d].min()); });
  write_all(out, "max", grid.axis, [&](size_t d) { out.value(grid.axis[d].max()); });
  write_all(out, "cells", grid.axis, [&](size_t d) { out.value(grid.axis[d].cells()); });
  write_all(out, "sample", grid.axis, [&](size_t d) { out.value(grid.axis[d].sample()); });
  write_all(out, "axes", grid.axis, [&](size_t d) {
    const Axis& a = grid.axis[d];
    out.begin_object().field("type", a.is_graded() ? "graded" : "uniform");
    if (a.is_graded()) out.field("planes", std::span(a.planes()));
    else out.field("min", a.origin()).field("step", a.step()).field("first", a.first()).field("cells", a.cells());
    out.end_object();
  });
  out.field("cells_text", cell_count_text(grid.cells())).end_object();
}

// The list of places where planes that were made break their rules, as the report has it.
std::string_view breaches_in(std::string_view report) {
  constexpr std::string_view kKey = "\"planes\":{\"breaches\":", kNone = "[]";  // in no text: quotes are escaped there
  const size_t at = report.find(kKey);
  if (at == std::string_view::npos) return kNone;
  report.remove_prefix(at + kKey.size());
  const std::string_view list = report.substr(0, report.find(']') + 1);
  return Json::accept(list) ? list : kNone;
}

// Of grids with planes of their own: how wide their cells are, and what is to be said of planes that were made.
void write_planes(JsonWriter& out, const Grid& grid, std::string_view report) {
  if (std::none_of(grid.axis.begin(), grid.axis.end(), [](const Axis& a) { return a.is_graded(); })) return;
  CellWidths all = cell_widths(grid.axis[0]);
  for (const Axis& axis : grid.axis) {
    const CellWidths w = cell_widths(axis);
    all.smallest = std::min(all.smallest, w.smallest), all.largest = std::max(all.largest, w.largest), all.ratio = std::max(all.ratio, w.ratio);
  }
  const auto put = [&](const CellWidths& w) {
    out.field("smallest_cell", w.smallest).field("largest_cell", w.largest).field("largest_ratio", w.ratio);
  };
  const std::string breaches(breaches_in(report));  // which is part of what is written to
  out.key("planes").begin_object();
  put(all);
  write_all(out, "axes", grid.axis, [&](size_t d) {
    out.begin_object();
    put(cell_widths(grid.axis[d]));
    out.end_object();
  });
  out.key("breaches").raw(breaches).end_object();
}

void write_level(JsonWriter& out, const GridReader& reader, int level) {
  const std::vector<LevelInfo>& levels = reader.meta().levels();
  const auto stored = std::ranges::find(levels, level, &LevelInfo::level);
  const LevelInfo info = stored == levels.end() ? LevelInfo{} : *stored;
  out.begin_object().field("level", level).field("cells", reader.meta().grid.cells(level)).field("stored", stored != levels.end());
  out.field("chunks", info.chunks).field("bytes", info.bytes).field("changes", info.changes).end_object();
}

// The end of an object: cells, volume and box.
void write_amount(JsonWriter& out, const CellStats& s) {
  out.count("cells", s.cells).field("volume", s.volume);
  if (s.cells == 0) out.field("box", nullptr);
  else out.field("box", s.box.corners());
  out.end_object();
}

void begin_stats(JsonWriter& out, const Metadata& meta, const Box& region, const std::vector<CellStats>& stats) {
  out.begin_object().field("schema", 1).field("region", region.corners());
  write_all(out, "materials", stats, [&](size_t i) {
    out.begin_object().field("id", i).field("name", meta.materials[i].name);
    write_amount(out, stats[i]);
  });
}

}  // namespace

double bits_per_crossing(const Metadata& meta) {
  return meta.crossings == 0 ? 0 : 8 * static_cast<double>(meta.levels()[0].bytes) / static_cast<double>(meta.crossings);
}

std::string info_json(const GridReader& reader, std::string_view id) {
  const Metadata& meta = reader.meta();
  std::string text;
  JsonWriter out(text);
  out.begin_object().field("schema", 1).field("units", meta.units).field("ray_axis", axis_name(meta.ray_axis)).key("grid");
  write_grid(out, meta.grid);
  write_all(out, "materials", meta.materials, [&](size_t i) {
    const MaterialInfo& m = meta.materials[i];
    out.begin_object().field("id", i).field("name", m.name).field("color", m.color).field("rank", m.rank).end_object();
  });
  if (keeps_bodies(meta))
    write_all(out, "labels", meta.labels, [&](size_t i) {
      const LabelInfo& label = meta.labels[i];
      out.begin_object().field("material", label.material).field("body", label.body);
      if (label.overlap) out.field("overlap", true);
      out.end_object();
    });
  write_all(out, "patches", meta.patches, [&](size_t i) {
    const PatchInfo& p = meta.patches[i];
    out.begin_object().field("id", i).field("name", p.name).field("body", p.body).field("area", p.area).end_object();
  });
  out.key("levels").begin_array();
  for (int level = 0; level < reader.levels(); ++level) write_level(out, reader, level);
  out.end_array();
  write_all(out, "channels", meta.others(), [&](size_t i) {
    const Channel& c = meta.others()[i];
    out.begin_object().field("name", c.name).field("coding", c.coding).field("bytes", c.bytes);
    if (!c.about.empty()) out.key("about").raw(c.about);
    out.end_object();
  });
  out.key("chunk").begin_object().field("rays", meta.chunk_rays).field("cells", meta.chunk_cells).end_object();
  out.key("file").begin_object().field("bytes", reader.file_bytes()).field("version", reader.version()).field("hash", reader.hash());
  if (!meta.labels_hash.empty()) out.field("labels_hash", meta.labels_hash);
  out.end_object();
  out.field("crossings", meta.crossings).field("bits_per_crossing", bits_per_crossing(meta)).key("report");
  const size_t report = text.size();
  reader.append_report(text);
  write_planes(out, meta.grid, std::string_view(text).substr(report));
  if (!id.empty()) out.field("id", id);
  out.end_object();
  return text;
}

std::string stats_json(const Metadata& meta, const Box& region, const std::vector<CellStats>& stats) {
  std::string text;
  JsonWriter out(text);
  begin_stats(out, meta, region, stats);
  out.end_object();
  return text;
}

std::string body_stats_json(const Metadata& meta, const Box& region, const std::vector<CellStats>& of_labels) {
  std::string text;
  JsonWriter out(text);
  begin_stats(out, meta, region, stats_by_material(meta, of_labels));
  write_all(out, "bodies", of_labels, [&](size_t i) {
    const LabelInfo& label = meta.labels[i];
    out.begin_object().field("label", i).field("name", label.body).field("material", label.material);
    if (label.overlap) out.field("overlap", true);
    write_amount(out, of_labels[i]);
  });
  out.end_object();
  return text;
}

std::string difference_json(const Difference& difference) {
  std::string text;
  JsonWriter out(text);
  out.begin_object().field("schema", 1);
  out.count("cells", difference.cells).count("same", difference.same);
  write_all(out, "changes", difference.changes, [&](size_t i) {
    const Change& change = difference.changes[i];
    out.begin_object().field("from", change.from).field("to", change.to).count("cells", change.cells);
    out.field("box", change.box.corners()).end_object();
  });
  out.end_object();
  return text;
}

std::string line_json(const Metadata& meta, const Vec3& a, const Vec3& b, const std::vector<LineRun>& runs) {
  const double length = norm({b[0] - a[0], b[1] - a[1], b[2] - a[2]});
  std::string text;
  JsonWriter out(text);
  out.begin_object().field("schema", 1).field("from", std::span<const double>(a)).field("to", std::span<const double>(b)).field("length", length);
  write_all(out, "runs", runs, [&](size_t i) {
    const LineRun& run = runs[i];
    out.begin_object().field("from", run.from * length).field("to", run.to * length).field("length", (run.to - run.from) * length);
    out.field("cells", run.cells).field("material", run.material).field("name", meta.materials[run.material].name).end_object();
  });
  out.end_object();
  return text;
}

void ColumnJson::begin(std::string& text) const {
  JsonWriter out(text);
  out.begin_object().field("schema", 1).field("axis", axis_name(axis_)).key("at").begin_array().value(a_).value(b_).end_array();
  out.key("runs").begin_array();
}

void ColumnJson::run(std::string& text, const ColumnRun& r) {
  if (std::exchange(several_, true)) text += ',';
  const Axis& along = meta_.grid.axis[axis_];
  JsonWriter out(text);
  out.begin_object().field("from", r.from).field("to", r.to).field("min", along.plane(r.from)).field("max", along.plane(r.to));
  out.field("material", r.material).field("name", meta_.materials[r.material].name).end_object();
}

void ColumnJson::end(std::string& text) { text += "]}"; }

std::string column_json(const Metadata& meta, int axis, int64_t a, int64_t b, const std::vector<ColumnRun>& runs) {
  ColumnJson json(meta, axis, a, b);
  std::string text;
  json.begin(text);
  for (const ColumnRun& run : runs) json.run(text, run);
  json.end(text);
  return text;
}

}  // namespace teracell::store
