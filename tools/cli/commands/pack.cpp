// teracell pack: the same cells laid out for reading from far away.
#include "store/whole/pack.hpp"

#include <fmt/format.h>

#include "store/base/output_file.hpp"
#include "store/check/kept.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/progress.hpp"

namespace teracell::cli {
namespace {

struct PackArguments {
  GridArgument grid;
  std::string output, progress = "auto";
  bool smaller = false;
  int threads = 0;
};

// What was found in the cells goes with them, if it can: the packed grid is complete without it.
void keep_findings(const PackArguments& o) try {
  std::string found = read_kept_findings(o.grid.name, GridReader(o.output));
  if (found.empty()) return;
  found += '\n';
  OutputFile file(kept_findings(o.output));
  file.append({reinterpret_cast<const uint8_t*>(found.data()), found.size()});
  file.commit();
} catch (const IoError& e) {
  warn(fmt::format("warning: {} does not get what was found in the cells of {}: {}", o.output, o.grid.name, e.what()));
}

void run(const PackArguments& o) {
  check_output({o.grid.name}, o.output);
  const GridReader reader = open_grid(o.grid);
  const Wanted wanted = until_interrupted(o.output);
  ProgressLine line(o.progress, "");
  pack(reader, o.output, {!o.smaller, threads_or_all(o.threads)}, [&](double share) { line("pack", share); });
  if (!is_address(o.grid.name)) keep_findings(o);
}

}  // namespace

Run setup_pack(CLI::App& app) {
  const auto o = std::make_shared<PackArguments>();
  add_grid(app, o->grid);
  app.add_option("-o,--output", o->output, "the .tcell file to write")->required();
  app.add_flag("--smaller", o->smaller, "leave out level 1, which a viewer then makes of four times the bytes that other levels take");
  add_threads(app, o->threads);
  add_progress(app, o->progress);
  app.footer(
      "The cells stay the same. What leads to them lies at the end of the file, and neighbours lie together, so a viewer far away needs few\n"
      "requests. Offsets change, and so does the content's hash; what `teracell check` has found goes with the cells. Example:\n  teracell pack g.tcell -o packed.tcell");
  return [o] { run(*o); };
}

}  // namespace teracell::cli
