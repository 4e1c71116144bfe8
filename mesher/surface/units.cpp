#include "mesher/surface/units.hpp"

#include <bit>
#include <cmath>
#include <numeric>

namespace teracell::mesher {
namespace {

struct Unit {
  std::string_view name;
  uint64_t nanometres;
};
constexpr Unit kUnits[] = {{"m", 1'000'000'000}, {"cm", 10'000'000}, {"mm", 1'000'000}, {"um", 1000}, {"nm", 1},
                           {"in", 25'400'000},   {"ft", 304'800'000}};

uint64_t nanometres(std::string_view name) {
  for (const Unit& u : kUnits)
    if (u.name == name) return u.nanometres;
  return 0;
}

}  // namespace

bool is_unit(std::string_view name) { return nanometres(name) > 0; }

Factor factor(std::string_view from, std::string_view to) {
  if (to.empty() || from == to) return {};
  const uint64_t p = nanometres(from), q = nanometres(to), common = std::gcd(p, q);
  return {p / common, q / common};
}

// The coordinate is m 2^e with an integer m. The quotient of m p 2^s, filled up to 127 bits, and q has 96 bits or more; its last bit says
// whether anything is left. So rounding it rounds the exact value.
double Factor::of(double coordinate) const {
  if (is_one() || coordinate == 0) return coordinate;
  int exponent;
  const double fraction = std::frexp(std::abs(coordinate), &exponent);
  const auto mantissa = static_cast<uint64_t>(std::ldexp(fraction, 53));
  unsigned __int128 dividend = static_cast<unsigned __int128>(mantissa) * p;
  const auto high = static_cast<uint64_t>(dividend >> 64);
  const int shift = (high != 0 ? std::countl_zero(high) : 64 + std::countl_zero(static_cast<uint64_t>(dividend))) - 1;
  dividend <<= shift;
  const unsigned __int128 quotient = dividend / q | (dividend % q != 0 ? 1 : 0);
  return std::copysign(std::ldexp(static_cast<double>(quotient), exponent - 53 - shift), coordinate);
}

}  // namespace teracell::mesher
