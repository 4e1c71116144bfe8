// Numbers as messages show them.
#pragma once
#include <string>

#include "store/grid/grid.hpp"

namespace teracell::inline store {

// With so many significant digits, and all digits of the whole part: "0.0419", "1235", "2.73 × 10⁻¹⁶".
std::string number_text(double number, int digits);

// "(4, 1.5, -0.25)": plain ASCII, so that it can be copied into a command.
std::string place_text(const Vec3& place);

}  // namespace teracell::store
