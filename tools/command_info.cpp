// teracell info: what a file holds.
#include <iostream>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "store/error.hpp"
#include "store/info.hpp"
#include "tools/command.hpp"

namespace teracell {
namespace {

using nlohmann::ordered_json;

struct Options {
  std::string grid;
  bool json = false;
};

void row(const std::string& name, const std::string& text) { say(fmt::format("{:<12}{}", name, text)); }

void print_report(const ordered_json& report) {
  std::string title = "bodies";
  for (const auto& b : report.value("bodies", ordered_json::array())) {
    std::string text = fmt::format("{}: {} in {}, {}, {} cells", b.at("name").get<std::string>(), counted(b.at("facets").get<uint64_t>(), "facet"),
                                   counted(b.at("shells").get<uint64_t>(), "shell"), b.at("fill").at(0).at("rule").get<std::string>(),
                                   b.contains("cells_text") ? b.at("cells_text").get<std::string>() : b.at("cells").dump());
    for (const char* flaw : {"degenerate", "duplicates"})
      if (const auto count = b.at(flaw).get<uint64_t>(); count > 0) text += fmt::format(", {} {}", count, flaw);
    row(std::exchange(title, ""), text);
  }
  title = "warnings";
  for (const auto& w : report.value("warnings", ordered_json::array())) row(std::exchange(title, ""), w.get<std::string>());
}

void print(const GridReader& reader) {
  const Metadata& meta = reader.meta();
  const Index3 n = meta.grid.cells();
  const double cells = static_cast<double>(n[0]) * static_cast<double>(n[1]) * static_cast<double>(n[2]);
  const auto size = static_cast<double>(reader.file_bytes());
  row("file", fmt::format("{}, {}, content {}", reader.name(), bytes_text(size), reader.hash()));
  row("cells", fmt::format("{} x {} x {} = {}{}", n[0], n[1], n[2], cell_count_text(n), cells < 1e6 ? "" : fmt::format(" ({:.3g})", cells)));
  for (int d = 0; d < 3; ++d) {
    const Axis& a = meta.grid.axis[d];
    row(d == 0 ? "domain" : "", fmt::format("{}  {:.8g} to {:.8g} {}, {}", axis_name(d), a.min(), a.max(), meta.units,
                                             a.is_graded() ? "graded" : fmt::format("cells of {:.6g} {}", a.step(), meta.units)));
  }
  row("rays", fmt::format("along {}, {} facet crossings, {:.2f} bits each on level 0", axis_name(meta.ray_axis), meta.crossings,
                          bits_per_crossing(meta)));
  row("dense", fmt::format("one byte a cell would take {}{}", bytes_text(cells),
                           cells < size ? "" : fmt::format(", {:.0f} times as much", cells / size)));
  size_t width = 0;
  for (const MaterialInfo& m : meta.materials) width = std::max(width, m.name.size());
  for (size_t i = 0; i < meta.materials.size(); ++i)
    row(i == 0 ? "materials" : "", fmt::format("{:>3}  {:<{}}  {}", i, meta.materials[i].name, width, meta.materials[i].color));
  for (int level = 0; level < reader.levels(); ++level) {
    const Index3 c = meta.grid.cells(level);
    std::string how = "derived when read";
    for (const LevelInfo& l : meta.levels)
      if (l.level == level) how = fmt::format("{:>9} {:<6} {:>10}", l.chunks, l.chunks == 1 ? "chunk" : "chunks", bytes_text(l.bytes));
    row(level == 0 ? "levels" : "", fmt::format("{:>3}  {:<24} {}", level, fmt::format("{} x {} x {}", c[0], c[1], c[2]), how));
  }
  try {
    print_report(ordered_json::parse(reader.report()));
  } catch (const ordered_json::exception&) {
    row("report", "is not laid out as this program lays it out");
  }
}

void run(const Options& o) {
  const GridReader reader(o.grid);
  if (!o.json) return print(reader);
  try {
    std::cout << info_json(reader).dump() << "\n";
  } catch (const ordered_json::parse_error&) {
    throw FormatError(fmt::format("{}: report: expected JSON, found something else", o.grid));
  }
}

}  // namespace

Run setup_info(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  app.add_option("grid", o->grid, "a .tcell file")->required();
  app.add_flag("--json", o->json, "as JSON");
  app.footer("Example:\n  teracell info g.tcell");
  return [o] { run(*o); };
}

}  // namespace teracell
