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
  int threads = 0;
  bool json = false;
};

void run(const CheckArguments& o) {
  const std::filesystem::path output = !o.output.empty()         ? std::filesystem::path(o.output)
                                       : is_address(o.grid.name) ? std::filesystem::path()
                                                                 : kept_findings(o.grid.name);
  if (!output.empty()) refuse_overwriting({o.grid.name}, output.string());
  const Findings findings = check_grid(o.grid, output, threads_or_all(o.threads), o.progress);
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

Findings check_grid(const GridArgument& grid, const std::filesystem::path& output, int threads, const std::string& progress) {
  const Wanted wanted = until_interrupted(output.string());
  const GridReader reader = open_grid(grid, std::make_shared<KeptChunks>(kCheckKeeps));
  std::optional<OutputFile> file;
  if (!output.empty()) file.emplace(output);
  Findings findings;
  {
    ProgressLine line(progress, "");
    findings = check(reader, threads, [&](double share) { line("check", share); });
    findings.cells_hash = reader.cells_hash();
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
  add_threads(app, o->threads);
  app.add_flag("--json", o->json, "as JSON");
  add_progress(app, o->progress);
  app.footer(
      "Walls are measured in cells, exactly, from runs. The exit status is 0 whatever is found. The dashboard shows what is kept beside the\n"
      "grid. Example:\n  teracell check g.tcell");
  return [o] { run(*o); };
}

}  // namespace teracell::cli
