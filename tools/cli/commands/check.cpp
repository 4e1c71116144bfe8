// teracell check: what is wrong with a grid, or worth knowing.
#include <iostream>

#include <fmt/format.h>

#include "store/base/output_file.hpp"
#include "store/check/check.hpp"
#include "store/check/check_json.hpp"
#include "store/check/kept.hpp"
#include "store/read/kept_chunks.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/commands/check_grid.hpp"
#include "tools/cli/progress.hpp"

namespace teracell::cli {
namespace {

constexpr size_t kMostLines = 8;  // of a kind, as text

struct CheckArguments {
  GridArgument grid;
  std::string output, progress = "auto";
  CheckOptions options{.threads = 0};
  bool json = false;
};

void run(const CheckArguments& o) {
  const std::filesystem::path output = !o.output.empty()         ? std::filesystem::path(o.output)
                                       : is_address(o.grid.name) ? std::filesystem::path()
                                                                 : kept_findings(o.grid.name);
  if (!output.empty()) check_output({o.grid.name}, output.string());
  CheckOptions options = o.options;
  options.threads = threads_or_all(options.threads);
  const Findings findings = check_grid(o.grid, output, options, o.progress);
  if (o.json) {
    std::cout << findings_json(findings) << "\n";
    return;
  }
  say_findings(o.grid.name, findings);
  if (!output.empty()) {
    say("");
    say(fmt::format("All of it is in {}, which the dashboard shows.", output.string()));
  }
}

}  // namespace

Findings check_grid(const GridArgument& grid, const std::filesystem::path& output, const CheckOptions& options, const std::string& progress) {
  const Wanted wanted = until_interrupted(output.string());
  const GridReader reader = open_grid(grid, std::make_shared<KeptChunks>(kCheckKeeps));
  std::optional<OutputFile> file;
  if (!output.empty()) file.emplace(output);
  Findings findings;
  {
    ProgressLine line(progress, "");
    findings = check(reader, options, [&](double share) { line("check", share); });
  }
  if (file) {
    const std::string json = findings_json(findings) + "\n";
    file->append({reinterpret_cast<const uint8_t*>(json.data()), json.size()});
    file->commit();
  }
  return findings;
}

void say_findings(const std::string& grid, const Findings& findings) {
  const std::string text = grid + ": " + findings_text(findings, kMostLines);
  for (size_t from = 0; from <= text.size();) {
    const size_t end = std::min(text.find('\n', from), text.size());
    say(text.substr(from, end - from));
    from = end + 1;
  }
}

Run setup_check(CLI::App& app) {
  const auto o = std::make_shared<CheckArguments>();
  add_grid(app, o->grid);
  app.add_option("-o,--output", o->output, "where to keep what is found (default: beside the grid, as G.check.json; nowhere for an address)");
  app.add_option("--thin-cells", o->options.thin_cells, "walls that are thinner than this many cells are found (default 3)")->check(in_range(0, 8));
  app.add_option("--narrow-cells", o->options.narrow_cells,
                 "gaps of the background that are narrower than this many cells are found (default 0: none)")
      ->check(in_range(0, 8));
  add_threads(app, o->options.threads);
  app.add_flag("--json", o->json, "as JSON");
  add_progress(app, o->progress);
  app.footer(
      "The thickness of a wall is that of the largest balls in it, in cells: a step, or a pole that the grid grazes, is none.\n"
      "The exit status is 0 whatever is found. The dashboard shows what is kept beside the grid. Example:\n"
      "  teracell check g.tcell");
  return [o] { run(*o); };
}

}  // namespace teracell::cli
