#include "tools/cli/program.hpp"

#include <algorithm>
#include <csignal>
#include <new>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>

#include "mesher/scene/names.hpp"
#include "store/text/text.hpp"
#include "tools/cli/hints.hpp"

namespace teracell::cli {
namespace {

// What takes less, of what the command has.
std::string no_room(const CLI::App& command) {
  constexpr std::pair<const char*, const char*> kWays[] = {
      {"--threads", "fewer --threads"}, {"--region", "a smaller --region"}, {"--ranks", "fewer --ranks"}, {"--fill", "surfaces with fewer facets"}};
  std::string ways;
  for (const auto& [option, way] : kWays)
    if (command.get_option_no_throw(option)) ways += fmt::format("{}{}", ways.empty() ? ", or take " : " or ", way);
  return "out of memory, or of threads: free some" + ways;
}

// A file that is opened while descriptor 0, 1 or 2 is closed would get that number, and then whatever is printed. Writing to a
// descriptor that is open for reading fails like writing to a closed one.
void occupy_standard_descriptors() {
  for (int fd = 0; fd <= 2; ++fd)
    if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", O_RDONLY) < 0) return;
}

}  // namespace

void begin_program() {
  occupy_standard_descriptors();
  std::signal(SIGPIPE, SIG_IGN);  // a reader that went away is a failed write, not the end
  std::signal(SIGXFSZ, SIG_IGN);  // so is a file that may not grow
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& names) {
  const std::string_view near = nearest(word, std::vector<std::string_view>(names.begin(), names.end()));
  return resembles(word, near) ? fmt::format("; did you mean {}?", near) : ".";
}

void refuse_unknown_options(const CLI::App& app, const std::vector<std::string>& words) {
  std::vector<std::string> known;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  bool is_value = false;  // of the option before, even if it begins with a minus: "--view -x"
  for (std::string word : words) {
    if (word == "--") return;
    if (std::exchange(is_value, false) && !word.starts_with("--")) continue;
    const bool with_value = word.starts_with("--") ? word.find('=') != std::string::npos : word.size() > 2;
    if (word.starts_with("--")) word.resize(std::min(word.find('='), word.size()));
    else if (word.size() > 1 && word[0] == '-' && std::isalpha(static_cast<unsigned char>(word[1]))) word.resize(2);  // the rest is its value
    else continue;
    if (app.get_option_no_throw(word) == nullptr)
      throw UsageError(fmt::format("there is no option '{}'{} See: {} --help", word, word.starts_with("--") ? did_you_mean(word, known) : ".",
                                   app.get_parent() ? app.get_parent()->get_name() + " " + app.get_name() : app.get_name()));
    is_value = !with_value && app.get_option_no_throw(word)->get_items_expected_min() > 0;
  }
}

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

Failure current_failure(const CLI::App& command) {
  try {
    throw;
  } catch (const UsageError& e) {
    return {2, with_hint(e)};
  } catch (const Interrupted& e) {
    return {130, e.what()};
  } catch (const std::bad_alloc&) {
    return {1, no_room(command)};
  } catch (const std::system_error& e) {
    return {1, e.code() == std::errc::resource_unavailable_try_again ? no_room(command) : e.what()};  // a thread that didn't start
  } catch (const Error& e) {
    return {1, with_hint(e)};
  } catch (const std::exception& e) {
    return {1, e.what()};
  }
}

}  // namespace teracell::cli
