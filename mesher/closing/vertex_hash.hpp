// A hash of a vertex. Vertices are equal when their coordinates are equal, so edges and shells are found by this hash and
// never by an index.
//
// It folds 128-bit products as wyhash (Wang Yi) does. Hashing vertices was a twentieth of the time for a small grid; a
// library's hash for data of any length took three times as long.
#pragma once
#include <bit>
#include <compare>
#include <cstdint>

#include "mesher/surface/facet.hpp"

namespace teracell::mesher {

// The 128-bit product folded to 64 bits. It mixes well if one argument is well mixed: a hash, or a value combined with a key.
inline uint64_t fold(uint64_t a, uint64_t b) {
  const unsigned __int128 p = static_cast<unsigned __int128>(a) * b;
  return static_cast<uint64_t>(p) ^ static_cast<uint64_t>(p >> 64);
}

inline constexpr uint64_t kHashKeys[] = {0xA0761D6478BD642F, 0xE7037ED1A0B428DB, 0x8EBC6AF09C88C6E3, 0x589965CC75374CC3,
                                         0x1D8E4E27C47D124F, 0xEB44ACCAB455D165, 0x9C6E6877736C46E3, 0xD5B8E0F1A7C3962B};

struct VertexHash {
  uint64_t low = 0, high = 0;
  friend auto operator<=>(const VertexHash&, const VertexHash&) = default;
};

// The two halves are independent. Different vertices have equal hashes with probability 2^-128, unless made to collide.
inline VertexHash vertex_hash(const Vec3& vertex) {
  const auto x = std::bit_cast<uint64_t>(vertex[0]), y = std::bit_cast<uint64_t>(vertex[1]), z = std::bit_cast<uint64_t>(vertex[2]);
  return {fold(fold(x ^ kHashKeys[0], y ^ kHashKeys[1]) ^ kHashKeys[2], z ^ kHashKeys[3]),
          fold(fold(x ^ kHashKeys[4], y ^ kHashKeys[5]) ^ kHashKeys[6], z ^ kHashKeys[7])};
}

// The three vertices of a facet as a set, and their orientation. Facets with equal keys lie on each other.
struct FacetKey {
  VertexHash key;
  bool odd;  // of two facets with the same key, one odd and one not, the orientations are opposite

  using Lows = std::array<uint64_t, 3>;  // of the hashes of its vertices

  explicit FacetKey(const std::array<VertexHash, 3>& v)
      : key{low_of({v[0].low, v[1].low, v[2].low}), fold((v[0].high + v[1].high + v[2].high) ^ kHashKeys[3], kHashKeys[2])},
        odd(is_odd({v[0].low, v[1].low, v[2].low})) {}
  static uint64_t low_of(const Lows& v) { return fold((v[0] + v[1] + v[2]) ^ kHashKeys[1], kHashKeys[0]); }
  static bool is_odd(const Lows& v) { return ((v[0] > v[1]) ^ (v[1] > v[2]) ^ (v[0] > v[2])) != 0; }
};

// The next size of a hash table. Large ones may leave the cache, so they grow less at once.
inline size_t grown(size_t table) { return (table < size_t{1} << 16 ? 4 : 2) * table; }

inline std::array<VertexHash, 3> vertex_hashes(const Facet& facet) {
  return {vertex_hash(facet.vertex[0]), vertex_hash(facet.vertex[1]), vertex_hash(facet.vertex[2])};
}
inline bool three_different(const std::array<VertexHash, 3>& v) { return v[0] != v[1] && v[1] != v[2] && v[0] != v[2]; }

}  // namespace teracell::mesher
