#include "tools/cli/commands/mesh_summary.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mesher/report/report_json.hpp"
#include "store/base/error.hpp"
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

}  // namespace

std::string cells_text(const Index3& n) {
  unsigned __int128 cells = 1;
  for (const int64_t along : n) cells *= static_cast<unsigned __int128>(along);
  return fmt::format("{} = {}", size_text(n), fmt::group_digits(cells));
}

std::string size_text(const Index3& n) {
  return fmt::format("{} x {} x {}", fmt::group_digits(n[0]), fmt::group_digits(n[1]), fmt::group_digits(n[2]));
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
  constexpr size_t kShown = 50;
  const GridReader reader(output);
  const Index3 n = reader.meta().grid.cells();
  say(fmt::format("{}: {} cells in {:.2f} s, {}, {} of memory, rays along {}", output, cells_text(n), report.run.seconds(),
                  bytes_text(reader.file_bytes()), bytes_text(static_cast<double>(report.run.peak_memory_bytes)), axis_name(reader.meta().ray_axis)));
  if (const std::string longest = longest_text(report.scene, n); !longest.empty()) say("cells: " + longest);
  if (const std::string overlaps = overlaps_text(report.report); !overlaps.empty()) say("overlaps: " + overlaps);
  const std::vector<std::string> warnings = report.warnings();
  for (size_t i = 0; i < std::min(warnings.size(), kShown); ++i) warn("warning: " + warnings[i]);
  if (warnings.size() > kShown) warn(fmt::format("warning: and {} more: see teracell info {}", warnings.size() - kShown, output));
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
