// The program: finds the command, parses, runs, and turns what is thrown into an exit status and a paragraph on stderr.
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <new>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>

#include "mesher/scene/names.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/hints.hpp"
#include "tools/cli/manual.hpp"
#include "tools/cli/notice.hpp"

namespace {

using namespace teracell;

constexpr const char* kNoRoom = "out of memory, or of threads: free some, or take fewer --threads, a smaller --region, or surfaces with fewer facets";

std::string did_you_mean(const std::string& word, const std::vector<std::string>& names) {
  const std::string_view near = nearest(word, {names.begin(), names.end()});
  return resembles(word, near) ? fmt::format("; did you mean {}?", near) : ".";
}

int fail(int status, const std::string& message) {
  std::cout.flush();
  warn("teracell: " + message);
  return status;
}

int done() {
  std::cout.flush();
  return std::cout ? 0 : fail(1, "can't write to standard output");
}

// A file that is opened while descriptor 0, 1 or 2 is closed would get that number, and then whatever is printed. Writing to a
// descriptor that is open for reading fails like writing to a closed one.
void occupy_standard_descriptors() {
  for (int fd = 0; fd <= 2; ++fd)
    if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", O_RDONLY) < 0) return;
}

// This comes before CLI11 parses: it would complain about what is missing and never name the option that it doesn't know.
void refuse_unknown_options(const CLI::App& app, const std::vector<std::string>& words) {
  std::vector<std::string> known;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  for (std::string word : words) {
    if (word == "--") return;
    if (word.starts_with("--")) word.resize(std::min(word.find('='), word.size()));
    else if (word.size() > 1 && word[0] == '-' && std::isalpha(static_cast<unsigned char>(word[1]))) word.resize(2);  // the rest is its value
    else continue;
    if (app.get_option_no_throw(word) == nullptr)
      throw UsageError(fmt::format("there is no option '{}'{} See: {} --help", word, word.starts_with("--") ? did_you_mean(word, known) : ".",
                                   app.get_parent() ? "teracell " + app.get_name() : "teracell"));
  }
}

// What CLI11 found wrong, worded like the other errors.
std::string explain(const CLI::ParseError& e, const CLI::App& app) {
  std::string text = e.what();
  const std::string required = " is required", convert = "Could not convert: ", twice = ": At Most 1 required but received ";
  if (text.ends_with(required)) {
    const std::string name = text.substr(0, text.size() - required.size());
    if (const CLI::Option* option = app.get_option_no_throw(name)) return fmt::format("missing {}: {}", name, option->get_description());
  }
  if (const size_t missing = text.find(": 1 required "); missing != std::string::npos)
    return text.substr(0, missing) + ": expected a value, found none";
  if (const size_t sign = text.find(twice); sign != std::string::npos)
    return fmt::format("{}: expected once, found {} times", text.substr(0, sign), text.substr(sign + twice.size()));
  if (text.starts_with("The following argument")) return fmt::format("expected nothing more, found '{}'", fmt::join(app.remaining(), " "));
  if (text.starts_with(convert)) {
    const size_t sign = text.find(" = ");
    const std::string name = text.substr(convert.size(), sign - convert.size());
    if (const CLI::Option* option = app.get_option_no_throw(name); option && sign != std::string::npos)
      return fmt::format("{}: expected a {}number, found '{}'", name, option->get_type_name().starts_with("FLOAT") ? "" : "whole ",
                         text.substr(sign + 3));
  }
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  occupy_standard_descriptors();
  std::signal(SIGPIPE, SIG_IGN);  // a reader that went away is a failed write, not the end
  std::signal(SIGXFSZ, SIG_IGN);  // so is a file that may not grow
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
  Run run;
  std::vector<std::string> names;
  for (const Command& c : commands()) {
    CLI::App* sub = app.add_subcommand(c.name, c.summary);
    sub->group("Commands");
    sub->final_callback([&run, body = c.setup(*sub)] { run = body; });
    names.push_back(c.name);
  }
  std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && words[0] == "help") {  // help mesh: mesh --help
    words.erase(words.begin());
    words.push_back("--help");
  }
  try {
    if (words.empty()) return fail(2, fmt::format("expected a command, found none: {}. See: teracell --help", fmt::join(names, ", ")));
    if (words.size() == 2 && words[0] == "--write-manual") {  // for the installation
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
  } catch (const UsageError& e) {
    return fail(2, with_hint(e));
  } catch (const Interrupted& e) {
    return fail(130, e.what());
  } catch (const std::bad_alloc&) {
    return fail(1, kNoRoom);
  } catch (const std::system_error& e) {
    return fail(1, e.code() == std::errc::resource_unavailable_try_again ? kNoRoom : e.what());  // a thread that didn't start
  } catch (const Error& e) {
    return fail(1, with_hint(e));
  } catch (const std::exception& e) {
    return fail(1, e.what());
  }
}
