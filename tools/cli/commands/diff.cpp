// teracell diff: which cells of two grids have different materials.
#include <iostream>

#include <fmt/format.h>

#include "store/text/text.hpp"
#include "store/whole/info.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/progress.hpp"

namespace teracell::cli {
namespace {

struct DiffArguments {
  std::string first, second, output, folder, progress = "auto";
  SourceOptions source;
  int threads = 0;
  bool json = false;
};

void print(const Difference& d) {
  if (d.changes.empty()) return say(fmt::format("the grids are equal: all of {} cells have the same material in both", fmt::group_digits(d.cells)));
  say(fmt::format("{} of {} cells differ, {} are the same", fmt::group_digits(d.cells - d.same), fmt::group_digits(d.cells),
                  fmt::group_digits(d.same)));
  size_t from = 4, to = 2, cells = 5;
  for (const Change& c : d.changes) {
    from = std::max(from, c.from.size()), to = std::max(to, c.to.size());
    cells = std::max(cells, fmt::formatted_size("{}", fmt::group_digits(c.cells)));
  }
  say(fmt::format("{:<{}}  {:<{}}  {:>{}}   box of cells", "from", from, "to", to, "cells", cells));
  for (const Change& c : d.changes) {
    const auto& [lo, hi] = c.box;
    say(fmt::format("{:<{}}  {:<{}}  {:>{}}   ({}, {}, {}) to ({}, {}, {})", c.from, from, c.to, to, fmt::group_digits(c.cells), cells, lo[0], lo[1],
                    lo[2], hi[0], hi[1], hi[2]));
  }
}

void run(const DiffArguments& o) {
  check_output({o.first, o.second}, o.output);
  const Wanted wanted = until_interrupted(o.output.empty() ? o.first : o.output);
  const GridReader first = open_grid({o.first, o.source}), second = open_grid({o.second, o.source});
  DifferenceOptions options;
  options.threads = threads_or_all(o.threads);
  options.output = o.output;
  options.folder = o.folder;
  Difference difference;
  {
    ProgressLine line(o.progress, "compare");
    const Index3 n = first.meta().grid.cells();
    line.set_cells(static_cast<double>(n[0]) * static_cast<double>(n[1]) * static_cast<double>(n[2]));
    difference = find_difference(first, second, options, [&](const char* phase, double share) { line(phase, share); });
  }
  if (o.json) std::cout << difference_json(difference) << "\n";
  else print(difference);
}

}  // namespace

Run setup_diff(CLI::App& app) {
  const auto o = std::make_shared<DiffArguments>();
  app.add_option("first", o->first, "a .tcell file, or the address of a grid: https://HOST/PATH or s3://BUCKET/KEY")->required();
  app.add_option("second", o->second, "a grid of the same cells; its rays and chunks may be others")->required();
  app.add_option("-o,--output", o->output, "a .tcell file to write, whose materials are the changes, such as 'air → steel', and 'same'");
  app.add_option("--tmp", o->folder, "the folder for temporary files, for --output (default: that of the output)");
  add_source_options(app, o->source);
  add_threads(app, o->threads);
  app.add_flag("--json", o->json, "as JSON");
  add_progress(app, o->progress);
  app.footer(
      "Materials are compared by their names. The counts are exact; they come from runs, without expanding a cell. The exit status is 0\n"
      "whether the grids differ or not. Example:\n  teracell diff before.tcell after.tcell -o changes.tcell");
  return [o] { run(*o); };
}

}  // namespace teracell::cli
