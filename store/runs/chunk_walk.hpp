// What the encoder and the decoder of chunks share: the order in which they go through the rays, and what they expect of each from those before.
#pragma once
#include "store/base/zstd_frame.hpp"
#include "store/runs/chunk_codec.hpp"

namespace teracell::inline store {

inline constexpr BodyBound kChunkBound = {kMaxChunkBytes, kChunkBytesOfAnyFrame};
inline constexpr uint8_t kEscape = 255;  // a narrow residual whose value stands in the wide stream

inline uint32_t zigzag(int32_t v) { return (static_cast<uint32_t>(v) << 1) ^ static_cast<uint32_t>(v >> 31); }
inline int32_t unzigzag(uint32_t v) { return static_cast<int32_t>(v >> 1) ^ -static_cast<int32_t>(v & 1); }

// The pattern expected at (u, v) from the rays before it. If the left neighbour has the pattern of the ray above it, this
// ray probably has that of the ray above it, too. Otherwise it probably has that of the left neighbour.
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

// Calls one(ray, predictor) for the rays with changes that the plane does not predict, and plane(from, to) for the longest
// stretches of a row that it does predict, in order. Encoder and decoder walk a block with this.
template <class One, class Plane>
void walk(const RayBlock& b, One&& one, Plane&& plane) {
  for (uint32_t v = 0; v < b.nv; ++v) {
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
      const uint32_t *row = b.begin.data() + v * b.nu, *above = row - b.nu;
      const auto differ = [&](uint32_t at) { return ((row[at + 1] - row[at]) ^ n) | ((above[at + 1] - above[at]) ^ n); };
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
