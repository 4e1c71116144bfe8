#include "mesher/planes/geometric.hpp"

#include <array>

namespace teracell::mesher {
namespace {

constexpr int64_t kFew = 12;

// The same as row_length() by adding up, which is faster for few cells.
double length_of_few(const Growth& g, double first, double last, double limit, int64_t n, bool up) {
  std::array<double, kFew> from_last{};
  double end = last, sum = 0;
  for (int64_t i = n; i-- > 0; end = up ? end * g.factor : end / g.factor) from_last[static_cast<size_t>(i)] = end;
  end = first;
  for (int64_t i = 0; i < n; ++i, end = up ? end * g.factor : end / g.factor) {
    const double other = from_last[static_cast<size_t>(i)];
    sum += up ? std::min({end, limit, other}) : std::max({end, limit, other});
  }
  return sum;
}

// Both rows begin as a geometric sequence from the first end, end as one from the last end, and have the limit between them if they reach it. `up`:
// the sequences grow towards the middle, else they fall.
double row_length(const Growth& g, double first, double last, double limit, int64_t n, bool up) {
  if (n == 1) return first;
  if (n <= kFew) return length_of_few(g, first, last, limit, n, up);
  const double log = up ? g.log : -g.log;
  const auto count = static_cast<double>(n);
  // The cells of a sequence that have not reached the limit.
  const auto terms_from = [&](double end) { return std::clamp(std::ceil(portable_log(limit / end) / log), 0.0, count); };
  const auto sequence = [&](double end, double terms) {
    const double p = g.power(static_cast<int64_t>(terms));
    return terms <= 0 ? 0 : up ? end * (p - 1) / (g.factor - 1) : end * (1 - 1 / p) / (1 - 1 / g.factor);
  };
  const double from_first = terms_from(first), from_last = terms_from(last);
  if (from_first + from_last <= count) return sequence(first, from_first) + sequence(last, from_last) + (count - from_first - from_last) * limit;
  // They meet where first * factor^i == last * factor^(n - 1 - i).
  const double meet = (count - 1 + portable_log(last / first) / log) / 2;
  const double terms = std::clamp(std::floor(meet) + 1, count - from_last, from_first);
  return sequence(first, terms) + sequence(last, count - terms);
}

}  // namespace

// x is 2^e m with m near 1, whose logarithm is 2 artanh((m - 1) / (m + 1)).
double portable_log(double x) {
  int e = 0;
  double m = std::frexp(x, &e);
  if (m < 0.70710678118654752) m *= 2, --e;
  const double s = (m - 1) / (m + 1), square = s * s;
  double series = 0;
  for (int k = 23; k >= 1; k -= 2) series = series * square + 1.0 / k;
  return 2 * s * series + e * 0.69314718055994531;
}

double power(double x, int64_t n) {
  double out = 1;
  for (; n > 0; n >>= 1, x *= x)
    if (n & 1) out *= x;
  return out;
}

double widest_length(const Growth& g, double first, double last, double most, int64_t n) { return row_length(g, first, last, most, n, true); }
double narrowest_length(const Growth& g, double first, double last, double least, int64_t n) { return row_length(g, first, last, least, n, false); }

}  // namespace teracell::mesher
