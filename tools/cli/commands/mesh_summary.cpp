#include "tools/cli/commands/mesh_summary.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mesher/report/report_json.hpp"
#include "store/base/error.hpp"
#include "store/grid/cell_widths.hpp"
#include "store/grid/number_text.hpp"
#include "store/read/reader.hpp"
#include "store/text/text.hpp"
#include "tools/cli/command.hpp"

namespace teracell::cli {

namespace {

// Says what a single number of cells has counted, where somebody may have expected it along every axis; otherwise empty.
std::string longest_text(const mesher::Scene& scene, const Index3& n) {
  if (!scene.longest_cells || (n[0] == n[1] && n[1] == n[2])) return "";
  int longest = 0;
  while (longest < 2 && n[longest] != *scene.longest_cells) ++longest;
  return fmt::format("{} counts the cells of the longest axis, {}{}; cells are cubes, so other axes have fewer (NX,NY,NZ sets each axis)",
                     fmt::group_digits(*scene.longest_cells), axis_name(longest), scene.axis[longest].min ? "" : " with its pad");
}

void warn_in_short(const std::vector<std::string>& warnings, const std::string& more) {
  constexpr size_t kShown = 50;
  for (size_t i = 0; i < std::min(warnings.size(), kShown); ++i) warn("warning: " + warnings[i]);
  if (warnings.size() > kShown) warn(fmt::format("warning: and {} {}", fmt::group_digits(warnings.size() - kShown), more));
}

}  // namespace

std::string cells_text(const Index3& n) {
  unsigned __int128 cells = 1;
  for (const int64_t along : n) cells *= static_cast<unsigned __int128>(along);
  return fmt::format("{} = {}", size_text(n), fmt::group_digits(cells));
}

std::string size_text(const Index3& n) {
  return fmt::format("{} x {} x {}", fmt::group_digits(n[0]), fmt::group_digits(n[1]), fmt::group_digits(n[2]));
}

std::string axis_text(int d, const Axis& a, const std::string& units) {
  const double far = std::max(std::abs(a.min()), std::abs(a.max())) / (a.max() - a.min());  // as many digits as tell places of the axis apart
  const int digits = std::clamp(8 + static_cast<int>(std::ceil(std::log10(far))), 8, 17);
  const std::string domain = fmt::format("{}  {} to {} {}, ", axis_name(d), number_text(a.min(), digits), number_text(a.max(), digits), units);
  if (!a.is_graded()) return domain + fmt::format("cells of {:.6g} {}", a.step(), units);
  const CellWidths w = cell_widths(a);
  return domain + fmt::format("graded: cells of {:.4g} to {:.4g} {}, neighbours within a factor of {:.4g}", w.smallest, w.largest, units, w.ratio);
}

std::vector<std::string> breach_lines(const PlanesReport& planes, const std::string& units) {
  constexpr size_t kMost = 20;
  std::vector<std::string> out;
  for (const PlaneBreach& b : planes.breaches) {
    if (out.size() == kMost) break;
    const std::string at = fmt::format("axis {} at {:.9g} {}: ", axis_name(b.axis), b.at, units);
    if (b.rule == PlaneBreach::Rule::kGrowth) out.push_back(fmt::format("{}neighbours differ by {:.4g}, more than {:.4g}", at, b.found, b.expected));
    else
      out.push_back(fmt::format("{}a cell is {:.4g} {} wide, {} than {:.4g} {}", at, b.found, units,
                                b.rule == PlaneBreach::Rule::kFinest ? "less" : "more", b.expected, units));
  }
  if (const uint64_t more = planes.breaches.size() - out.size() + planes.left_out; more > 0)
    out.push_back(fmt::format("and {} more places where two rules collide", fmt::group_digits(more)));
  return out;
}

void say_dry_run(const mesher::DryRun& run, int threads) {
  const Metadata& meta = run.plan.meta;
  auto write = [title = std::string()](const std::string& name, const std::string& text) mutable {
    say(fmt::format("{:<9}  {}", name == title ? "" : name, text));
    title = name;
  };
  write("cells", cells_text(meta.grid.cells()));
  for (int d = 0; d < 3; ++d) write("domain", axis_text(d, meta.grid.axis[d], meta.units));
  if (run.plan.planes) {
    const std::vector<std::string> breaches = breach_lines(*run.plan.planes, meta.units);
    if (breaches.empty()) write("planes", "all rules are held");
    for (const std::string& b : breaches) write("planes", b);
  }
  write("rays",
        fmt::format("along {}, about {} facet crossings of {} facets", axis_name(meta.ray_axis),
                    fmt::group_digits(static_cast<uint64_t>(std::min(run.plan.rays.crossings[meta.ray_axis], 1e18))), fmt::group_digits(run.facets)));
  const auto seconds = [](double s) { return s < 0.01 ? "less than 0.01" : "about " + number_text(s, 2); };
  write("estimates", fmt::format("{} s to read the surfaces, as now, and {} s to cast on {}; {} of memory, a file of {}; nothing was written",
                                 seconds(run.read_seconds), seconds(run.seconds), plural(static_cast<uint64_t>(threads), "thread"),
                                 bytes_text(run.memory_bytes), bytes_text(run.file_bytes)));
  if (run.plan.planes) warn_in_short(run.plan.planes->warnings, "more: mesh it, and see teracell info");
}

std::string overlaps_text(const Report& report) {
  if (!report.overlaps || report.overlaps->list.empty()) return "";
  const OverlapReport& most = report.overlaps->list[0];
  const uint64_t more = report.overlaps->pairs - 1;
  return fmt::format("{} and {} have {} cell{} in common, {}{}", most.bodies[0], most.bodies[1], fmt::group_digits(most.cells),
                     most.cells == 1 ? "" : "s", most.owner ? "owned by " + *most.owner : "some of them owned by a third body",
                     more == 0 ? "" : fmt::format("; {} overlap{} too", plural(more, "more pair"), more == 1 ? "s" : ""));
}

void say_grid(const std::string& output, const mesher::MeshReport& report) {
  const GridReader reader(output);
  const Index3 n = reader.meta().grid.cells();
  say(fmt::format("{}: {} cells in {:.2f} s, {}, {} of memory, rays along {}", output, cells_text(n), report.run.seconds(),
                  bytes_text(reader.file_bytes()), bytes_text(static_cast<double>(report.run.peak_memory_bytes)), axis_name(reader.meta().ray_axis)));
  if (const std::string longest = longest_text(report.scene, n); !longest.empty()) say("cells: " + longest);
  if (const std::string overlaps = overlaps_text(report.report); !overlaps.empty()) say("overlaps: " + overlaps);
  warn_in_short(report.warnings(), "more: see teracell info " + output);
}

void say_part(const std::string& part, const mesher::MeshReport& report) {
  say(fmt::format("{}: {:.2f} s, {}, {} of memory", part, report.run.seconds(), bytes_text(report.run.file_bytes),
                  bytes_text(static_cast<double>(report.run.peak_memory_bytes))));
}

// Indented for people, unless the report is so long that this would take too much memory.
void write_report(const mesher::MeshReport& report, OutputFile& file, const std::string& output) try {
  constexpr size_t kReadable = size_t{1} << 24;
  std::string text = report_json(report.report, report.scene, report.run, report.warnings());
  if (text.size() < kReadable) text = nlohmann::ordered_json::parse(text).dump(1);
  text += '\n';
  file.append({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
  file.commit();
} catch (const IoError& e) {
  throw IoError(fmt::format("{} ({} is complete all the same)", e.what(), output));
}

}  // namespace teracell::cli
