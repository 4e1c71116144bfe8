// Expansions against integer arithmetic.
#include "mesher/engines/expansion.hpp"

#include "tests/support/exact.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

// The value of an expansion of products of `factors` coordinates, in units of 2^-(factors * kCoordinateBits).
template <int N>
cpp_int value(const Expansion<N>& e, int factors) {
  cpp_int sum = 0;
  for (int i = 0; i < e.size; ++i) sum += in_units(e.part[i], factors * kCoordinateBits);
  return sum;
}

// Each part's lowest bit is worth more than the whole part before it, and none is 0.
template <int N>
bool is_nonoverlapping(const Expansion<N>& e, int factors) {
  for (int i = 0; i < e.size; ++i) {
    if (e.part[i] == 0) return false;
    if (i == 0) continue;
    const cpp_int below = abs(in_units(e.part[i - 1], factors * kCoordinateBits)), above = abs(in_units(e.part[i], factors * kCoordinateBits));
    if (cpp_int(1) << lsb(above) <= below) return false;
  }
  return true;
}

// `value` as an integer was calculated another way.
template <int N>
void expect(const Expansion<N>& e, int factors, const cpp_int& expected) {
  REQUIRE(value(e, factors) == expected);
  REQUIRE(is_nonoverlapping(e, factors));
  REQUIRE(e.sign() == sign_of(expected));
  REQUIRE((e.size == 0) == (expected == 0));
}

cpp_int one(double v) { return in_units(v, kCoordinateBits); }

TEST_CASE("A rounded sum or product of two coordinates and its error are the exact one") {
  std::mt19937_64 random(1);
  for (const Coordinates kind : kAllCoordinates)
    for (size_t round = 0; round < rounds(1000); ++round) {
      const double a = draw(random, kind), b = draw(random, kind);
      CAPTURE(a, b);
      double rounded, error;
      two_sum(a, b, rounded, error);
      REQUIRE(rounded == a + b);
      REQUIRE(one(rounded) + one(error) == one(a) + one(b));
      two_product(a, b, rounded, error);
      REQUIRE(rounded == a * b);
      REQUIRE(in_units(rounded, 2 * kCoordinateBits) + in_units(error, 2 * kCoordinateBits) == one(a) * one(b));
    }
}

TEST_CASE("Sums, differences and products of expansions are exact, do not overlap and have the sign of their sum") {
  std::mt19937_64 random(2);
  for (const Coordinates kind : kAllCoordinates)
    for (size_t round = 0; round < rounds(500); ++round) {
      double x[8];
      for (double& v : x) v = draw(random, kind);
      CAPTURE(x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7]);
      const auto a = difference(x[0], x[1]), b = difference(x[2], x[3]), c = difference(x[4], x[5]), d = difference(x[6], x[7]);
      const cpp_int ia = one(x[0]) - one(x[1]), ib = one(x[2]) - one(x[3]), ic = one(x[4]) - one(x[5]), id = one(x[6]) - one(x[7]);
      expect(a, 1, ia);
      expect(-a, 1, -ia);
      expect(a + b, 1, ia + ib);
      expect(a - b, 1, ia - ib);
      expect(a * b, 2, ia * ib);
      expect(a * b - c * d, 2, ia * ib - ic * id);
      expect((a * b - c * d) * a, 3, (ia * ib - ic * id) * ia);
      expect((a * b - c * d) * a + (b * c - d * a) * b, 3, (ia * ib - ic * id) * ia + (ib * ic - id * ia) * ib);
    }
}

TEST_CASE("What cancels leaves an expansion without parts, of sign 0") {
  std::mt19937_64 random(3);
  for (const Coordinates kind : kAllCoordinates)
    for (size_t round = 0; round < rounds(200); ++round) {
      const double p = draw(random, kind), q = draw(random, kind), r = draw(random, kind), s = draw(random, kind);
      CAPTURE(p, q, r, s);
      const auto a = difference(p, q), b = difference(r, s);
      REQUIRE((a - a).size == 0);
      REQUIRE((a * b - b * a).size == 0);
      REQUIRE((a * b + difference(q, p) * b).sign() == 0);
      // (a + b)^2 = a^2 + 2ab + b^2
      const auto sum = a + b;
      REQUIRE((sum * sum - (a * a + (a * b + (a * b + b * b)))).sign() == 0);
    }
}

TEST_CASE("A result that one double holds has one part") {
  std::mt19937_64 random(4);
  for (int round = 0; round < 200; ++round) {
    const auto a = difference(draw(random, Coordinates::kLattice), draw(random, Coordinates::kLattice));
    const auto b = difference(draw(random, Coordinates::kLattice), draw(random, Coordinates::kLattice));
    REQUIRE(a.size <= 1);
    REQUIRE((a * b).size <= 1);
    REQUIRE((a * b + a * a).size <= 1);
  }
}

TEST_CASE("A part smaller than the rounding of all others decides the sign when these cancel") {
  const auto huge = difference(1e75, -1e75), tiny = difference(1e-75, 0);
  for (const int sign : {1, -1}) {
    const auto shifted = sign > 0 ? huge + tiny : huge - tiny;
    REQUIRE(shifted.size == 2);
    REQUIRE((shifted - huge).sign() == sign);
    REQUIRE((shifted * shifted - huge * huge).sign() == sign);
  }
}

}  // namespace
}  // namespace teracell::mesher
