// teracell scene: a scene to edit, with a body for each part of assemblies and surfaces.
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mesher/scene/from_parts.hpp"
#include "mesher/surface/read_options.hpp"
#include "mesher/surface/units.hpp"
#include "store/base/error.hpp"
#include "store/base/output_file.hpp"
#include "store/text/text.hpp"
#include "tools/cli/command.hpp"

namespace teracell::cli {
namespace {

struct SceneArguments {
  std::vector<std::string> files;
  std::string output;
  std::optional<int64_t> cells;
  std::optional<double> step;
  std::string units;
  bool force = false;
  CadArguments cad;
};

void run(const SceneArguments& o) {
  check_output(o.files, o.output);
  if (o.cells && o.step) throw UsageError("--cells and --step exclude each other: give one of them");
  if (o.step && !(*o.step > 0)) throw UsageError(fmt::format("--step: expected a number above 0, found {}", *o.step));
  if (!o.units.empty() && !mesher::is_unit(o.units))
    throw UsageError(fmt::format("--units: expected m, cm, mm, um, nm, in or ft, found '{}'", o.units));
  std::error_code ignored;
  if (!o.force && std::filesystem::exists(o.output, ignored))
    throw UsageError(
        fmt::format("{}: expected a name that no file has, since scenes are edited by hand; found a file: --force replaces it", o.output));
  const std::atomic<bool>& interrupted = watch_interrupts();
  mesher::CadOptions cad = o.cad.options();
  cad.waiting = [&](double) {
    if (interrupted) throw Interrupted(fmt::format("{}: interrupted: nothing was written", o.output));
  };
  OutputFile file(o.output);
  const mesher::SceneText scene = mesher::scene_text({o.files.begin(), o.files.end()}, std::filesystem::path(o.output).parent_path(), o.cells, o.step,
                                                     o.units, mesher::modest_budget(), cad);
  file.append({reinterpret_cast<const uint8_t*>(scene.text.data()), scene.text.size()});
  file.commit();
  constexpr size_t kShown = 8;
  const std::vector<std::string> some(scene.guessed.begin(), scene.guessed.begin() + static_cast<ptrdiff_t>(std::min(scene.guessed.size(), kShown)));
  say(fmt::format("{}: {} of {}", o.output, scene.bodies == 1 ? "1 body" : fmt::format("{} bodies", scene.bodies),
                  plural(scene.materials, "material")));
  if (!some.empty())
    say(fmt::format("guessed, because no file names them: {}{}", fmt::join(some, ", "), scene.guessed.size() > kShown ? ", ..." : ""));
}

}  // namespace

Run setup_scene(CLI::App& app) {
  const auto o = std::make_shared<SceneArguments>();
  app.add_option("files", o->files, "assemblies and surfaces: 3MF, glTF, STEP, STL, OBJ, PLY, OFF")->required()->type_name("FILE");
  app.add_option("-o,--output", o->output, "the scene (.json) to write")->required();
  app.add_option("--cells", o->cells, "cubic cells, this many along the longest axis with its pad (default 200)")->check(in_range(3, 2147483646));
  app.add_option("--step", o->step, "the edge of a cell, in the units of the scene, which are those that the first file states");
  app.add_option("--units", o->units, "m, cm, mm, um, nm, in or ft (default: those that the first file states, else m)");
  add_cad_limits(app, o->cad);
  app.add_flag("--force", o->force, "replaces the file that has the name");
  app.footer("Example:\n  teracell scene assembly.3mf --cells 1000 -o scene.json\n  teracell mesh scene.json -o assembly.tcell");
  return [o] { run(*o); };
}

}  // namespace teracell::cli
