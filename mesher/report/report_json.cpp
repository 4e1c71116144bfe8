#include "mesher/report/report_json.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "store/base/error.hpp"
#include "store/text/json_text.hpp"
#include "store/text/json_writer.hpp"

namespace teracell::mesher {
namespace {

using nlohmann::ordered_json;

constexpr size_t kMostReportText = (size_t{1} << 26) - 1024;
constexpr size_t kMostOfBodies = size_t{34} << 20, kMostOfInputs = size_t{11} << 20, kMostOfScene = size_t{15} << 20,
                 kMostOfOverlaps = size_t{1} << 20;
constexpr size_t kMostPlaces = 30000;  // holes and flips, of all bodies together
constexpr size_t kBytesOfABody = 620;  // in all lists, when there is nothing special about it

// ---- out

void write_place(JsonWriter& out, const std::optional<Vec3>& at) {
  if (at) out.field("at", *at);
  else out.field("at", nullptr);
}

void write_count(JsonWriter& out, const std::string& key, unsigned __int128 n) {
  out.key(key).raw(fmt::format("{}", n));
  if (n >> 53 != 0) out.field(key + "_text", fmt::format("{}", n));
}

void write_hole(JsonWriter& out, const HoleReport& h) {
  out.begin_object().field("at", h.at).field("edges", h.edges);
  out.field("diameter", h.diameter)
      .field("diameter_cells", h.diameter_cells)
      .field("width", h.width)
      .field("width_cells", h.width_cells)
      .field("cap_area", h.cap_area)
      .field("off_plane", h.off_plane)
      .field("off_plane_cells", h.off_plane_cells);
  out.key("box").begin_array();
  for (const Vec3& corner : {h.lo, h.hi})
    for (const double x : corner) out.value(x);
  out.end_array();
  if (h.extruded) out.key("extruded").raw("true");
  out.end_object();
}

void write_lost(JsonWriter& out, const LostReport& lost) {
  out.field("number", lost.number).field("widest_65536ths", lost.widest_65536ths).field("widest", lost.widest);
  write_place(out, lost.at);
}

// `room`: how many holes and flips may still be listed.
void write_body(JsonWriter& out, const BodyReport& body, size_t& room) {
  out.begin_object().field("name", body.name).field("facets", body.facets);
  const SurfaceCounts& counts = body.counts;
  out.field("degenerate", counts.degenerate).field("duplicates", counts.duplicates).field("opposite", counts.opposite).field("shells", counts.shells);
  out.key("fill").begin_array();
  for (const FillChoice& f : body.fill)
    out.begin_object().field("rule", fill_name(f.rule)).field("shells", f.shells.value_or(counts.shells)).field("why", f.why).end_object();
  out.end_array();
  if (!body.sheet) {
    out.field("stitch", body.stitch);
    out.key("seams").begin_object().field("number", body.seams.number).field("length", body.seams.length).field("widest_gap", body.seams.widest_gap);
    if (body.seams.collapsed > 0) out.field("collapsed_edges", body.seams.collapsed);
    out.end_object();
  }
  const auto list = [&](const char* key, const auto& all, auto&& write) {
    const size_t count = std::min(all.size(), room);
    room -= count;
    out.key(key).begin_array();
    for (size_t i = 0; i < count; ++i) write(all[i]);
    out.end_array();
    if (count < all.size()) out.field(fmt::format("{}_left_out", key), all.size() - count);
  };
  list("holes", body.holes, [&](const HoleReport& h) { write_hole(out, h); });
  list("flips", body.flips, [&](const Flip& f) { out.begin_object().field("at", f.at).field("edges", f.edges).end_object(); });
  write_count(out, "cells", body.cells);
  if (body.covered != 0) write_count(out, "covered_cells", body.covered);
  if (body.sheet) out.field("kind", "sheet");
  out.key("lost_stretches").begin_object().field("axis", axis_name(body.lost_axis)).field("number", body.lost_pairs);
  write_place(out, body.first_lost_pair);
  out.end_object();
  if (body.lost) {
    out.key("lost").begin_object();
    for (int axis = 0; axis < 3; ++axis) {
      out.key(axis_name(axis)).begin_object();
      write_lost(out, (*body.lost)[axis]);
      out.end_object();
    }
    out.end_object();
  }
  out.end_object();
}

std::string gaps_json(const std::vector<GapReport>& gaps) {
  std::string text;
  write_list(text, gaps.size(), ~size_t{0}, [&](JsonWriter& out, size_t i) {
    out.begin_object().field("material", gaps[i].material).field("axis", axis_name(gaps[i].axis));
    write_lost(out, gaps[i].lost);
    out.end_object();
  });
  return text;
}

void write_overlap(JsonWriter& out, const OverlapReport& o) {
  out.begin_object().key("bodies").begin_array().value(o.bodies[0]).value(o.bodies[1]).end_array();
  write_count(out, "cells", o.cells);
  if (o.owner) out.field("owner", *o.owner);
  else out.field("owner", nullptr);
  out.key("box").begin_array();
  for (const Index3& corner : {o.box.lo, o.box.hi})
    for (const int64_t n : corner) out.value(n);
  out.end_array().field("at", o.at).end_object();
}

// ---- in

Vec3 vec3(const ordered_json& j) { return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()}; }

std::optional<Vec3> place_in(const ordered_json& j) {
  const auto at = j.find("at");
  return at == j.end() || at->is_null() ? std::nullopt : std::optional(vec3(*at));
}

int axis_in(const ordered_json& j) {
  const auto axis = axis_named(j.at("axis").get<std::string>());
  if (!axis) throw FormatError("the report: expected an axis x, y or z, found something else");
  return *axis;
}

unsigned __int128 count_in(const ordered_json& body, const std::string& key) {
  const auto text = body.find(key + "_text");
  if (text == body.end()) return body.value(key, uint64_t{0});
  unsigned __int128 n = 0;
  for (const char c : text->get<std::string>()) {
    if (c < '0' || c > '9') throw FormatError(fmt::format("the report: {}_text: expected digits, found something else", key));
    n = 10 * n + static_cast<unsigned>(c - '0');
  }
  return n;
}

LostReport lost_in(const ordered_json& j) {
  return {j.at("number").get<uint64_t>(), j.value("widest_65536ths", uint32_t{0}), j.value("widest", 0.0), place_in(j)};
}

HoleReport hole_in(const ordered_json& j) {
  HoleReport h;
  h.at = vec3(j.at("at"));
  h.edges = j.at("edges").get<uint64_t>();
  h.diameter = j.at("diameter").get<double>();
  h.diameter_cells = j.at("diameter_cells").get<double>();
  h.width = j.value("width", 0.0);
  h.width_cells = j.value("width_cells", 0.0);
  h.cap_area = j.at("cap_area").get<double>();
  h.off_plane = j.value("off_plane", 0.0);
  h.off_plane_cells = j.value("off_plane_cells", 0.0);
  if (const auto box = j.find("box"); box != j.end()) {
    const auto c = box->get<std::array<double, 6>>();
    h.lo = {c[0], c[1], c[2]}, h.hi = {c[3], c[4], c[5]};
  }
  h.extruded = j.value("extruded", false);
  return h;
}

FillChoice fill_in(const ordered_json& j) {
  const auto rule = std::ranges::find(kFillNames, j.at("rule").get<std::string>());
  if (rule == kFillNames.end()) throw FormatError("the report: expected a fill rule, found something else");
  return {static_cast<Fill>(rule - kFillNames.begin()), j.at("shells").get<uint64_t>(), j.at("why").get<std::string>()};
}

BodyReport body_in(const ordered_json& j) {
  BodyReport body;
  body.name = j.at("name").get<std::string>();
  body.sheet = j.value("kind", "solid") == "sheet";
  body.facets = j.at("facets").get<uint64_t>();
  body.counts = {j.at("degenerate").get<uint64_t>(), j.at("duplicates").get<uint64_t>(), j.value("opposite", uint64_t{0}),
                 j.at("shells").get<uint64_t>()};
  for (const ordered_json& f : j.at("fill")) body.fill.push_back(fill_in(f));
  body.stitch = j.value("stitch", 0.0);
  if (const auto seams = j.find("seams"); seams != j.end())
    body.seams = {seams->at("number").get<uint64_t>(), seams->at("length").get<double>(), seams->at("widest_gap").get<double>(),
                  seams->value("collapsed_edges", uint64_t{0})};
  for (const ordered_json& h : j.at("holes")) body.holes.push_back(hole_in(h));
  for (const ordered_json& f : j.at("flips")) body.flips.push_back({vec3(f.at("at")), f.at("edges").get<uint64_t>()});
  body.holes_left_out = j.value("holes_left_out", uint64_t{0});
  body.flips_left_out = j.value("flips_left_out", uint64_t{0});
  body.cells = count_in(j, "cells");
  body.covered = count_in(j, "covered_cells");
  if (const auto pairs = j.find("lost_stretches"); pairs != j.end()) {
    body.lost_axis = axis_in(*pairs);
    body.lost_pairs = pairs->at("number").get<uint64_t>();
    body.first_lost_pair = place_in(*pairs);
  }
  if (const auto lost = j.find("lost"); lost != j.end()) body.lost = {lost_in(lost->at("x")), lost_in(lost->at("y")), lost_in(lost->at("z"))};
  return body;
}

OverlapReport overlap_in(const ordered_json& j) {
  OverlapReport o;
  for (size_t i = 0; i < 2; ++i) o.bodies[i] = j.at("bodies").at(i).get<std::string>();
  o.cells = count_in(j, "cells");
  if (const ordered_json& owner = j.at("owner"); !owner.is_null()) o.owner = owner.get<std::string>();
  for (size_t d = 0; d < 3; ++d) o.box.lo[d] = j.at("box").at(d).get<int64_t>(), o.box.hi[d] = j.at("box").at(d + 3).get<int64_t>();
  o.at = vec3(j.at("at"));
  return o;
}

Report report_in(const ordered_json& j) {
  Report report;
  for (const ordered_json& b : j.at("bodies")) report.bodies.push_back(body_in(b));
  report.bodies_left_out = j.value("bodies_left_out", uint64_t{0});
  report.crossings = j.value("crossings", uint64_t{0});
  report.warnings = j.value("warnings", std::vector<std::string>{});
  for (const ordered_json& i : j.value("inputs", ordered_json::array()))
    report.inputs.push_back({i.at("path").get<std::string>(), i.value("format", ""), i.at("hash").get<std::string>(), i.at("bytes").get<uint64_t>()});
  if (const auto rays = j.find("ray_axis"); rays != j.end()) {
    report.axis = axis_in(*rays);
    report.axis_asked_for = rays->value("why", "") == "asked for";
    report.crossings_expected = vec3(rays->at("crossings_expected"));
  }
  if (const auto gaps = j.find("lost_gaps"); gaps != j.end() && !gaps->is_null()) {
    report.lost_gaps.emplace();
    for (const ordered_json& g : *gaps) report.lost_gaps->push_back({g.at("material").get<std::string>(), axis_in(g), lost_in(g)});
  }
  if (const auto overlaps = j.find("overlaps"); overlaps != j.end()) {
    report.overlaps.emplace().pairs = overlaps->at("pairs").get<uint64_t>();
    for (const ordered_json& o : overlaps->at("list")) report.overlaps->list.push_back(overlap_in(o));
  }
  return report;
}

// Without the bracket at its end.
std::string open_report(const Report& report, const Scene& scene, const std::vector<std::string>& warnings) {
  std::string text;
  const size_t bodies = report.bodies.size();
  text.reserve(std::min(bodies * kBytesOfABody, kMostOfBodies + kMostOfInputs + kMostOfScene));  // doubling would take twice as much for a moment
  JsonWriter out(text);
  out.begin_object().field("schema", 1).key("bodies");
  size_t room = kMostPlaces;
  const size_t left_out = write_list(text, bodies, kMostOfBodies, [&](JsonWriter& writer, size_t b) { write_body(writer, report.bodies[b], room); });
  if (left_out > 0) out.field("bodies_left_out", left_out);
  out.field("crossings", report.crossings).key("warnings").raw(ascii_json(warnings)).key("inputs");
  write_list(text, report.inputs.size(), kMostOfInputs, [&](JsonWriter& writer, size_t b) {
    const InputReport& input = report.inputs[b];
    writer.begin_object().field("path", input.path).field("format", input.format).field("bytes", input.bytes).field("hash", input.hash).end_object();
  });
  out.key("ray_axis")
      .begin_object()
      .field("axis", axis_name(report.axis))
      .field("why", report.axis_asked_for ? "asked for" : "the fewest crossings and rays");
  out.key("crossings_expected").begin_array();
  for (const double crossings : report.crossings_expected) out.value(static_cast<uint64_t>(std::min(crossings, 0x1p63)));
  out.end_array().end_object();
  if (report.overlaps) {
    const std::vector<OverlapReport>& list = report.overlaps->list;
    out.key("overlaps").begin_object().field("pairs", report.overlaps->pairs).key("list");
    write_list(text, list.size(), kMostOfOverlaps, [&](JsonWriter& writer, size_t i) { write_overlap(writer, list[i]); });
    out.end_object();
  }
  const auto add_if_it_fits = [&](const char* key, const std::string& json) {
    out.key(key).raw(text.size() + json.size() < kMostReportText ? json : "null");
  };
  add_if_it_fits("scene", normalised(scene, kMostOfScene));  // materials and planes alone may be long
  if (report.lost_gaps) add_if_it_fits("lost_gaps", gaps_json(*report.lost_gaps));
  return text;
}

void write_run(JsonWriter& out, const RunReport& run) {
  out.key("trust").begin_array();
  for (const auto& [body, trust] : run.trust) {
    out.begin_object().field("body", body).field("points", trust.points).field("disagree", trust.disagree);
    if (trust.disagree > 0) out.field("at", trust.at).key("box").begin_array().value(trust.lo).value(trust.hi).end_array();
    out.end_object();
  }
  out.end_array().key("phases").begin_array();
  for (const auto& [name, seconds] : run.phases) out.begin_object().field("name", name).field("seconds", seconds).end_object();
  out.end_array().field("peak_memory_bytes", run.peak_memory_bytes).field("threads", run.threads).field("engine", run.engine);
  out.field("exact_decisions", run.exact_decisions).field("spilled_bytes", run.spilled_bytes).field("resumed_chunks", run.resumed_chunks);
  out.field("file_bytes", run.file_bytes);
}

}  // namespace

std::string report_json(const Report& report, const Scene& scene) { return open_report(report, scene, report.warnings) + '}'; }

std::string report_json(const Report& report, const Scene& scene, const RunReport& run, const std::vector<std::string>& warnings) {
  std::string text = open_report(report, scene, warnings);
  JsonWriter out(text);
  write_run(out, run);
  out.end_object();
  return text;
}

Report parse_report(const std::string& json) {
  try {
    return report_in(parse_json(json, "the report"));
  } catch (const ordered_json::exception& e) {
    throw FormatError(fmt::format("the report: expected the keys that this program writes, found something else: {}", e.what()));
  }
}

}  // namespace teracell::mesher
