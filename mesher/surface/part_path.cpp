#include "mesher/surface/part_path.hpp"

#include <fnmatch.h>
#include <locale.h>

#include <algorithm>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>

namespace teracell::mesher {
namespace {

constexpr std::string_view kSpecial = "/*?[\\";
constexpr char kSlashOfName = '\x01';  // stands for a / that is part of a name, where others part names

// A path as a text for fnmatch(): without escapes, each / of a name replaced.
std::string coded_path(std::string_view path) {
  std::string out;
  for (size_t i = 0; i < path.size(); ++i) {
    if (path[i] == '\\' && i + 1 < path.size()) out += path[++i] == '/' ? kSlashOfName : path[i];
    else out += path[i];
  }
  return out;
}

// A glob for such texts: only an escaped / changes.
std::string coded_glob(std::string_view glob) {
  std::string out;
  for (size_t i = 0; i < glob.size(); ++i) {
    if (glob[i] != '\\' || i + 1 == glob.size()) out += glob[i];
    else if (glob[++i] == '/') out += kSlashOfName;
    else out.append({'\\', glob[i]});
  }
  return out;
}

bool has_wildcard(std::string_view glob) {
  for (size_t i = 0; i < glob.size(); ++i) {
    if (glob[i] == '\\') ++i;
    else if (glob[i] == '*' || glob[i] == '?' || glob[i] == '[') return true;
  }
  return false;
}

bool is_ascii(const std::string& text) {
  return std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

// ? and [...] stand for a character, which fnmatch() knows by the locale of the thread.
bool fits(const std::string& glob, const std::string& text) {
  static const locale_t utf8 = newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr);
  const bool ascii = is_ascii(glob) && is_ascii(text);
  const locale_t before = ascii || !utf8 ? nullptr : uselocale(utf8);
  const bool out = fnmatch(glob.c_str(), text.c_str(), 0) == 0;
  if (before) uselocale(before);
  return out;
}

}  // namespace

std::string escaped(std::string_view name) {
  std::string out;
  for (const char c : name) {
    if (kSpecial.find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

std::string path_below(std::string_view parent, std::string_view name) { return fmt::format("{}/{}", parent, escaped(name)); }

std::vector<std::string> names_of(std::string_view path) {
  std::vector<std::string> out;
  for (size_t i = 0; i < path.size(); ++i) {
    if (path[i] == '/') {
      out.emplace_back();
      continue;
    }
    if (path[i] == '\\' && i + 1 < path.size()) ++i;
    if (out.empty()) out.emplace_back();
    out.back() += path[i];
  }
  return out;
}

std::vector<std::string> told_apart(std::vector<std::string> names) {
  std::unordered_map<std::string_view, uint64_t> used;  // how often, or the last number that was given
  for (const std::string& name : names) used.try_emplace(name);
  std::unordered_set<std::string> given;
  std::vector<std::pair<size_t, std::string>> renamed;
  for (size_t i = 0; i < names.size(); ++i) {
    uint64_t& number = used[names[i]];
    if (++number == 1) continue;
    std::string other;
    while (used.contains(other = fmt::format("{}#{}", names[i], number)) || !given.insert(other).second) ++number;
    renamed.emplace_back(i, std::move(other));
  }
  for (auto& [i, name] : renamed) names[i] = std::move(name);
  return names;
}

std::string_view without_number(std::string_view name) {
  const size_t sharp = name.rfind('#');
  const bool numbered = sharp != std::string_view::npos && sharp > 0 && sharp + 1 < name.size() &&
                        name.find_first_not_of("0123456789", sharp + 1) == std::string_view::npos;
  return numbered ? name.substr(0, sharp) : name;
}

PartGlob::PartGlob(std::string glob) : glob_(std::move(glob)), coded_(coded_glob(glob_)), is_path_(glob_.starts_with('/') && !has_wildcard(glob_)) {}

bool PartGlob::matches(std::string_view path) const {
  if (takes_all()) return true;
  const std::string coded = coded_path(path);
  if (fits(coded_, coded)) return true;
  return !glob_.starts_with('/') && fits(coded_, coded.substr(coded.rfind('/') + 1));
}

bool PartGlob::matches_name(const std::string& name) const {
  if (takes_all() || fits(glob_, name)) return true;
  return glob_.starts_with('/') && matches(path_below("", name.empty() ? kUnnamedPart : name));
}

}  // namespace teracell::mesher
