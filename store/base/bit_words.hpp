// Rows of bits in words of 64, the lowest first.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace teracell::inline store {

// Sets the bits [lo, hi). REQUIRES: lo < hi.
inline void set_bits(uint64_t* words, size_t lo, size_t hi) {
  const uint64_t first = ~uint64_t{0} << (lo % 64), last = ~uint64_t{0} >> (63 - (hi - 1) % 64);
  const size_t from = lo / 64, to = (hi - 1) / 64;
  if (from == to) {
    words[from] |= first & last;
    return;
  }
  words[from] |= first;
  std::fill(words + from + 1, words + to, ~uint64_t{0});
  words[to] |= last;
}

// Bit i of the result is bit 2 i or bit 2 i + 1 of `x`.
inline uint32_t pairs_of_bits(uint64_t x) {
  x = (x | x >> 1) & 0x5555555555555555;
  x = (x | x >> 1) & 0x3333333333333333;
  x = (x | x >> 2) & 0x0F0F0F0F0F0F0F0F;
  x = (x | x >> 4) & 0x00FF00FF00FF00FF;
  x = (x | x >> 8) & 0x0000FFFF0000FFFF;
  return static_cast<uint32_t>(x | x >> 16);
}

}  // namespace teracell::store
