// What a surface is made of, counted the plain way: maps of vertices and facets, and union-find over facets.
#pragma once
#include "tests/support/exact.hpp"

namespace teracell::testing {

struct Counted {
  uint64_t degenerate = 0;  // without area, in integer arithmetic
  uint64_t duplicates = 0;  // with the vertices of an earlier one
  uint64_t opposite = 0;    // of these: the other way round than the first
  uint64_t shells = 0;      // connected by equal vertices
  friend bool operator==(const Counted&, const Counted&) = default;
};

inline bool is_without_area(const mesher::Facet& f) {
  std::array<std::array<cpp_int, 3>, 3> p;
  for (int i = 0; i < 3; ++i)
    for (int d = 0; d < 3; ++d) p[i][d] = in_units(f.vertex[i][d], kCoordinateBits);
  for (int d = 0; d < 3; ++d) {
    const int s = (d + 1) % 3, t = (d + 2) % 3;
    if ((p[1][s] - p[0][s]) * (p[2][t] - p[0][t]) != (p[1][t] - p[0][t]) * (p[2][s] - p[0][s])) return false;
  }
  return true;
}

// Whether the vertices in this order are an odd permutation of the sorted ones. Of two equal ones it says nothing.
inline bool is_odd(const mesher::Facet& f) {
  const auto& [a, b, c] = f.vertex;
  return ((b < a) ^ (c < b) ^ (c < a)) != 0;
}

inline Counted counted(const std::vector<mesher::Facet>& facets) {
  Counted out;
  std::map<std::array<Vec3, 3>, bool> first;  // by sorted vertices: whether the first facet is odd
  std::map<Vec3, size_t> facet_at;
  std::vector<size_t> parent(facets.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](size_t i) {
    while (parent[i] != i) i = parent[i];
    return i;
  };
  for (size_t i = 0; i < facets.size(); ++i) {
    out.degenerate += is_without_area(facets[i]);
    auto sorted = facets[i].vertex;
    std::sort(sorted.begin(), sorted.end());
    const bool odd = is_odd(facets[i]) && sorted[0] != sorted[1] && sorted[1] != sorted[2];
    const auto [it, fresh] = first.try_emplace(sorted, odd);
    out.duplicates += !fresh;
    out.opposite += !fresh && it->second != odd;
    for (const Vec3& v : facets[i].vertex) parent[root(i)] = root(facet_at.try_emplace(v, i).first->second);
  }
  for (size_t i = 0; i < facets.size(); ++i) out.shells += root(i) == i;
  return out;
}

// Facets between points of a coarse lattice in [0, size): many share vertices, repeat one another or have no area. Some have
// corners that are no multiple of the lattice and are on a line but for a rounding.
inline std::vector<mesher::Facet> tangle(std::mt19937_64& random, size_t count, int size) {
  std::vector<mesher::Facet> out;
  const auto point = [&] {
    return Vec3{double(random_int(random, 0, size - 1)), double(random_int(random, 0, 3)), double(random_int(random, 0, 3))};
  };
  while (out.size() < count) {
    mesher::Facet f{{point(), point(), point()}};
    const int kind = random_int(random, 0, 9);
    if (kind < 3 && !out.empty()) {
      f = out[random_int(random, 0, static_cast<int>(out.size()) - 1)];
      std::rotate(f.vertex.begin(), f.vertex.begin() + random_int(random, 0, 2), f.vertex.end());
      if (kind == 0) std::swap(f.vertex[0], f.vertex[1]);
    }
    if (kind == 3) f.vertex[1] = f.vertex[2];
    if (kind == 4) {
      const double by = random_int(random, 1, 9) * 0.1;
      f.vertex[1] = f.vertex[0], f.vertex[2] = f.vertex[0];
      for (int d = 0; d < 2; ++d) f.vertex[1][d] += by, f.vertex[2][d] += 3 * by;
    }
    out.push_back(f);
  }
  return out;
}

}  // namespace teracell::testing
