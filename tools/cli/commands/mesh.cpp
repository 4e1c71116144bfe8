// teracell mesh: a scene or bare surfaces in, a .tcell file out.

#include <fmt/format.h>

#include "mesher/pipeline.hpp"
#include "store/base/error.hpp"
#include "store/base/output_file.hpp"
#include "store/base/system/system.hpp"
#include "store/check/kept.hpp"
#include "store/read/reader.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/commands/check_grid.hpp"
#include "tools/cli/commands/mesh_options.hpp"
#include "tools/cli/commands/mesh_summary.hpp"
#include "tools/cli/progress.hpp"

namespace teracell::cli {
namespace {

void run_dry(const MeshArguments& o, const mesher::Scene& scene) {
  for (const auto& [option, text] : {std::pair{"--report", &o.report}, {"--shard", &o.shard}, {"--write-caps", &o.caps}})
    if (!text->empty()) throw UsageError(fmt::format("{}: expected a run that writes a grid, found --dry-run", option));
  check_planes(o, scene);
  const std::atomic<bool>& interrupted = watch_interrupts();
  std::optional<mesher::DryRun> found;
  {
    ProgressLine line(o.progress, "mesh");
    found = dry_run(scene, mesh_options(o), std::ref(line), interrupted);
  }
  if (!o.write_planes.empty()) mesher::write_planes(found->plan.meta.grid, o.write_planes);
  say_dry_run(*found, threads_or_all(o.threads));
}

void run(const MeshArguments& o) {
  const mesher::Scene scene = scene_from(o);
  if (o.dry_run) return run_dry(o, scene);
  check_outputs(o, scene);
  const mesher::MeshOptions options = mesh_options(o);
  // What meshing a small surface takes. As much may stay in the heap of each thread, so it must be little of the memory.
  constexpr uint64_t kHeap = uint64_t{30} << 20;
  if (options.memory / static_cast<uint64_t>(threads_or_all(o.threads)) >= 8 * kHeap) system::make_heap(kHeap);
  if (options.shard && !o.report.empty()) throw UsageError("--report: expected a whole grid, found --shard: give it to `teracell merge`");
  if (options.shard && !o.write_planes.empty()) throw UsageError("--write-planes: expected a whole grid, found --shard: --dry-run writes them, too");
  if (options.shard && o.check) throw UsageError("--check: expected a whole grid, found --shard: run `teracell check` after `teracell merge`");
  const std::atomic<bool>& interrupted = watch_interrupts();
  std::optional<OutputFile> report_file;
  if (!o.report.empty()) report_file.emplace(o.report);
  const std::filesystem::path file = options.shard ? part_path(o.output, *options.shard) : std::filesystem::path(o.output);
  warn_of_leftovers(o, file);
  mesher::MeshReport report;
  {
    ProgressLine line(o.progress, "mesh");
    report = mesh(scene, o.output, options, std::ref(line), interrupted);
  }
  if (!options.shard || options.shard->number == 0) warn_of_caps(o, report);
  if (options.shard) return say_part(file.string(), report);
  if (!o.write_planes.empty()) mesher::write_planes(GridReader(o.output).meta().grid, o.write_planes);
  if (report_file) write_report(report, *report_file, o.output);
  say_grid(o.output, report);
  if (o.check) say_findings(o.output, check_grid({o.output, {}}, kept_findings(o.output), {.threads = threads_or_all(o.threads)}, o.progress));
}

}  // namespace

Run setup_mesh(CLI::App& app) {
  const auto o = std::make_shared<MeshArguments>();
  add_mesh_options(app, *o);
  app.footer(
      "Examples:\n  teracell mesh bust.obj --cells 10000 -o bust.tcell\n"
      "  teracell mesh scene.json --step 0.05 -o scene.tcell --report report.json");
  return [o] { run(*o); };
}

}  // namespace teracell::cli
