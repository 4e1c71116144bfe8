// The program: finds the command, parses, runs, and turns what is thrown into an exit status and a paragraph on stderr.
#include <cstdio>
#include <iostream>
#include <new>

#include <fmt/format.h>

#include "mesher/scene_names.hpp"
#include "store/error.hpp"
#include "tools/command.hpp"

namespace {

using namespace teracell;

struct Command {
  const char* name;
  const char* summary;
  Run (*setup)(CLI::App&);
};

constexpr Command kCommands[] = {
    {"mesh", "mesh a scene or bare surfaces into a .tcell file", setup_mesh},
    {"info", "what a .tcell file holds", setup_info},
    {"slice", "one slice as a picture (.png) or an array (.npy)", setup_slice},
    {"column", "the runs of one column along any axis", setup_column},
    {"stats", "exact cells, volume and box of every material", setup_stats},
    {"export", "a box of cells as a dense array", setup_export},
    {"verify", "check every byte and every invariant of a file", setup_verify},
    {"sample", "write a built-in scene", setup_sample},
};

std::string did_you_mean(const std::string& word, const std::vector<std::string>& names) {
  return fmt::format("; did you mean {}?", nearest(word, {names.begin(), names.end()}));
}

int fail(int status, const std::string& message) {
  std::cout.flush();
  fmt::print(stderr, "teracell: {}\n", message);
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Trillion-cell Cartesian grids from CAD surfaces: meshed, stored, looked at.", "teracell");
  app.set_version_flag("--version", TERACELL_VERSION);
  app.require_subcommand(1);
  app.footer("teracell COMMAND --help explains a command. Start with:\n"
             "  teracell sample stadium -o stadium\n"
             "  teracell mesh stadium/scene.json -o stadium.tcell\n"
             "  teracell slice stadium.tcell --axis z --at 3.5 -o plan.png");
  Run run;
  std::vector<std::string> names;
  for (const Command& c : kCommands) {
    CLI::App* sub = app.add_subcommand(c.name, c.summary);
    sub->final_callback([&run, body = c.setup(*sub)] { run = body; });
    names.push_back(c.name);
  }
  try {
    if (argc > 1 && argv[1][0] != '-' && std::find(names.begin(), names.end(), argv[1]) == names.end())
      return fail(2, fmt::format("there is no command '{}'{} The commands are {}", argv[1], did_you_mean(argv[1], names), fmt::join(names, ", ")));
    app.parse(argc, argv);
    run();
    std::cout.flush();
    return std::cout ? 0 : fail(1, "can't write to standard output");
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // --help, --version
    const auto subs = app.get_subcommands();
    return fail(2, fmt::format("{}. See: teracell {}--help", e.what(), subs.empty() ? "" : subs[0]->get_name() + " "));
  } catch (const UsageError& e) {
    return fail(2, e.what());
  } catch (const Interrupted& e) {
    return fail(130, e.what());
  } catch (const std::bad_alloc&) {
    return fail(1, "out of memory");
  } catch (const std::exception& e) {
    return fail(1, e.what());
  }
}
