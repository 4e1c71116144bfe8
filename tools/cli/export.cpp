// teracell export: a box of cells in a format of other programs.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "store/error.hpp"
#include "tools/cli/command.hpp"
#include "tools/export/formats.hpp"

namespace teracell {
namespace {

struct ExportArguments {
  std::string grid, output, format, region;
  int level = 0;
};

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const ExportFormat& format : export_formats()) names.push_back(format.name);
  return names;
}

std::string list_of_formats() {
  std::string list;
  for (const ExportFormat& f : export_formats())
    list += fmt::format("{}{:<8} {:<12} {}", list.empty() ? "" : "\n", f.name, fmt::join(f.extensions, " "), f.holds);
  return list;
}

const ExportFormat& format_of(const ExportArguments& o) {
  if (const ExportFormat* named = o.format.empty() ? export_format_of(o.output) : export_format_named(o.format)) return *named;
  std::vector<std::string> extensions;
  for (const ExportFormat& format : export_formats()) extensions.insert(extensions.end(), format.extensions.begin(), format.extensions.end());
  throw UsageError(fmt::format("--output: expected a name that ends in {}, or --format, found '{}'", fmt::join(extensions, " or "), o.output));
}

void run(const ExportArguments& o) {
  const ExportFormat& format = format_of(o);
  refuse_overwriting({o.grid}, o.output);
  const GridReader reader(o.grid);
  const Grid& grid = reader.meta().grid;
  check_level(grid, o.level);
  const Box box = o.region.empty() ? grid.box(o.level) : parse_region(o.region, grid, o.level);
  const std::atomic<bool>& stop = watch_interrupts();  // before there is a file to leave behind
  format.write({reader, o.level, box, o.output, [&](double) { stop_if(stop, o.output); }});
}

}  // namespace

Run setup_export(CLI::App& app) {
  const auto o = std::make_shared<ExportArguments>();
  app.add_option("grid", o->grid, "a .tcell file")->required();
  app.add_option("-o,--output", o->output, "the file to write")->required();
  app.add_option("--format", o->format, fmt::format("{} (default: by the ending of the name)", fmt::join(format_names(), ", ")))
      ->check(one_of(format_names()));
  app.add_option("--region", o->region, "X0,Y0,Z0,X1,Y1,Z1: half open, in cells of the level (default: all)");
  app.add_option("--level", o->level, "the level of the pyramid (default 0)");
  app.add_flag_callback(
      "--list", [] { throw CLI::CallForVersion(list_of_formats(), 0); }, "Print the formats and exit");
  app.footer(
      "Arrays hold material ids in C order [z][y][x]: uint8, or uint16 when there are more than 256 materials. Example:\n"
      "  teracell export g.tcell --region 0,0,0,256,256,256 -o box.npy");
  return [o] { run(*o); };
}

}  // namespace teracell
