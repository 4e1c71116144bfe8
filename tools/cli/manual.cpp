#include "tools/cli/manual.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "store/base/output_file.hpp"

namespace teracell::cli {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  OutputFile file(path);
  file.append({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
  file.commit();
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

// Options with names, which a user may type.
std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* o) { return !o->get_positional() && !o->get_group().empty(); });
}

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& s : option.get_snames()) names.push_back("-" + s);
  for (const std::string& l : option.get_lnames()) names.push_back("--" + l);
  return names;
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

// ---- roff ----

// A line of text: no character of it may look like a request or an escape. roff has names for characters beyond ASCII: \[u2192].
std::string roff(const std::string& text) {
  std::string out;
  bool line_begins = true;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    if (const auto byte = static_cast<unsigned char>(c); byte >= 0xC0) {
      uint32_t code = byte & (byte >= 0xF0 ? 0x07 : byte >= 0xE0 ? 0x0F : 0x1F);
      for (; i + 1 < text.size() && (text[i + 1] & 0xC0) == 0x80; ++i) code = code << 6 | (text[i + 1] & 0x3F);
      out += fmt::format("\\[u{:04X}]", code);
    } else if (c == '\\') out += "\\e";
    else if (c == '-') out += "\\-";
    else out += c;
    line_begins = c == '\n';
  }
  return out;
}

std::string title(const std::string& name) {
  std::string upper = name;
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return fmt::format(".TH {} 1 \"\" \"teracell {}\" \"User Commands\"\n", roff(upper), TERACELL_VERSION);
}

std::string options_section(const CLI::App& app) {
  std::string out = ".SH OPTIONS\n";
  for (const CLI::Option* o : options_of(app)) {
    std::vector<std::string> names;
    for (const std::string& name : names_of(*o)) names.push_back("\\fB" + roff(name) + "\\fR");
    out += fmt::format(".TP\n{}{}\n{}.\n", fmt::join(names, ", "), takes_value(*o) ? " \\fI" + roff(o->get_type_name()) + "\\fR" : "",
                       roff(o->get_description()));
  }
  return out;
}

// The footer of a help: sentences, and lines to type, which are indented.
std::string footer_section(const CLI::App& app, const char* heading) {
  const std::string text = app.get_footer();
  if (text.empty()) return "";
  std::string out = fmt::format(".SH {}\n", heading);
  bool typed = false;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    const bool now = line.starts_with("  ");
    if (now != typed) out += now ? ".PP\n.nf\n.RS\n" : ".RE\n.fi\n.PP\n";
    typed = now;
    out += roff(now ? line.substr(2) : line) + "\n";
    begin = end + 1;
  }
  return out + (typed ? ".RE\n.fi\n" : "");
}

std::string page(const CLI::App& app) {
  std::string out = title("teracell") + ".SH NAME\nteracell \\- " + roff(app.get_description()) +
                    "\n.SH SYNOPSIS\n\\fBteracell\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR]\n.SH COMMANDS\n";
  for (const CLI::App* c : commands_of(app))
    out += fmt::format(".TP\n\\fBteracell\\-{}\\fR(1)\n{}.\n", roff(c->get_name()), roff(c->get_description()));
  return out + options_section(app) + footer_section(app, "EXAMPLES") +
         ".SH EXIT STATUS\n0 done; 1 the work failed; 2 wrong usage; 130 interrupted. An output file appears under its name only when it is complete.\n";
}

std::string page(const CLI::App& app, const CLI::App& command) {
  const std::string name = "teracell-" + command.get_name();
  std::string out = title(name) + fmt::format(".SH NAME\n{} \\- {}\n.SH SYNOPSIS\n\\fB{} {}\\fR", roff(name), roff(command.get_description()),
                                              app.get_name(), command.get_name());
  std::string positionals;
  for (const CLI::Option* o : command.get_options([](const CLI::Option* p) { return p->get_positional(); })) {
    const bool many = o->get_items_expected_max() > 1;
    out += fmt::format(" \\fI{}\\fR{}", roff(o->get_name(true)), many ? " ..." : "");
    positionals += fmt::format(".TP\n\\fI{}\\fR\n{}.\n", roff(o->get_name(true)), roff(o->get_description()));
  }
  return out + " [\\fIOPTIONS\\fR]\n.SH ARGUMENTS\n" + positionals + options_section(command) + footer_section(command, "NOTES") +
         ".SH SEE ALSO\n\\fBteracell\\fR(1)\n";
}

// ---- completions ----

std::vector<std::string> all_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* o : options_of(app))
    for (const std::string& n : names_of(*o)) names.push_back(n);
  return names;
}

std::string bash(const CLI::App& app) {
  std::vector<std::string> commands;
  std::string cases;
  for (const CLI::App* c : commands_of(app)) {
    commands.push_back(c->get_name());
    cases += fmt::format("    {}) words=\"{}\" ;;\n", c->get_name(), fmt::join(all_names(*c), " "));
  }
  return fmt::format(
      R"(# Completion of teracell for bash.
_teracell() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} words
  case ${{COMP_WORDS[1]}} in
{}    *) words="{} {}" ;;
  esac
  if [[ $COMP_CWORD -eq 1 || $current == -* ]]; then
    COMPREPLY=($(compgen -W "$words" -- "$current"))
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
  fi
}}
complete -o filenames -F _teracell teracell
)",
      cases, fmt::join(commands, " "), fmt::join(all_names(app), " "));
}

// A text in single quotes, for zsh and fish.
std::string quoted(const std::string& text, const char* quote) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? quote : std::string(1, c);
  return out + "'";
}

std::string zsh(const CLI::App& app) {
  const auto escaped = [](const std::string& text) {  // brackets and colons mean something in _arguments
    std::string out;
    for (const char c : text) out += c == '[' || c == ']' || c == ':' || c == '\\' ? std::string("\\") + c : std::string(1, c);
    return out;
  };
  const auto arguments = [&](const CLI::App& of) {
    std::string out;
    for (const CLI::Option* o : options_of(of))
      for (const std::string& n : names_of(*o))
        out += " " + quoted(fmt::format("{}[{}]{}", n, escaped(o->get_description()), takes_value(*o) ? ":value:_files" : ""), "'\\''");
    return out;
  };
  std::string list, cases;
  for (const CLI::App* c : commands_of(app)) {
    list += " " + quoted(c->get_name() + ":" + escaped(c->get_description()), "'\\''");
    cases += fmt::format("    {}) _arguments{} '*:file:_files' ;;\n", c->get_name(), arguments(*c));
  }
  return fmt::format(
      R"(#compdef teracell
# Completion of teracell for zsh.
local -a commands
commands=({})
if (( CURRENT == 2 )); then
  _describe command commands
else
  shift words; (( CURRENT-- ))
  case $words[1] in
{}  esac
fi
)",
      list, cases);
}

std::string fish(const CLI::App& app) {
  std::string out = "# Completion of teracell for fish.\n";
  const auto options = [&](const CLI::App& of, const std::string& when) {
    for (const CLI::Option* o : options_of(of)) {
      out += "complete -c teracell -n " + when;
      for (const std::string& s : o->get_snames()) out += " -s " + s;
      for (const std::string& l : o->get_lnames()) out += " -l " + l;
      out += (takes_value(*o) ? " -r" : "") + std::string(" -d ") + quoted(o->get_description(), "\\'") + "\n";
    }
  };
  options(app, "__fish_use_subcommand");
  for (const CLI::App* c : commands_of(app)) {
    out += fmt::format("complete -c teracell -f -n __fish_use_subcommand -a {} -d {}\n", c->get_name(), quoted(c->get_description(), "\\'"));
    options(*c, fmt::format("'__fish_seen_subcommand_from {}'", c->get_name()));
  }
  return out;
}

}  // namespace

void write_manual(const CLI::App& app, const fs::path& folder) {
  write(folder / "man1/teracell.1", page(app));
  for (const CLI::App* c : commands_of(app)) write(folder / ("man1/teracell-" + c->get_name() + ".1"), page(app, *c));
  write(folder / "bash/teracell", bash(app));
  write(folder / "zsh/_teracell", zsh(app));
  write(folder / "fish/teracell.fish", fish(app));
}

}  // namespace teracell::cli
