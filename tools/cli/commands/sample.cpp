// teracell sample: writes a built-in scene.
#include <fmt/format.h>

#include "store/base/error.hpp"
#include "tools/cli/command.hpp"
#include "tools/sample/stadium.hpp"

namespace teracell::cli {
namespace {

struct SampleArguments {
  std::string name, output;
};

void run(const SampleArguments& o) {
  if (o.name != "stadium") throw UsageError(fmt::format("there is no sample '{}': expected stadium", o.name));
  sample::write_stadium(o.output);
  say(fmt::format("{}: ten closed STL bodies and scene.json. Mesh it with: teracell mesh {}/scene.json -o stadium.tcell", o.output, o.output));
}

}  // namespace

Run setup_sample(CLI::App& app) {
  const auto o = std::make_shared<SampleArguments>();
  app.add_option("name", o->name, "which sample: stadium (air, explosive, grandstand, structure)")->required();
  app.add_option("-o,--output", o->output, "the folder to write to")->required();
  app.footer("Example:\n  teracell sample stadium -o stadium");
  return [o] { run(*o); };
}

}  // namespace teracell::cli
