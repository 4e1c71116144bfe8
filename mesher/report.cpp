#include "mesher/report.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mesher/report_lost.hpp"

namespace teracell {
namespace {

using nlohmann::ordered_json;

ordered_json place(const Vec3& p) { return {p[0], p[1], p[2]}; }
std::string text(const Vec3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p[0], p[1], p[2]); }

std::string plural(uint64_t n, const char* what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); }

// How many cells a hole is wide, where cells are narrowest.
double width_in_cells(const Hole& hole, const Grid& grid) {
  double narrowest = HUGE_VAL;
  for (int d = 0; d < 3; ++d) {
    const Axis& a = grid.axis[d];
    const int64_t i = a.cell_at(std::clamp(hole.at[d], a.min(), a.max()));
    narrowest = std::min(narrowest, a.plane(i + 1) - a.plane(i));
  }
  return hole.diameter / narrowest;
}

double longest_side(const Grid& grid) {
  double longest = 0;
  for (const Axis& a : grid.axis) longest = std::max(longest, a.max() - a.min());
  return longest;
}

ordered_json body_report(const SceneBody& body, const BodyFacets& found, const Grid& grid, const SurveyTotals& survey, unsigned __int128 cells,
                         unsigned __int128 covered) {
  ordered_json out = {{"name", body.name},
                      {"facets", found.file.facets},
                      {"degenerate", survey.degenerate},
                      {"duplicates", survey.duplicates},
                      {"shells", survey.shells}};
  const uint64_t by_parity = found.shells ? found.shells->evenodd_shells() : found.rules[1].used ? survey.shells : 0;
  out["fill"] = ordered_json::array();
  out["holes"] = ordered_json::array();
  for (const bool parity : {false, true}) {
    const Rule& rule = found.rules[parity];
    const uint64_t shells = parity ? by_parity : survey.shells - by_parity;
    if (rule.used) out["fill"].push_back({{"rule", parity ? "evenodd" : "nonzero"}, {"shells", shells}, {"why", rule.why}});
    for (const Hole& h : rule.caps.holes)
      out["holes"].push_back({{"at", place(h.at)},
                              {"edges", h.edges},
                              {"diameter", h.diameter},
                              {"diameter_cells", width_in_cells(h, grid)},
                              {"cap_area", h.cap_area}});
  }
  out["flips"] = ordered_json::array();
  for (const Flip& f : found.flips) out["flips"].push_back({{"at", place(f.at)}, {"edges", f.edges}});
  out["cells"] = static_cast<uint64_t>(cells);
  if (cells >> 53 != 0) out["cells_text"] = fmt::format("{}", cells);
  if (covered != 0) out["covered_cells"] = static_cast<uint64_t>(covered);
  return out;
}

// Whether to care about holes, the largest of which is so wide.
std::string verdict(double width, double cells, const Grid& grid, bool loose) {
  if (loose) return "No two facets share an edge, so they enclose nothing: are vertices that should be one equal to the last digit?";
  if (cells < 2) return "That is below 2 cells: harmless on this grid";
  if (width * 10 < longest_side(grid)) return "Inside ends at the caps: look there if those few cells matter";
  return "Inside ends at the caps, so they shape the body: look whether it should be open there";
}

std::string open_warning(const Scene& scene, const SceneBody& body, const BodyFacets& found, const Grid& grid) {
  std::vector<Hole> holes;
  for (const Rule& rule : found.rules) holes.insert(holes.end(), rule.caps.holes.begin(), rule.caps.holes.end());
  if (holes.empty()) return "";
  uint64_t edges = 0;
  double area = 0, most_cells = 0;
  for (const Hole& h : holes) {
    edges += h.edges, area += h.cap_area;
    most_cells = std::max(most_cells, width_in_cells(h, grid));
  }
  const Hole& largest = *std::ranges::max_element(holes, {}, &Hole::diameter);
  const bool one = holes.size() == 1, loose = holes.size() == found.file.facets && edges == 3 * holes.size();
  return fmt::format("is open: {} ({}), closed by {} of {:.4g} {}^2 in all; the {} is {:.4g} {} wide, {:.3g} cells, at {}. {}{}",
                     plural(holes.size(), "hole"), plural(edges, "edge"), one ? "a cap" : "caps", area, scene.units, one ? "hole" : "largest",
                     largest.diameter, scene.units, width_in_cells(largest, grid), text(largest.at),
                     verdict(largest.diameter, most_cells, grid, loose),
                     found.cut_from_others ? fmt::format(". Part '{}' is cut off there from parts that were left out", body.part) : "");
}

std::string flip_warning(const BodyFacets& found) {
  if (found.flips.empty()) return "";
  uint64_t edges = 0;
  for (const Flip& f : found.flips) edges += f.edges;
  const char* parity = "Inside such a shell is decided by parity, which does not mind; only where the shell overlaps itself is it hollow";
  const char* winding = "Fill nonzero was asked for, so each curve is a hole, closed by caps: fill auto would not mind";
  return fmt::format("has facets that face the other way than their neighbours: {} along {}, the first at {}. {}",
                     plural(edges, "edge"), plural(found.flips.size(), "curve"), text(found.flips[0].at), found.rules[1].used ? parity : winding);
}

// What was wrong with a body, what was done, and whether to care.
std::vector<std::string> body_warnings(const Scene& scene, const SceneBody& body, const BodyFacets& found, const Grid& grid,
                                       const SurveyTotals& survey) {
  std::vector<std::string> out = {open_warning(scene, body, found, grid), flip_warning(found)};
  if (found.rules[1].used && survey.duplicates > 0)
    out.push_back(fmt::format("has {}, and shells whose inside is decided by parity: there a facet that lies twice counts as none",
                              plural(survey.duplicates, "duplicate facet")));
  std::erase(out, "");
  return out;
}

}  // namespace

ordered_json make_report(const Scene& scene, const Bodies& bodies, const std::vector<SurveyTotals>& surveys, const Plan& plan, const CastTotals& totals,
                         bool count_thin) {
  const Grid& grid = plan.meta.grid;
  const AxisChoice& axis = plan.rays;
  ordered_json all = ordered_json::array(), inputs = ordered_json::array(), warnings = ordered_json::array();
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    const BodyFacets& found = bodies.bodies[b];
    all.push_back(body_report(body, found, grid, surveys[b], totals.cells[b], totals.covered[b]));
    report_lost(scene, b, plan, totals.tallies, count_thin, all.back());
    inputs.push_back({{"path", body.mesh_text}, {"format", found.file.format}, {"bytes", found.file.bytes}, {"hash", found.file.hash}});
    for (const auto& list : {body_warnings(scene, body, found, grid, surveys[b]), cell_warnings(scene, b, found, plan, totals)})
      for (const std::string& words : list) warnings.push_back(fmt::format("body '{}' {}", body.name, words));
  }
  ordered_json rays = {{"axis", axis_name(axis.axis)}, {"why", axis.asked_for ? "asked for" : "the fewest crossings and rays"}};
  for (const double crossings : axis.crossings) rays["crossings_expected"].push_back(static_cast<uint64_t>(std::min(crossings, 0x1p63)));
  ordered_json out = {{"schema", 1},           {"bodies", all},   {"crossings", totals.crossings}, {"warnings", warnings},
                      {"inputs", inputs}, {"ray_axis", rays}, {"scene", normalised(scene)}};
  if (count_thin) out["lost_gaps"] = lost_gaps(scene, grid, totals.tallies);
  return out;
}

}  // namespace teracell
