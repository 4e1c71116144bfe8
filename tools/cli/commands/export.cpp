// teracell export: a box of cells in a format of other programs.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "store/base/error.hpp"
#include "store/refine/leaf_table.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/progress.hpp"
#include "tools/export/assignments.hpp"
#include "tools/export/formats.hpp"
#include "tools/export/refined/refined.hpp"

namespace teracell::cli {
namespace {

struct ExportArguments {
  GridArgument grid;
  std::string output, format, progress = "auto";
  std::optional<std::string> region, map;  // given and empty is a mistake of a script
  int level = 0;
  bool count = false, json = false;
  std::map<std::string, std::string> of_formats;  // the options that only some formats take
};

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const exports::ExportFormat& format : exports::export_formats()) names.push_back(format.name);
  return names;
}

std::string typed(const exports::ExportOption& o) { return o.argument.empty() ? o.name : o.name + " " + o.argument; }

std::string list_of_formats() {
  std::string list;
  for (const exports::ExportFormat& f : exports::export_formats()) {
    list += fmt::format("{}{:<10} {:<16} {}", list.empty() ? "" : "\n", f.name, fmt::format("{}", fmt::join(f.extensions, " ")), f.holds);
    for (const exports::ExportOption& o : f.options) list += fmt::format("\n{:27}   {}: {}", "", typed(o), o.help);
  }
  return list;
}

const exports::ExportFormat& format_of(const ExportArguments& o) {
  if (const exports::ExportFormat* named = o.format.empty() ? exports::export_format_of(o.output) : exports::export_format_named(o.format))
    return *named;
  std::vector<std::string> extensions;
  for (const exports::ExportFormat& format : exports::export_formats())
    extensions.insert(extensions.end(), format.extensions.begin(), format.extensions.end());
  throw UsageError(fmt::format("--output: expected a name that ends in {}, or --format (see teracell export --list), found '{}'",
                               fmt::join(extensions, " or "), o.output));
}

// The number of each material of the grid by --map, which must name all that are written.
std::vector<uint32_t> numbers_of(const std::string& map, const GridReader& reader, int level, const Box& box, const exports::ExportFormat& format) {
  const std::vector<MaterialInfo>& materials = reader.meta().materials;
  std::vector<uint32_t> numbers(materials.size(), 0);
  const auto take = [&](size_t id, const std::string& name, const std::string& text) {
    numbers[id] = static_cast<uint32_t>(parse_integer(text, 0, 0xffffffff, "--map: " + name));
  };
  const std::vector<bool> named = exports::for_each_assignment(materials, map, "--map", take);
  if (format.coarser) exports::expect_named(reader, 0, reader.meta().grid.box(0), named, "--map");  // the cell of the last level has them all
  else exports::expect_named(reader, level, box, named, "--map");
  return numbers;
}

void expect_options(const ExportArguments& o, const std::vector<exports::ExportOption>& options, const std::string& whose) {
  for (const auto& [name, value] : o.of_formats)
    if (std::ranges::count(options, name, &exports::ExportOption::name) == 0) {
      std::vector<std::string> with;
      for (const exports::ExportFormat& format : exports::export_formats())
        if (std::ranges::count(format.options, name, &exports::ExportOption::name) > 0) with.push_back(format.name);
      throw UsageError(fmt::format("{}: {} has no such option; with it: {}", name, whose, fmt::join(with, ", ")));
    }
}

void check_options(const ExportArguments& o, const exports::ExportFormat& format) {
  expect_options(o, format.options, "the format " + format.name);
  if (o.json) throw UsageError("--json: expected --count with it");
  if (o.map && !format.numbers)
    throw UsageError(fmt::format("--map: the format {} names materials or has the ids of the grid, which a map can't change", format.name));
}

// How many leaves there would be, whatever the format.
void count_leaves(const ExportArguments& o) {
  expect_options(o, exports::refined_options(), "--count");
  if (o.map) throw UsageError("--map: expected none with --count, which names materials");
  if (!o.of_formats.contains("--refine")) throw UsageError("--count: expected --refine M,N with it, found none");
  const GridReader reader = open_grid(o.grid);
  const Metadata& meta = reader.meta();
  const Box box = !o.region ? meta.grid.box(0) : parse_region(*o.region, meta.grid, 0);
  const Wanted wanted = until_interrupted(o.grid.name, "nothing was counted");
  std::optional<LeafTable> table;
  {
    ProgressLine line(o.progress, "count");
    const auto progress = [&](double share) { line("count", share); };
    const exports::RefinedGrid grid({reader, o.level, box, "", progress, {}, o.of_formats}, 0.5);
    table.emplace(meta, grid.refinement(), grid.leaves().count(box, grid.threads(), [&](double share) { progress((1 + share) / 2); }));
  }
  if (o.json) return say(table->json());
  for (const std::string& row : table->rows()) say(row);
}

void run(const ExportArguments& o) {
  if (o.count) return count_leaves(o);
  if (o.output.empty()) throw UsageError("--output: expected the file or folder to write, found none");
  const exports::ExportFormat& format = format_of(o);
  check_options(o, format);
  check_output({o.grid.name}, o.output);
  const GridReader reader = open_grid(o.grid);
  const Grid& grid = reader.meta().grid;
  check_level(grid, o.level);
  const Box box = !o.region ? grid.box(o.level) : parse_region(*o.region, grid, o.level);
  const Wanted wanted = until_interrupted(o.output);  // before there is a file to leave behind
  const std::vector<uint32_t> map = !o.map ? std::vector<uint32_t>() : numbers_of(*o.map, reader, o.level, box, format);
  std::vector<std::string> told;
  {
    ProgressLine line(o.progress, "export");
    double cells = 1;
    for (int d = 0; d < 3; ++d) cells *= static_cast<double>(box.hi[d] - box.lo[d]);
    line.set_cells(cells);
    const auto progress = [&](double share) { line("export", share); };
    format.write({reader, o.level, box, o.output, progress, map, o.of_formats, [&](const std::string& sentence) { told.push_back(sentence); }});
  }
  for (const std::string& sentence : told) say(sentence);
}

}  // namespace

Run setup_export(CLI::App& app) {
  const auto o = std::make_shared<ExportArguments>();
  add_grid(app, o->grid);
  app.add_option("-o,--output", o->output, "the file or folder to write (needed unless with --count)");
  app.add_option("--format", o->format, fmt::format("{} (default: by the ending of the name)", fmt::join(format_names(), ", ")))
      ->check(one_of(format_names()));
  app.add_option("--region", o->region, "X0,Y0,Z0,X1,Y1,Z1: half open, in cells of the level (default: all)");
  app.add_option("--level", o->level, "the level of the pyramid (default 0)");
  app.add_option("--map", o->map, "NAME=NUMBER,...: the number to write for each material (default: its id)");
  app.add_flag("--count", o->count, "with --refine: print how many leaves there are by level and material, and write nothing");
  app.add_flag("--json", o->json, "with --count: print that as JSON");
  add_progress(app, o->progress);
  std::map<std::string, std::pair<exports::ExportOption, std::vector<std::string>>> options;  // formats may share one
  for (const exports::ExportFormat& format : exports::export_formats())
    for (const exports::ExportOption& option : format.options)
      options.try_emplace(option.name, option, std::vector<std::string>()).first->second.second.push_back(format.name);
  for (const auto& [name, option] : options) {
    const std::string help = fmt::format("{}: {}", fmt::join(option.second, ", "), option.first.help);
    add_word(app, name, option.first.argument, help, [o, key = name](const std::string& value) { o->of_formats[key] = value; });
  }
  app.add_flag_callback(
      "--list", [] { throw CLI::CallForVersion(list_of_formats(), 0); }, "Print the formats and exit");
  app.footer(
      "Arrays hold material ids in C order [z][y][x]: uint8, or uint16 when there are more than 256 materials. Example:\n"
      "  teracell export g.tcell --region 0,0,0,256,256,256 -o box.npy");
  return [o] { run(*o); };
}

}  // namespace teracell::cli
