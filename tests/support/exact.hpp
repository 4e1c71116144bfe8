// Doubles as integers, for oracles that count in units small enough to hold every bit, and doubles that are hard to decide.
#pragma once
#include <boost/multiprecision/cpp_int.hpp>

#include "mesher/surface/facet.hpp"
#include "tests/support/test.hpp"

namespace teracell::testing {

using boost::multiprecision::cpp_int;

// Every coordinate within the limits of facet.hpp is a multiple of 2^-kCoordinateBits.
inline constexpr int kCoordinateBits = 302;

// v in units of 2^-bits. Throws std::invalid_argument when v is not a multiple of the unit.
inline cpp_int in_units(double v, int bits) {
  if (v == 0) return 0;
  int exponent;
  cpp_int mantissa = static_cast<int64_t>(std::ldexp(std::frexp(v, &exponent), 53));
  const int shift = exponent - 53 + bits;
  if (shift >= 0) return mantissa << shift;
  const cpp_int unit = cpp_int(1) << -shift;
  if (mantissa % unit != 0) throw std::invalid_argument("exact: a double with bits below the unit");
  return mantissa / unit;
}

inline int sign_of(const cpp_int& v) { return v.sign(); }

// A source of coordinates that all have one character.
enum class Coordinates {
  kLattice,   // small multiples of 1/4: sums and products are exact, ties abound
  kDecimal,   // multiples of 0.1, which no double holds: ties miss by a rounding
  kFar,       // neighbouring doubles about 2^40
  kLimits,    // 0, or about 1e75 or 1e-75, of either sign
  kAnywhere,  // any magnitude between the limits
};
inline constexpr Coordinates kAllCoordinates[] = {Coordinates::kLattice, Coordinates::kDecimal, Coordinates::kFar, Coordinates::kLimits,
                                                  Coordinates::kAnywhere};

inline double draw(std::mt19937_64& random, Coordinates kind) {
  switch (kind) {
    case Coordinates::kLattice: return random_int(random, -8, 8) * 0.25;
    case Coordinates::kDecimal: return random_int(random, -8, 8) * 0.1;
    case Coordinates::kFar: return 0x1p40 + random_int(random, -6, 6) * 0x1p-12;
    case Coordinates::kLimits: {
      const double size[] = {0, 1e75, 1e75, 1e-75, 1e-75, std::nextafter(1e75, 0), std::nextafter(1e-75, 1), 0x1p249, 0x1p-249};
      return size[random_int(random, 0, 8)] * (random_int(random, 0, 1) == 0 ? -1 : 1) + 0.0;
    }
    case Coordinates::kAnywhere: return std::ldexp(random_in(random, 1, 2), random_int(random, -248, 247)) * (random_int(random, 0, 1) == 0 ? -1 : 1);
  }
  throw std::logic_error("exact: no such coordinates");
}

inline Vec3 draw_point(std::mt19937_64& random, Coordinates kind) { return {draw(random, kind), draw(random, kind), draw(random, kind)}; }

}  // namespace teracell::testing
