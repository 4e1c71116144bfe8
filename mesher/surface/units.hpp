// Units of length, and coordinates from one into another.
#pragma once
#include <cstdint>
#include <string_view>

namespace teracell::mesher {

// One unit is p / q of another, in lowest terms.
struct Factor {
  uint64_t p = 1, q = 1;
  bool is_one() const { return p == q; }
  double value() const { return static_cast<double>(p) / static_cast<double>(q); }
  // The coordinate times p / q, correctly rounded. REQUIRES: it is 0, or its magnitude is from 1e-75 to 1e75.
  double of(double coordinate) const;
};

// The units of scenes: m, cm, mm, um, nm, in, ft.
bool is_unit(std::string_view name);
// 1 when `to` is empty: then coordinates stay as they are. REQUIRES: is_unit() of the others.
Factor factor(std::string_view from, std::string_view to);

}  // namespace teracell::mesher
