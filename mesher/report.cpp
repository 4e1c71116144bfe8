#include "mesher/report.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mesher/report_lost.hpp"
#include "store/json_writer.hpp"
#include "store/text.hpp"

namespace teracell {
namespace {

using nlohmann::ordered_json;

// A file holds a report of 2^26 bytes at most (store/FORMAT.md). Very many bodies are counted, no longer listed.
constexpr size_t kMostText = (size_t{1} << 26) - 1024;
constexpr size_t kMostOfBodies = size_t{34} << 20, kMostOfInputs = size_t{11} << 20, kMostOfScene = size_t{15} << 20, kMostOfWarnings = size_t{1} << 20;
constexpr size_t kMostPlaces = 30000;  // holes and flips, of all bodies together
constexpr size_t kBytesOfABody = 620;  // in all lists, when there is nothing special about it

std::string text(const Vec3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p[0], p[1], p[2]); }

// A length in cells where they are narrowest, near `at`.
double in_cells(double length, const Vec3& at, const Grid& grid) {
  double narrowest = HUGE_VAL;
  for (int d = 0; d < 3; ++d) {
    const Axis& a = grid.axis[d];
    const int64_t i = a.cell_at(std::clamp(at[d], a.min(), a.max()));
    narrowest = std::min(narrowest, a.plane(i + 1) - a.plane(i));
  }
  return length / narrowest;
}

double longest_side(const Grid& grid) {
  double longest = 0;
  for (const Axis& a : grid.axis) longest = std::max(longest, a.max() - a.min());
  return longest;
}

void write_hole(JsonWriter& out, const Hole& h, const Grid& grid) {
  out.begin_object().field("at", h.at).field("edges", h.edges);
  out.field("diameter", h.diameter).field("diameter_cells", in_cells(h.diameter, h.at, grid));
  out.field("width", h.width).field("width_cells", in_cells(h.width, h.at, grid)).field("cap_area", h.cap_area);
  if (h.extruded) out.key("extruded").raw("true");
  out.end_object();
}

// What is written of a body, but for what is lost between sample points. `room`: how many holes and flips may still be listed.
void write_body(JsonWriter& out, const SceneBody& body, const BodyFacets& found, const Grid& grid, const SurveyTotals& survey, unsigned __int128 cells,
                unsigned __int128 covered, size_t& room) {
  constexpr const char* kRule[] = {"auto", "nonzero", "evenodd", "distinct"};
  const ClosedBody& closed = found.closed;
  out.field("name", body.name).field("facets", found.file.facets);
  out.field("degenerate", survey.degenerate).field("duplicates", survey.duplicates).field("opposite", survey.opposite).field("shells", survey.shells);
  out.key("fill").begin_array();
  for (const FillChoice& f : closed.fill)
    out.begin_object().field("rule", kRule[static_cast<size_t>(f.rule)]).field("shells", f.shells.value_or(survey.shells)).field("why", f.why).end_object();
  out.end_array();
  if (body.kind == Kind::kSolid) {
    const Seams& seams = closed.seams;
    out.field("stitch", closed.stitch);
    out.key("seams").begin_object().field("number", seams.number).field("length", seams.length).field("widest_gap", seams.widest_gap);
    if (seams.collapsed > 0) out.field("collapsed_edges", seams.collapsed);
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
  list("holes", closed.holes, [&](const Hole& h) { write_hole(out, h, grid); });
  list("flips", closed.flips, [&](const Flip& f) { out.begin_object().field("at", f.at).field("edges", f.edges).end_object(); });
  out.field("cells", static_cast<uint64_t>(cells));
  if (cells >> 53 != 0) out.field("cells_text", fmt::format("{}", cells));
  if (covered != 0) out.field("covered_cells", static_cast<uint64_t>(covered));
}

// Whether to care about holes, the widest of which is so wide.
std::string verdict(double width, double cells, const Grid& grid, bool loose) {
  if (loose) return "No two facets share an edge, so they enclose nothing: are vertices that should be one further apart than the stitch length?";
  if (cells < 2) return "That is below 2 cells: harmless on this grid";
  if (width * 10 < longest_side(grid)) return "Inside ends at the caps: look there if those few cells matter";
  return "Inside ends at the caps, so they shape the body: look whether it should be open there";
}

// The axis along which terrain would be extruded, if a hole looks like the edge of one: it spans the domain along the two
// others, and goes up and down with the surface, which the missing side of a box does not.
std::optional<int> terrain_axis(const Hole& hole, const BodyFacets& found, const Grid& grid) {
  std::vector<int> narrow;
  for (int d = 0; d < 3; ++d)
    if (hole.hi[d] - hole.lo[d] < 0.8 * (grid.axis[d].max() - grid.axis[d].min())) narrow.push_back(d);
  if (narrow.size() > 1) return std::nullopt;
  const int axis = narrow.empty() ? 2 : narrow[0];
  if (hole.hi[axis] - hole.lo[axis] < 0.2 * (found.hi[axis] - found.lo[axis])) return std::nullopt;
  return axis;
}

std::string seam_note(const Scene& scene, const ClosedBody& closed, const Grid& grid) {
  const Seams& seams = closed.seams;
  if (seams.number == 0 && seams.collapsed == 0) return "";
  std::string out = "was stitched";
  if (seams.number > 0) out += fmt::format(" along {}, {:.4g} {} in all", plural(seams.number, "seam"), seams.length, scene.units);
  if (seams.collapsed > 0)
    out += fmt::format("{} {} within the stitch length of each other, which closes or narrows what lay between them", seams.number > 0 ? " and at" : " at",
                       plural(seams.collapsed, "open edge"));
  out += fmt::format(", over gaps of up to {:.3g} {} (the stitch length is {:.3g} {})", seams.widest_gap, scene.units, closed.stitch, scene.units);
  double shortest = HUGE_VAL;
  for (const Axis& a : grid.axis) shortest = std::min(shortest, a.shortest_cell());
  if (closed.stitch > 2 * shortest) out += ". That is longer than two cells: look whether it closed what should be open";
  return out;
}

std::string open_warning(const Scene& scene, const SceneBody& body, const BodyFacets& found, const Grid& grid) {
  const ClosedBody& closed = found.closed;
  uint64_t edges = 0, capped = 0;
  double area = 0, most_cells = 0;
  const Hole* largest = nullptr;
  for (const Hole& h : closed.holes) {
    if (h.extruded) continue;
    ++capped;
    edges += h.edges, area += h.cap_area;
    most_cells = std::max(most_cells, in_cells(h.width, h.at, grid));
    if (!largest) largest = &h;  // they come in this order
  }
  if (!largest) return "";
  const bool one = capped == 1, loose = capped == found.file.facets && edges == 3 * capped;
  std::string out = fmt::format("is open: {} ({}), closed by {} of {:.4g} {}^2 in all; the {} is {:.4g} {} across, {:.3g} cells, with a gap of {:.3g} {}, {:.3g} cells, at {}. {}",
                                plural(capped, "hole"), plural(edges, "edge"), one ? "a cap" : "caps", area, scene.units, one ? "hole" : "largest",
                                largest->diameter, scene.units, in_cells(largest->diameter, largest->at, grid), largest->width, scene.units,
                                in_cells(largest->width, largest->at, grid), text(largest->at), verdict(largest->diameter, most_cells, grid, loose));
  if (closed.cut_from_others) out += fmt::format(". Part '{}' is cut off there from parts that were left out", body.part);
  if (const auto axis = terrain_axis(*largest, found, grid); axis && !loose && body.closing.way == Closing::Way::kCap)
    out += fmt::format(". If it is terrain, a sheet over the whole domain, give it \"closing\": {{\"extrude\": \"-{0}\"}} or --closing extrude:-{0}: "
                       "then all that is below it is inside", axis_name(*axis));
  return out;
}

bool uses_parity(const ClosedBody& closed) {
  return std::ranges::any_of(closed.fill, [](const FillChoice& f) { return f.rule != Fill::kNonzero; });
}

std::string flip_warning(const ClosedBody& closed) {
  if (closed.flips.empty()) return "";
  uint64_t edges = 0;
  for (const Flip& f : closed.flips) edges += f.edges;
  const char* parity = "Inside such a shell is decided by parity, for which orientation does not matter; only where the shell overlaps itself is it hollow";
  const char* winding = "Fill nonzero was asked for, so each curve is a hole, closed by caps: fill auto would decide by parity instead";
  return fmt::format("has facets that face the other way than their neighbours: {} along {}, the first at {}. {}", plural(edges, "edge"),
                     plural(closed.flips.size(), "curve"), text(closed.flips[0].at), uses_parity(closed) ? parity : winding);
}

std::string double_warning(const ClosedBody& closed) {
  for (const FillChoice& f : closed.fill)
    if (f.rule == Fill::kDistinct && f.why != "asked for") return "is given twice, or partly: " + f.why;
  return "";
}

// What was wrong with a body, what was done, and whether to care.
std::vector<std::string> body_warnings(const Scene& scene, const SceneBody& body, const BodyFacets& found, const Grid& grid,
                                       const SurveyTotals& survey) {
  const ClosedBody& closed = found.closed;
  std::vector<std::string> out = {seam_note(scene, closed, grid), open_warning(scene, body, found, grid), flip_warning(closed), double_warning(closed)};
  const bool evenodd = std::ranges::any_of(closed.fill, [](const FillChoice& f) { return f.rule == Fill::kEvenodd; });
  if (evenodd && survey.duplicates > 0)
    out.push_back(fmt::format("has {}, and shells whose inside is decided by parity: there a facet that is given twice counts as none",
                              plural(survey.duplicates, "duplicate facet")));
  std::erase(out, "");
  return out;
}

}  // namespace

Report make_report(const Scene& scene, const Bodies& bodies, const std::vector<SurveyTotals>& surveys, const Plan& plan, const CastTotals& totals,
                   bool count_thin) {
  const Grid& grid = plan.meta.grid;
  const AxisChoice& axis = plan.rays;
  Report out;
  uint64_t more_warnings = 0, warning_bytes = 0;
  const auto warn = [&](std::string words) {
    warning_bytes += words.size();
    if (warning_bytes > kMostOfWarnings) ++more_warnings;
    else out.warnings.push_back(std::move(words));
  };
  std::set<std::pair<std::string, std::string>> said;  // of a file: once, however many bodies are in it
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    for (const std::string& w : bodies.bodies[b].file.warnings)
      if (said.insert({body.mesh_text, w}).second) warn(fmt::format("{}: {}", body.mesh_text, w));
    for (const std::string& words : body_warnings(scene, body, bodies.bodies[b], grid, surveys[b])) warn(fmt::format("body '{}' {}", body.name, words));
  }
  for (const std::string& words : cell_warnings(scene, bodies, plan, totals)) warn(words);
  if (more_warnings > 0) out.warnings.push_back(fmt::format("there are {} more warnings than the report holds", more_warnings));
  ordered_json rays = {{"axis", axis_name(axis.axis)}, {"why", axis.asked_for ? "asked for" : "the fewest crossings and rays"}};
  for (const double crossings : axis.crossings) rays["crossings_expected"].push_back(static_cast<uint64_t>(std::min(crossings, 0x1p63)));

  std::string& text = out.text;
  text.reserve(std::min(scene.bodies.size() * kBytesOfABody, kMostOfBodies + kMostOfInputs + kMostOfScene));  // doubling would take twice as much for a moment
  text = "{\"schema\":1,\"bodies\":";
  size_t room = kMostPlaces;
  const size_t left_out = write_list(text, scene.bodies.size(), kMostOfBodies, [&](JsonWriter& writer, size_t b) {
    writer.begin_object();
    write_body(writer, scene.bodies[b], bodies.bodies[b], grid, surveys[b], totals.cells[b], totals.covered[b], room);
    write_lost(writer, scene, b, plan, totals.tallies, count_thin);
    writer.end_object();
  });
  if (left_out > 0) text += fmt::format(",\"bodies_left_out\":{}", left_out);
  text += fmt::format(",\"crossings\":{},\"warnings\":{},\"inputs\":", totals.crossings, ordered_json(out.warnings).dump());
  write_list(text, scene.bodies.size(), kMostOfInputs, [&](JsonWriter& writer, size_t b) {
    const SurfaceFile& file = bodies.bodies[b].file;
    writer.begin_object().field("path", scene.bodies[b].mesh_text).field("format", file.format).field("bytes", file.bytes).field("hash", file.hash).end_object();
  });
  text += fmt::format(",\"ray_axis\":{}", rays.dump());
  const std::string scene_text = normalised(scene, kMostOfScene);  // materials and planes alone may be long
  if (text.size() + scene_text.size() < kMostText) text += ",\"scene\":" + scene_text;
  else text += ",\"scene\":null";
  if (count_thin) {
    const std::string gaps = lost_gaps(scene, grid, totals.tallies);
    text += text.size() + gaps.size() < kMostText ? ",\"lost_gaps\":" + gaps : ",\"lost_gaps\":null";
  }
  text += '}';
  return out;
}

}  // namespace teracell
