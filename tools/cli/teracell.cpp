// The program: finds the command, parses, runs, and turns what is thrown into an exit status and a paragraph on stderr.
#include <algorithm>
#include <iostream>

#include <fmt/format.h>

#include "tools/cli/commands.hpp"
#include "tools/cli/manual.hpp"
#include "tools/cli/notice.hpp"
#include "tools/cli/program.hpp"

namespace {

using namespace teracell;
using namespace teracell::cli;

int fail(int status, const std::string& message) {
  std::cout.flush();
  warn("teracell: " + message);
  return status;
}

int done() {
  std::cout.flush();
  return std::cout ? 0 : fail(1, "can't write to standard output");
}

}  // namespace

int main(int argc, char** argv) {
  begin_program();
  CLI::App app("Trillion-cell Cartesian grids from CAD surfaces: meshed, stored, looked at.", "teracell");
  app.set_version_flag("--version", TERACELL_VERSION);
  const auto print_notice = [] {
    const std::string_view text = notice();
    throw CLI::CallForVersion(std::string(text.substr(0, text.size() - 1)), 0);  // CLI11 adds the last newline
  };
  app.add_flag_callback("--licenses", print_notice, "Print what is embedded and linked, with its licences, and exit");
  app.require_subcommand(1);
  app.get_formatter()->label("SUBCOMMAND", "COMMAND");
  app.footer(
      "teracell COMMAND --help explains a command. Start with:\n"
      "  teracell sample stadium -o stadium\n"
      "  teracell mesh stadium/scene.json -o stadium.tcell\n"
      "  teracell slice stadium.tcell --axis z --at 3.5 -o plan.png");
  std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && words[0] == "help") {  // help mesh: mesh --help
    words.erase(words.begin());
    words.push_back("--help");
  }
  const bool writes_manual = words.size() == 2 && words[0] == "--write-manual";  // for the installation
  Run run;
  std::vector<std::string> names;
  for (const Command& c : commands()) {
    CLI::App* sub = app.add_subcommand(c.name, c.summary);
    sub->group("Commands");
    names.push_back(c.name);
    // To set up the options of all commands took nearly 1 ms of each start.
    if (writes_manual || std::ranges::count(words, c.name) > 0) sub->final_callback([&run, body = c.setup(*sub)] { run = body; });
  }
  try {
    if (words.empty()) {
      std::cerr << app.help();
      return 2;
    }
    if (writes_manual) {
      write_manual(app, words[1]);
      return done();
    }
    const bool has_command = !words[0].starts_with('-');
    if (has_command && std::ranges::count(names, words[0]) == 0)
      return fail(2, fmt::format("there is no command '{}'{} The commands are {}", words[0], did_you_mean(words[0], names), fmt::join(names, ", ")));
    refuse_unknown_options(has_command ? *app.get_subcommand(words[0]) : app, words);
    app.parse(std::vector(words.rbegin(), words.rend()));  // CLI11 takes them from the back
    run();
    return done();
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) {  // --help, --version, --licenses
      app.exit(e);
      return done();
    }
    const auto subs = app.get_subcommands();
    return fail(2,
                fmt::format("{}. See: teracell {}--help", explain(e, subs.empty() ? app : *subs[0]), subs.empty() ? "" : subs[0]->get_name() + " "));
  } catch (...) {
    const auto subs = app.get_subcommands();
    const Failure failure = current_failure(subs.empty() ? app : *subs[0]);
    return fail(failure.status, failure.message);
  }
}
