// Rows of n cells between two given end widths, of which neighbours differ by at most a factor: the widest and the narrowest such row, and
// what lies between them.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace teracell::mesher {

// Only +, -, *, / and comparisons, which give the same bits on every machine; std::exp and std::log do not.
double portable_log(double x);    // REQUIRES: x > 0, finite
double power(double x, int64_t n);  // n >= 0

struct Growth {
  double factor;  // above 1
  double log = portable_log(factor);
  double power(int64_t n) const { return mesher::power(factor, n); }
};

// The width of cell i of the widest row, whose cells are at most `most` wide, and of the narrowest, whose cells are at least `least` wide.
inline double widest(const Growth& g, double first, double last, double most, int64_t n, int64_t i) {
  return std::min({first * g.power(i), most, last * g.power(n - 1 - i)});
}
inline double narrowest(const Growth& g, double first, double last, double least, int64_t n, int64_t i) {
  return std::max({first / g.power(i), least, last / g.power(n - 1 - i)});
}

// The lengths of these rows. REQUIRES: the ends are within the limit, and n cells can lead from one to the other; n > 1, or first == last.
double widest_length(const Growth& g, double first, double last, double most, int64_t n);
double narrowest_length(const Growth& g, double first, double last, double least, int64_t n);

}  // namespace teracell::mesher
