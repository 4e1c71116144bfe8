// What files of solvers have in common: lengths in metres, and names that are words.
#pragma once
#include <map>
#include <set>
#include <string>

#include <fmt/format.h>

#include "store/base/error.hpp"

namespace teracell::exports {

// The unit of a grid in metres. Throws UsageError, naming the solver, when it is a name of which no length is known.
inline double metres(const std::string& unit, const std::string& solver) {
  static const std::map<std::string, double> lengths = {{"m", 1},     {"cm", 0.01},   {"mm", 0.001}, {"um", 1e-6},
                                                        {"nm", 1e-9}, {"in", 0.0254}, {"ft", 0.3048}};
  const auto it = lengths.find(unit);
  if (it == lengths.end())
    throw UsageError(fmt::format("{}'s lengths are in metres: the grid's unit '{}' has no length that is known", solver, unit));
  return it->second;
}

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
