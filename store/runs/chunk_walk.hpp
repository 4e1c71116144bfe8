// What the encoder and the decoder of chunks share: the order in which they go through the rays, and what they expect of each from those before.
#pragma once
#include <cstring>
#include <optional>

#include "store/base/zstd_frame.hpp"
#include "store/runs/chunk_codec.hpp"

namespace teracell::inline store {

inline constexpr BodyBound kChunkBound = {kMaxChunkBytes, kChunkBytesOfAnyFrame};
inline constexpr uint8_t kInGroups = 0;  // the first byte of a body; before format 3.0 it is that of the palette's size, which is never 0
inline constexpr uint8_t kEscape = 255;  // a narrow residual whose value stands in the wide stream
inline constexpr uint32_t kGroup = 5;    // narrow residuals that share a byte, as digits of base 3, if none is above 2
inline constexpr uint8_t kSpelled = 243;  // a group with a byte for each of its residuals: 3^5

inline uint32_t zigzag(int32_t v) { return (static_cast<uint32_t>(v) << 1) ^ static_cast<uint32_t>(v >> 31); }
constexpr int32_t unzigzag(uint32_t v) { return static_cast<int32_t>(v >> 1) ^ -static_cast<int32_t>(v & 1); }

// The pattern expected at (u, v) from the rays before it. If the left neighbour has the pattern of the ray above it, this
// ray probably has that of the ray above it, too. Otherwise it probably has that of the left neighbour. So where nothing is unexpected, a row has
// the patterns of the one above it.
inline uint32_t expected_pattern(const std::vector<uint32_t>& pattern, uint32_t nu, uint32_t u, uint32_t v) {
  const uint32_t ray = v * nu + u;
  if (v == 0) return u == 0 ? 0 : pattern[ray - 1];
  if (u == 0) return pattern[ray - nu];
  return pattern[ray - 1] == pattern[ray - nu - 1] ? pattern[ray - nu] : pattern[ray - 1];
}

// Which neighbours predict the changes of a ray: those with as many changes.
enum class From { kNothing, kLeft, kUp, kPlane };

inline From predictor(const RayBlock& b, uint32_t u, uint32_t v) {
  const uint32_t ray = v * b.nu + u;
  const auto count = [&](uint32_t r) { return b.begin[r + 1] - b.begin[r]; };
  const uint32_t n = count(ray);
  const bool left = u > 0 && count(ray - 1) == n, up = v > 0 && count(ray - b.nu) == n;
  if (left && up) return count(ray - b.nu - 1) == n ? From::kPlane : From::kLeft;
  return left ? From::kLeft : up ? From::kUp : From::kNothing;
}

// How many changes each ray of a row has, if all have as many.
inline std::optional<uint32_t> changes_of_all(const RayBlock& b, uint32_t v) {
  const uint32_t* begin = b.begin.data() + size_t{v} * b.nu;
  const uint32_t n = begin[1] - begin[0];
  uint32_t differences = 0;  // without a branch, so that vectors do it
  for (uint32_t u = 0; u < b.nu; ++u) differences |= (begin[u + 1] - begin[u]) ^ n;
  return differences == 0 ? std::optional(n) : std::nullopt;
}

// Calls one(ray, predictor) for the rays with changes that the plane does not predict, and plane(from, to) for the longest
// stretches of a row that it does predict, in order. All rays of a stretch have equally many changes. Encoder and decoder walk a block with this.
template <class One, class Plane>
void walk(const RayBlock& b, One&& one, Plane&& plane) {
  std::optional<uint32_t> above;
  for (uint32_t v = 0; v < b.nv; ++v) {
    const uint32_t* const pattern = b.pattern.data() + size_t{v} * b.nu;
    const bool like_above = v > 0 && std::memcmp(pattern, pattern - b.nu, size_t{b.nu} * sizeof *pattern) == 0;  // mostly, and quicker than counting
    const std::optional<uint32_t> of_all = like_above ? above : changes_of_all(b, v);
    const bool as_above = of_all && of_all == above;
    above = of_all;
    if (of_all == 0) continue;
    if (as_above) {  // most rows
      one(v * b.nu, From::kUp);
      if (b.nu > 1) plane(v * b.nu + 1, v * b.nu + b.nu);
      continue;
    }
    for (uint32_t u = 0; u < b.nu;) {
      const uint32_t ray = v * b.nu + u;
      const uint32_t n = b.begin[ray + 1] - b.begin[ray];
      if (n == 0) {
        ++u;
        continue;
      }
      const From from = predictor(b, u, v);
      if (from != From::kPlane) {
        one(ray, from);
        ++u;
        continue;
      }
      // Within the stretch, the left and the upper left neighbours match by themselves.
      const uint32_t *row = b.begin.data() + size_t{v} * b.nu, *upper = row - b.nu;
      const auto differ = [&](uint32_t at) { return ((row[at + 1] - row[at]) ^ n) | ((upper[at + 1] - upper[at]) ^ n); };
      uint32_t end = u + 1;
      for (constexpr uint32_t kSome = 8; end + kSome <= b.nu; end += kSome) {  // many at once, by vectors
        uint32_t any = 0;
        for (uint32_t i = 0; i < kSome; ++i) any |= differ(end + i);
        if (any != 0) break;
      }
      while (end < b.nu && differ(end) == 0) ++end;
      plane(ray, v * b.nu + end);
      u = end;
    }
  }
}

}  // namespace teracell::store
