#include "mesher/report.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace teracell {
namespace {

using nlohmann::ordered_json;

ordered_json place(const Vec3& p) { return {p[0], p[1], p[2]}; }

ordered_json body_report(const SceneBody& body, const BodyFacets& found, const SurveyTotals& survey, unsigned __int128 cells) {
  ordered_json out = {{"name", body.name}, {"facets", found.file.facets}, {"degenerate", survey.degenerate}, {"duplicates", survey.duplicates}, {"shells", survey.shells}};
  const uint64_t by_parity = found.shells ? found.shells->evenodd_shells() : found.rules[1].used ? survey.shells : 0;
  out["fill"] = ordered_json::array();
  out["holes"] = ordered_json::array();
  for (const bool parity : {false, true}) {
    const Rule& rule = found.rules[parity];
    if (rule.used) out["fill"].push_back({{"rule", parity ? "evenodd" : "nonzero"}, {"shells", parity ? by_parity : survey.shells - by_parity}, {"why", rule.why}});
    for (const Hole& h : rule.caps.holes) out["holes"].push_back({{"at", place(h.at)}, {"edges", h.edges}, {"diameter", h.diameter}, {"cap_area", h.cap_area}});
  }
  out["flips"] = ordered_json::array();
  for (const Flip& f : found.flips) out["flips"].push_back({{"at", place(f.at)}, {"edges", f.edges}});
  out["cells"] = static_cast<uint64_t>(cells);
  if (cells >> 53 != 0) out["cells_text"] = fmt::format("{}", cells);
  return out;
}

std::string plural(uint64_t n, const char* what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); }

// What was wrong with a body, what was done, and whether to care.
void warn(const SceneBody& body, const BodyFacets& found, unsigned __int128 cells, ordered_json& warnings) {
  const auto add = [&](const std::string& text) { warnings.push_back(fmt::format("body '{}' {}", body.name, text)); };
  uint64_t holes = 0, edges = 0;
  double area = 0;
  const Hole* largest = nullptr;
  for (const Rule& rule : found.rules)
    for (const Hole& h : rule.caps.holes) {
      ++holes, edges += h.edges, area += h.cap_area;
      if (!largest || h.diameter > largest->diameter) largest = &h;
    }
  if (largest)
    add(fmt::format("is open: {} ({}) closed by {} of {:.4g} square units in all; the largest is {:.4g} wide, at ({:.6g}, {:.6g}, {:.6g}){}", plural(holes, "hole"),
                    plural(edges, "edge"), holes == 1 ? "a cap" : "caps", area, largest->diameter, largest->at[0], largest->at[1], largest->at[2],
                    found.cut_from_others ? fmt::format(". Part '{}' is cut off there from parts that were left out", body.part) : ""));
  if (!found.flips.empty()) {
    uint64_t flipped = 0;
    for (const Flip& f : found.flips) flipped += f.edges;
    add(fmt::format("has facets oriented the other way round: {} along {}, first at ({:.6g}, {:.6g}, {:.6g}); {}", plural(flipped, "edge"), plural(found.flips.size(), "curve"),
                    found.flips[0].at[0], found.flips[0].at[1], found.flips[0].at[2],
                    found.rules[1].used ? "inside is decided by parity there, so where shells overlap themselves they are hollow" : "fill nonzero was asked for, so each is a hole"));
  }
  if (cells == 0) add("owns no cell: it lies outside the grid, between the sample points, or under stronger bodies");
}

}  // namespace

ordered_json make_report(const Scene& scene, const Bodies& bodies, const std::vector<SurveyTotals>& surveys, const AxisChoice& axis, const CastTotals& totals) {
  ordered_json all = ordered_json::array(), inputs = ordered_json::array(), warnings = ordered_json::array();
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    const BodyFacets& found = bodies.bodies[b];
    all.push_back(body_report(body, found, surveys[b], totals.cells[b]));
    inputs.push_back({{"path", body.mesh_text}, {"format", found.file.format}, {"bytes", found.file.bytes}, {"hash", found.file.hash}});
    warn(body, found, totals.cells[b], warnings);
  }
  ordered_json rays = {{"axis", axis_name(axis.axis)}, {"why", axis.asked_for ? "asked for" : "the fewest crossings and rays"}};
  for (const double crossings : axis.crossings) rays["crossings_expected"].push_back(static_cast<uint64_t>(std::min(crossings, 0x1p63)));
  return {{"schema", 1},           {"bodies", all},   {"crossings", totals.crossings}, {"warnings", warnings},
          {"inputs", inputs}, {"ray_axis", rays}, {"scene", normalised(scene)}};
}

}  // namespace teracell
