#include "mesher/report.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace teracell {
namespace {

using nlohmann::ordered_json;

const char* name_of(Fill fill) { return fill == Fill::kEvenodd ? "evenodd" : "nonzero"; }

ordered_json body_report(const SceneBody& body, const BodyFacets& found, const Survey& survey, unsigned __int128 cells) {
  ordered_json out = {{"name", body.name}, {"facets", found.file.facets}, {"degenerate", survey.degenerate}, {"duplicates", survey.duplicates}, {"shells", survey.shells}};
  out["fill"] = {{{"rule", name_of(found.rule)}, {"shells", survey.shells}, {"why", found.why}}};
  out["holes"] = ordered_json::array();
  out["cells"] = static_cast<uint64_t>(cells);
  if (cells >> 53 != 0) out["cells_text"] = fmt::format("{}", cells);
  return out;
}

}  // namespace

ordered_json make_report(const Scene& scene, const Bodies& bodies, const std::vector<Survey>& surveys, const AxisChoice& axis, const CastTotals& totals) {
  ordered_json all = ordered_json::array(), inputs = ordered_json::array(), warnings = ordered_json::array();
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    const BodyFacets& found = bodies.bodies[b];
    all.push_back(body_report(body, found, surveys[b], totals.cells[b]));
    inputs.push_back({{"path", body.mesh_text}, {"format", found.file.format}, {"bytes", found.file.bytes}, {"hash", found.file.hash}});
    if (body.fill == Fill::kAuto && found.rule == Fill::kEvenodd)
      warnings.push_back(fmt::format("body '{}' has facets oriented the other way round: inside is decided by parity, so where its shells overlap it is hollow", body.name));
    if (totals.cells[b] == 0)
      warnings.push_back(fmt::format("body '{}' owns no cell: it lies outside the grid, between the sample points, or under stronger bodies", body.name));
  }
  ordered_json rays = {{"axis", axis_name(axis.axis)}, {"why", axis.asked_for ? "asked for" : "the fewest crossings and rays"}};
  for (const AxisCost& cost : axis.cost) rays["crossings_expected"].push_back(static_cast<uint64_t>(std::min(cost.crossings, 0x1p63)));
  return {{"schema", 1},           {"bodies", all},   {"crossings", totals.crossings}, {"warnings", warnings},
          {"inputs", inputs}, {"ray_axis", rays}, {"scene", normalised(scene)}};
}

}  // namespace teracell
