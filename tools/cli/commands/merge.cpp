// teracell merge: the parts of a grid in, the grid out.
#include <fmt/format.h>

#include "mesher/parts/merge.hpp"
#include "store/base/error.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/commands/mesh_summary.hpp"
#include "tools/cli/progress.hpp"

namespace teracell::cli {
namespace {

struct MergeArguments {
  std::vector<std::string> parts;
  std::string output, report, progress = "auto";
};

void run(const MergeArguments& o) {
  if (!o.report.empty() && o.report == o.output) throw UsageError(fmt::format("--report and --output name the same file, {}", o.output));
  for (const std::string& output : {o.output, o.report}) check_output(o.parts, output);
  const std::atomic<bool>& interrupted = watch_interrupts();
  std::optional<OutputFile> report_file;
  if (!o.report.empty()) report_file.emplace(o.report);
  mesher::MeshReport report;
  {
    ProgressLine line(o.progress, "merge");
    report = mesher::merge({o.parts.begin(), o.parts.end()}, o.output, std::ref(line), interrupted);
  }
  if (report_file) write_report(report, *report_file, o.output);
  say_grid(o.output, report);
}

}  // namespace

Run setup_merge(CLI::App& app) {
  const auto o = std::make_shared<MergeArguments>();
  app.add_option("parts", o->parts, "all parts of a grid, in any order; `teracell mesh --shard` makes them")->required();
  app.add_option("-o,--output", o->output, "the .tcell file to write; it has the bytes that one run would have written")->required();
  app.add_option("--report", o->report, "write the report, as JSON");
  add_progress(app, o->progress);
  app.footer("Example:\n  for i in 0 1 2 3; do teracell mesh scene.json -o g.tcell --shard $i/4; done\n  teracell merge g.tcell.shard-* -o g.tcell");
  return [o] { run(*o); };
}

}  // namespace teracell::cli
