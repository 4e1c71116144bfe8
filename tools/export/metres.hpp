// Lengths of solvers that know metres alone.
#pragma once
#include <map>
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

}  // namespace teracell::exports
