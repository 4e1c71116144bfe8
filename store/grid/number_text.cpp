#include "store/grid/number_text.hpp"

#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

namespace teracell::inline store {

std::string number_text(double number, int digits) {
  std::string rounded = fmt::format("{:.{}e}", number, digits - 1);
  const size_t e = rounded.find('e');
  if (e == std::string::npos) return rounded;  // an infinity
  const int exponent = std::atoi(rounded.c_str() + e + 1);
  if (number == 0 || (exponent >= -4 && exponent < digits)) return fmt::format("{:.{}g}", number, digits);
  if (exponent >= 0 && exponent < 9) return fmt::format("{:.0f}", number);
  constexpr const char* kSuperscripts[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string out = fmt::format("{:g} × 10", std::atof(rounded.substr(0, e).c_str()));
  if (exponent < 0) out += "⁻";
  for (const char digit : std::to_string(std::abs(exponent))) out += kSuperscripts[digit - '0'];
  return out;
}

// A negative zero becomes a zero.
std::string place_text(const Vec3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p[0] + 0.0, p[1] + 0.0, p[2] + 0.0); }

}  // namespace teracell::store
