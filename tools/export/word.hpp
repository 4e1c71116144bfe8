// Names for files of solvers, in which a name is a word.
#pragma once
#include <set>
#include <string>

#include <fmt/format.h>

namespace teracell::exports {

// The name with '_' for what is neither an ASCII letter, a digit, '-' nor '.': blanks, quotes, slashes, semicolons and braces end words
// in most files of solvers. It begins with a letter or '_', and is not one that is `taken`.
inline std::string word(const std::string& name, std::set<std::string>& taken) {
  std::string plain;
  for (const char c : name) plain += (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '-' || c == '.' ? c : '_';
  if (plain.empty() || (plain[0] >= '0' && plain[0] <= '9') || plain[0] == '-' || plain[0] == '.') plain.insert(0, "_");
  std::string out = plain;
  for (int i = 2; !taken.insert(out).second; ++i) out = fmt::format("{}_{}", plain, i);
  return out;
}

}  // namespace teracell::exports
