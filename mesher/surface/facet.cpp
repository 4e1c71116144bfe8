#include "mesher/surface/facet.hpp"

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {

double checked_coordinate(double v, const std::string& where) {
  if (is_coordinate(v)) return v + 0.0;
  throw InputError(!std::isfinite(v) ? fmt::format("{}: expected a finite coordinate, found {}", where, v)
                                     : fmt::format("{}: expected a coordinate that is 0 or has a magnitude from 1e-75 to 1e75, found {}", where, v));
}

std::string shown(std::string_view text) {
  constexpr size_t kLongest = 48;
  return fmt::format("'{}{}'", printable(text.substr(0, kLongest)), text.size() > kLongest ? "..." : "");
}

}  // namespace teracell::mesher
