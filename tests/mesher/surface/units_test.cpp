// Coordinates from one unit into another, against exact arithmetic.
#include "mesher/surface/units.hpp"

#include "tests/support/catch.hpp"

#include <cmath>
#include <random>

#include <boost/multiprecision/cpp_int.hpp>

using namespace teracell::mesher;
using Rational = boost::multiprecision::cpp_rational;

TEST_CASE("Factors are in lowest terms") {
  const auto is = [](Factor f, uint64_t p, uint64_t q) { return f.p == p && f.q == q; };
  CHECK(is(factor("in", "mm"), 127, 5));
  CHECK(is(factor("mm", "in"), 5, 127));
  CHECK(is(factor("m", "nm"), 1'000'000'000, 1));
  CHECK(is(factor("ft", "in"), 12, 1));
  CHECK(factor("mm", "mm").is_one());
  CHECK(factor("mm", "").is_one());
  CHECK_FALSE(is_unit("parsec"));
}

TEST_CASE("A coordinate times p/q is the double nearest to the exact product") {
  std::mt19937_64 random(35);
  const char* names[] = {"m", "cm", "mm", "um", "nm", "in", "ft"};
  for (int i = 0; i < 4000; ++i) {
    const Factor f = factor(names[random() % 7], names[random() % 7]);
    const double x = std::ldexp(static_cast<double>(static_cast<int64_t>(random() >> (random() % 64))), static_cast<int>(random() % 120) - 60) *
                     (random() % 2 ? 1 : -1);
    const double y = f.of(x);
    // |y q - x p| is at most that of either neighbour, all times q.
    const auto off = [&](double z) -> Rational {
      return abs(Rational(z) * Rational(static_cast<double>(f.q)) - Rational(x) * Rational(static_cast<double>(f.p)));
    };
    REQUIRE(off(y) <= off(std::nextafter(y, HUGE_VAL)));
    REQUIRE(off(y) <= off(std::nextafter(y, -HUGE_VAL)));
  }
  CHECK(factor("in", "mm").of(1) == 25.4);
  CHECK(factor("mm", "m").of(-0.1) == -0.0001);
  CHECK(factor("in", "mm").of(0) == 0);
}
