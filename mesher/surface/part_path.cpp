#include "mesher/surface/part_path.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <deque>
#include <iterator>
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

bool is_ascii(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

// The characters of a text in UTF-8.
std::vector<std::string_view> characters(std::string_view text) {
  std::vector<std::string_view> out;
  for (size_t i = 0, next; i < text.size(); i = next) {
    for (next = i + 1; next < text.size() && (static_cast<unsigned char>(text[next]) & 0xc0) == 0x80;) ++next;
    out.push_back(text.substr(i, next - i));
  }
  return out;
}

// fnmatch() takes bytes for characters in the C locale, and at times in others. So the characters beyond ASCII that glob and text have are
// given a byte each, in their order, which that of UTF-8 is. With more of them than bytes, ? and [...] stand for bytes.
bool fits(const std::string& glob, const std::string& text) {
  const auto match = [](const std::string& g, const std::string& t) { return fnmatch(g.c_str(), t.c_str(), 0) == 0; };
  if (is_ascii(glob) && is_ascii(text)) return match(glob, text);
  const std::vector<std::string_view> of_glob = characters(glob), of_text = characters(text);
  std::vector<std::string_view> known;
  for (const auto* list : {&of_glob, &of_text})
    std::ranges::copy_if(*list, std::back_inserter(known), [](std::string_view c) { return !is_ascii(c); });
  std::ranges::sort(known);
  known.erase(std::ranges::unique(known).begin(), known.end());
  if (known.size() > 0x80) return match(glob, text);
  const auto coded = [&](const std::vector<std::string_view>& list) {
    std::string out;
    for (const std::string_view c : list) out += is_ascii(c) ? c[0] : static_cast<char>(0x80 + (std::ranges::lower_bound(known, c) - known.begin()));
    return out;
  };
  return match(coded(of_glob), coded(of_text));
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
  std::deque<std::string> others;  // the names that are given, where they stay
  std::unordered_set<std::string_view> given;
  std::vector<size_t> renamed;
  for (size_t i = 0; i < names.size(); ++i) {
    uint64_t& number = used[names[i]];
    if (++number == 1) continue;
    std::string& other = others.emplace_back();
    do other = fmt::format("{}#{}", names[i], number);
    while ((used.contains(other) || given.contains(other)) && ++number);
    given.insert(other);
    renamed.push_back(i);
  }
  for (size_t k = 0; k < renamed.size(); ++k) names[renamed[k]] = std::move(others[k]);
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
