#include "tools/cli/mesh_summary.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mesher/report_json.hpp"
#include "store/error.hpp"
#include "store/reader.hpp"
#include "tools/cli/command.hpp"

namespace teracell {

void say_grid(const std::string& output, const MeshReport& report) {
  constexpr size_t kShown = 50;
  const GridReader reader(output);
  const Index3 n = reader.meta().grid.cells();
  say(fmt::format("{}: {} x {} x {} = {:.4g} cells in {:.2f} s, {}, {} of memory, rays along {}", output, n[0], n[1], n[2],
                  static_cast<double>(n[0]) * static_cast<double>(n[1]) * static_cast<double>(n[2]), report.run.seconds(),
                  bytes_text(reader.file_bytes()), bytes_text(static_cast<double>(report.run.peak_memory_bytes)), axis_name(reader.meta().ray_axis)));
  const std::vector<std::string> warnings = report.warnings();
  for (size_t i = 0; i < std::min(warnings.size(), kShown); ++i) warn("warning: " + warnings[i]);
  if (warnings.size() > kShown) warn(fmt::format("warning: and {} more: see teracell info {}", warnings.size() - kShown, output));
}

void say_part(const std::string& part, const MeshReport& report) {
  say(fmt::format("{}: {:.2f} s, {}, {} of memory", part, report.run.seconds(), bytes_text(report.run.file_bytes),
                  bytes_text(static_cast<double>(report.run.peak_memory_bytes))));
}

// Indented for people, unless the report is so long that this would take too much memory.
void write_report(const MeshReport& report, OutputFile& file, const std::string& output) try {
  constexpr size_t kReadable = size_t{1} << 24;
  std::string text = report_json(report.report, report.scene, report.run, report.warnings());
  if (text.size() < kReadable) text = nlohmann::ordered_json::parse(text).dump(1);
  text += '\n';
  file.append({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
  file.commit();
} catch (const IoError& e) {
  throw IoError(fmt::format("{} ({} is complete all the same)", e.what(), output));
}

}  // namespace teracell
