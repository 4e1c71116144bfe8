#include "store/format/report_json.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/text/json_node.hpp"
#include "store/text/json_writer.hpp"

namespace teracell::inline store {
namespace {

constexpr size_t kMostReportText = (size_t{1} << 26) - 1024;
constexpr size_t kMostOfBodies = size_t{34} << 20, kMostOfInputs = size_t{11} << 20, kMostOfOverlaps = size_t{1} << 20;
constexpr size_t kMostPlaces = 30000;  // holes and flips, of all bodies together
constexpr const char* kAskedFor = "asked for";
constexpr size_t kBytesOfABody = 620;  // in all lists, when there is nothing special about it

// ---- writing

void write_hole(JsonWriter& out, const HoleReport& h) {
  out.begin_object().field("at", h.at).field("edges", h.edges);
  out.field("diameter", h.diameter).field("diameter_cells", h.diameter_cells);
  if (h.width) out.field("width", *h.width).field("width_cells", h.width_cells);
  out.field("cap_area", h.cap_area);
  if (h.off_plane) out.field("off_plane", *h.off_plane).field("off_plane_cells", h.off_plane_cells);
  if (h.box) out.field("box", *h.box);
  if (h.extruded) out.key("extruded").raw("true");
  out.end_object();
}

void write_lost(JsonWriter& out, const LostReport& lost) {
  out.field("number", lost.number).field("widest_65536ths", lost.widest_65536ths).field("widest", lost.widest);
  out.field("at", lost.at);
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
  out.count("cells", body.cells);
  if (body.covered != 0) out.count("covered_cells", body.covered);
  if (body.sheet) out.field("kind", "sheet");
  out.key("lost_stretches").begin_object().field("axis", axis_name(body.lost_axis)).field("number", body.lost_pairs);
  out.field("at", body.first_lost_pair);
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
  out.count("cells", o.cells).field("owner", o.owner).field("box", o.box.corners()).field("at", o.at).end_object();
}

// ---- reading

uint64_t whole_in(const JsonNode& of, std::string_view key) {
  const auto number = of.find(key);
  return number ? number->whole() : 0;
}

double number_in(const JsonNode& of, std::string_view key) {
  const auto number = of.find(key);
  return number ? number->number() : 0;
}

std::string text_in(const JsonNode& of, std::string_view key) {
  const auto text = of.find(key);
  return text ? text->any_text() : "";
}

// Nothing where it is null, too.
std::optional<JsonNode> find_value(const JsonNode& of, std::string_view key) {
  const auto value = of.find(key);
  return value && !value->is_null() ? value : std::nullopt;
}

std::optional<Vec3> place_in(const JsonNode& of) {
  const auto at = find_value(of, "at");
  return at ? std::optional(at->numbers<3>()) : std::nullopt;
}

int axis_in(const JsonNode& of) { return static_cast<int>(of.require("axis").choice({"x", "y", "z"})); }

unsigned __int128 count_in(const JsonNode& of, const std::string& key) {
  const auto text = of.find(key + "_text");
  if (!text) return whole_in(of, key);
  unsigned __int128 n = 0;
  for (const char c : text->any_text()) {
    if (c < '0' || c > '9') text->fail("digits");
    n = 10 * n + static_cast<unsigned>(c - '0');
  }
  return n;
}

LostReport lost_in(const JsonNode& j) {
  return {whole_in(j, "number"), static_cast<uint32_t>(whole_in(j, "widest_65536ths")), number_in(j, "widest"), place_in(j)};
}

HoleReport hole_in(const JsonNode& j) {
  HoleReport h;
  h.at = j.require("at").numbers<3>();
  h.edges = whole_in(j, "edges");
  h.diameter = number_in(j, "diameter");
  h.diameter_cells = number_in(j, "diameter_cells");
  h.cap_area = number_in(j, "cap_area");
  if (const auto extruded = j.find("extruded")) h.extruded = extruded->boolean();
  if (const auto width = j.find("width")) h.width = width->number();
  if (const auto off = j.find("off_plane")) h.off_plane = off->number();
  h.width_cells = number_in(j, "width_cells");
  h.off_plane_cells = number_in(j, "off_plane_cells");
  if (const auto box = j.find("box")) h.box = box->numbers<6>();
  return h;
}

BodyReport body_in(const JsonNode& j) {
  BodyReport body;
  body.name = j.require("name").any_text();
  body.sheet = text_in(j, "kind") == "sheet";
  body.facets = whole_in(j, "facets");
  body.counts = {whole_in(j, "degenerate"), whole_in(j, "duplicates"), whole_in(j, "opposite"), whole_in(j, "shells")};
  j.each("fill", [&](const JsonNode& f) {
    body.fill.push_back({static_cast<Fill>(f.require("rule").choice(kFillNames)), whole_in(f, "shells"), text_in(f, "why")});
  });
  body.stitch = number_in(j, "stitch");
  if (const auto s = j.find("seams"))
    body.seams = {whole_in(*s, "number"), number_in(*s, "length"), number_in(*s, "widest_gap"), whole_in(*s, "collapsed_edges")};
  j.each("holes", [&](const JsonNode& h) { body.holes.push_back(hole_in(h)); });
  j.each("flips", [&](const JsonNode& f) { body.flips.push_back({f.require("at").numbers<3>(), whole_in(f, "edges")}); });
  body.holes_left_out = whole_in(j, "holes_left_out");
  body.flips_left_out = whole_in(j, "flips_left_out");
  j.require("cells");  // a body would seem to have none
  body.cells = count_in(j, "cells");
  body.covered = count_in(j, "covered_cells");
  if (const auto pairs = j.find("lost_stretches")) {
    body.lost_axis = axis_in(*pairs);
    body.lost_pairs = whole_in(*pairs, "number");
    body.first_lost_pair = place_in(*pairs);
  }
  if (const auto lost = j.find("lost")) {
    body.lost.emplace();
    for (int axis = 0; axis < 3; ++axis)
      if (const auto found = lost->find(axis_name(axis))) (*body.lost)[static_cast<size_t>(axis)] = lost_in(*found);
  }
  return body;
}

OverlapReport overlap_in(const JsonNode& j) {
  OverlapReport o;
  const JsonNode bodies = j.require("bodies"), owner = j.require("owner");
  const std::vector<JsonNode> names = bodies.items(2);
  o.bodies = {names[0].any_text(), names[1].any_text()};
  o.cells = count_in(j, "cells");
  if (!owner.is_null()) o.owner = owner.any_text();
  const auto box = j.require("box").wholes<6>();
  o.box = {{box[0], box[1], box[2]}, {box[3], box[4], box[5]}};
  o.at = j.require("at").numbers<3>();
  return o;
}

// What is no list, once the lists are read.
void read_rest(const JsonNode& j, Report& report) {
  report.bodies_left_out = whole_in(j, "bodies_left_out");
  report.crossings = whole_in(j, "crossings");
  if (const auto rays = j.find("ray_axis")) {
    report.axis = axis_in(*rays);
    report.axis_asked_for = text_in(*rays, "why") == kAskedFor;
    report.crossings_expected = rays->require("crossings_expected").numbers<3>();
  }
  if (const auto planes = find_value(j, "planes")) {
    report.planes.emplace().left_out = planes->require("left_out").whole();
    planes->each("breaches", [&](const JsonNode& b) {
      report.planes->breaches.push_back({axis_in(b), static_cast<PlaneBreach::Rule>(b.require("rule").choice(kPlaneRuleNames)),
                                         b.require("at").number(), b.require("found").number(), b.require("expected").number()});
    });
  }
  if (const auto overlaps = find_value(j, "overlaps")) {
    report.overlaps.emplace().pairs = overlaps->require("pairs").whole();
    overlaps->each("list", [&](const JsonNode& o) { report.overlaps->list.push_back(overlap_in(o)); });
  }
}

}  // namespace

namespace {

void write_cad(JsonWriter& out, const CadReport& cad) {
  out.key("cad").begin_object().field("kernel", cad.kernel).field("key", cad.key).field("facets_hash", cad.hash);
  out.field("deflection", cad.deflection).field("angle", cad.angle);
  out.field("grid_volume", cad.grid_volume);
  out.field("by_shares", cad.by_shares).key("parts").begin_array();
  for (const CadPartReport& p : cad.parts) {
    out.begin_object().field("path", p.path).field("instances", p.instances).field("faces", p.faces);
    out.field("faces_without_facets", p.faces_without_facets).field("closed", p.closed).field("facet_volume", p.facet_volume);
    out.field("kernel_volume", p.kernel_volume);
    out.field("sender_volume", p.sender_volume);
    out.end_object();
  }
  out.end_array();
  if (cad.parts_left_out > 0) out.field("parts_left_out", cad.parts_left_out);
  out.end_object();
}

std::optional<CadReport> cad_in(const JsonNode& input) {
  const auto j = input.find("cad");
  if (!j) return std::nullopt;
  CadReport out{j->require("kernel").any_text(),
                j->require("key").any_text(),
                j->require("facets_hash").any_text(),
                j->require("deflection").number(),
                j->require("angle").number(),
                {},
                0,
                j->number_or_null("grid_volume"),
                j->require("by_shares").boolean()};
  j->each("parts", [&](const JsonNode& p) {
    out.parts.push_back({p.require("path").any_text(), p.require("instances").whole(), p.require("faces").whole(),
                         p.require("faces_without_facets").whole(), p.require("closed").boolean(), p.require("facet_volume").number(),
                         p.number_or_null("kernel_volume"), p.number_or_null("sender_volume")});
  });
  if (const auto n = j->find("parts_left_out")) out.parts_left_out = n->whole();
  return out;
}

}  // namespace

void write_breaches(JsonWriter& out, const PlanesReport& planes) {
  out.begin_array();
  for (const PlaneBreach& b : planes.breaches) {
    out.begin_object().field("axis", axis_name(b.axis)).field("rule", kPlaneRuleNames[static_cast<size_t>(b.rule)]).field("at", b.at);
    out.field("found", b.found).field("expected", b.expected).end_object();
  }
  out.end_array();
}

std::string write_report(const Report& report, const std::vector<std::string>& warnings, const std::string& scene) {
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
    writer.begin_object().field("path", input.path).field("format", input.format).field("bytes", input.bytes).field("hash", input.hash);
    if (!input.unit.empty()) writer.field("unit", input.unit).field("factor", input.factor);
    if (input.cad) write_cad(writer, *input.cad);
    writer.end_object();
  });
  out.key("ray_axis")
      .begin_object()
      .field("axis", axis_name(report.axis))
      .field("why", report.axis_asked_for ? kAskedFor : "the fewest crossings and rays");
  out.key("crossings_expected").begin_array();
  for (const double crossings : report.crossings_expected) out.value(static_cast<uint64_t>(std::min(crossings, 0x1p63)));
  out.end_array().end_object();
  if (report.planes) {
    out.key("planes").begin_object().key("breaches");
    write_breaches(out, *report.planes);
    out.field("left_out", report.planes->left_out).end_object();
  }
  if (report.overlaps) {
    const std::vector<OverlapReport>& list = report.overlaps->list;
    out.key("overlaps").begin_object().field("pairs", report.overlaps->pairs).key("list");
    write_list(text, list.size(), kMostOfOverlaps, [&](JsonWriter& writer, size_t i) { write_overlap(writer, list[i]); });
    out.end_object();
  }
  const auto add_if_it_fits = [&](const char* key, const std::string& json) {
    out.key(key).raw(text.size() + json.size() < kMostReportText ? json : "null");
  };
  add_if_it_fits("scene", scene);  // materials and planes alone may be long
  if (report.lost_gaps) add_if_it_fits("lost_gaps", gaps_json(*report.lost_gaps));
  out.end_object();
  return text;
}

std::optional<Report> read_report(const std::string& text, const std::function<void(BodyReport&&)>& take) try {
  Report report;
  std::vector<GapReport> gaps;
  std::map<std::string, bool> sheets_alone;  // by material
  uint64_t bodies_told = 0, bodies_of_scene = 0;
  const JsonParts parts{
      [&](const std::string& list, size_t i, const Json& element) {
        const std::string place = fmt::format("{}[{}]", list, i);
        const JsonNode j(element, place);
        naming(place, [&] {
          if (list == "bodies") take(body_in(j)), ++bodies_told;
          else if (list == "scene.bodies") {
            sheets_alone.try_emplace(text_in(j, "material"), true).first->second &= text_in(j, "kind") == "sheet";
            ++bodies_of_scene;
          } else if (list == "warnings") report.warnings.push_back(j.any_text());
          else if (list == "lost_gaps") gaps.push_back({j.require("material").any_text(), axis_in(j), lost_in(j)});
          else if (list == "inputs")
            report.inputs.push_back({j.require("path").any_text(), text_in(j, "format"), j.require("hash").any_text(), j.require("bytes").whole(),
                                     text_in(j, "unit"), j.find("factor") ? j.require("factor").number() : 1, cad_in(j)});
        });
      },
      "scene"};
  const Json json = parse_json(text, "", size_t{1} << 23, parts);
  const JsonNode rest(json, "the report");
  const auto bodies = rest.is_object() ? rest.find("bodies") : std::nullopt;
  if (!bodies) return std::nullopt;
  if (!bodies->is_array()) bodies->fail("an array");
  if (find_value(rest, "lost_gaps")) report.lost_gaps = std::move(gaps);
  read_rest(rest, report);
  if (bodies_of_scene == bodies_told + report.bodies_left_out)  // else nobody knows what the others are
    for (const auto& [material, alone] : sheets_alone)
      if (alone) report.sheet_materials.push_back(material);
  return report;
} catch (const FormatError& e) {
  throw FormatError(fmt::format("report: expected what the mesher writes, found something else: {}", e.what()));
}

Report parse_report(const std::string& text) {
  std::vector<BodyReport> bodies;
  std::optional<Report> report = read_report(text, [&](BodyReport&& body) { bodies.push_back(std::move(body)); });
  if (!report) throw FormatError("report: expected what the mesher writes, found no list of bodies");
  report->bodies = std::move(bodies);
  return *std::move(report);
}

}  // namespace teracell::inline store
