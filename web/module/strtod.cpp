// Numbers of decimal digits, as JSON and addresses have them, rounded to the nearest double, as the C library rounds them. Its own function
// reads all that C allows, with numbers of 128 bits, and is ten times as large.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <utility>
#include <vector>

namespace {

// A whole number of any size, in words of 32 bits, the least significant first; the last one is not 0.
class Whole {
 public:
  // Multiplies, and adds.
  void scale(uint32_t by, uint32_t more = 0) {
    uint64_t carry = more;
    for (uint32_t& word : words_) {
      carry += uint64_t{word} * by;
      word = static_cast<uint32_t>(carry);
      carry >>= 32;
    }
    if (carry != 0) words_.push_back(static_cast<uint32_t>(carry));
  }
  void shift(int bits) {
    for (; bits >= 31; bits -= 31) scale(uint32_t{1} << 31);
    scale(uint32_t{1} << bits);
  }
  bool is_zero() const { return words_.empty(); }
  int bits() const { return words_.empty() ? 0 : static_cast<int>(32 * words_.size()) - __builtin_clz(words_.back()); }
  bool is_less(const Whole& other) const {
    if (words_.size() != other.words_.size()) return words_.size() < other.words_.size();
    for (size_t i = words_.size(); i-- > 0;)
      if (words_[i] != other.words_[i]) return words_[i] < other.words_[i];
    return false;
  }
  // REQUIRES: `other` is not larger.
  void subtract(const Whole& other) {
    uint64_t borrow = 0;
    for (size_t i = 0; i < words_.size(); ++i) {
      const uint64_t left = uint64_t{words_[i]} - borrow - (i < other.words_.size() ? other.words_[i] : 0);
      words_[i] = static_cast<uint32_t>(left);
      borrow = left >> 63;
    }
    while (!words_.empty() && words_.back() == 0) words_.pop_back();
  }

 private:
  std::vector<uint32_t> words_;
};

constexpr int kDigits = 53, kLeastExponent = -1074;  // of a double, in bits

// top / bottom, rounded to the nearest double, to even between two. REQUIRES: neither is 0.
double divided(Whole top, Whole bottom) {
  // Such that the whole quotient has kDigits bits or one more; fewer where the double has fewer.
  int exponent = std::max(top.bits() - bottom.bits() - kDigits, kLeastExponent);
  if (exponent > 0) bottom.shift(exponent);
  else top.shift(-exponent);
  const int steps = std::max(0, top.bits() - bottom.bits());
  bottom.shift(steps);
  uint64_t quotient = 0;
  for (int i = 0;; ++i) {
    quotient *= 2;
    if (!top.is_less(bottom)) top.subtract(bottom), ++quotient;
    if (i == steps) break;
    top.shift(1);  // instead of halving `bottom`
  }
  bool up;
  if (quotient >> kDigits == 0) {
    top.shift(1);
    up = bottom.is_less(top) || (!top.is_less(bottom) && quotient % 2 == 1);
  } else {
    up = quotient % 2 == 1 && (!top.is_zero() || quotient / 2 % 2 == 1);
    quotient /= 2;
    ++exponent;
  }
  return std::ldexp(static_cast<double>(quotient + up), exponent);
}

}  // namespace

// In place of strtod(): the linker is told so (CMakeLists.txt).
extern "C" double __wrap_strtod(const char* text, char** end) {
  const char* at = text;
  const auto is_digit = [&] { return *at >= '0' && *at <= '9'; };
  const bool negative = *at == '-';
  at += *at == '-' || *at == '+';
  Whole digits;
  int64_t places = 0, power = 0;
  bool any = false;
  for (bool fraction = false; is_digit() || (*at == '.' && !fraction); ++at) {
    if (*at == '.') {
      fraction = true;
      continue;
    }
    any = true;
    digits.scale(10, static_cast<uint32_t>(*at - '0'));
    places += fraction;
  }
  if (end) *end = const_cast<char*>(any ? at : text);
  if (any && (*at == 'e' || *at == 'E')) {
    ++at;
    const bool down = *at == '-';
    at += *at == '-' || *at == '+';
    if (is_digit()) {
      for (; is_digit(); ++at) power = std::min<int64_t>(10 * power + (*at - '0'), 1 << 20);
      if (down) power = -power;
      if (end) *end = const_cast<char*>(at);
    }
  }
  power -= places;
  double value = 0;
  if (!digits.is_zero()) {
    constexpr int64_t kFarthest = 400;  // no double has more places before or behind its point, apart from its digits
    const int64_t length = digits.bits() * 3 / 10;
    if (power + length > kFarthest) {
      value = HUGE_VAL;
    } else if (power + length > -kFarthest) {
      Whole bottom;
      bottom.scale(1, 1);
      for (; power > 0; --power) digits.scale(10);
      for (; power < 0; ++power) bottom.scale(10);
      value = divided(std::move(digits), std::move(bottom));
    }
  }
  return negative ? -value : value;
}
