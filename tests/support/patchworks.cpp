#include "tests/support/patchworks.hpp"

#include "store/grid/vec3.hpp"

namespace teracell::patchworks {
namespace {

using testing::random_in;
using testing::random_int;
using Edge = std::pair<Vec3, Vec3>;  // directed

Vec3 along(const Vec3& a, const Vec3& b, double t) { return a + (b - a) * t; }
double distance(const Vec3& a, const Vec3& b) { return length(a - b); }

double distance_from_edge(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 e = b - a, d = p - a;
  return distance(p, along(a, b, std::clamp(dot(d, e) / dot(e, e), 0.0, 1.0)));
}

Vec3 middle(const mesher::Facet& f) { return along(f.vertex[0], along(f.vertex[1], f.vertex[2], 0.5), 2.0 / 3); }

Vec3 in_ball(std::mt19937_64& random, double radius) {
  for (;;) {
    const Vec3 p = {random_in(random, -1, 1), random_in(random, -1, 1), random_in(random, -1, 1)};
    if (dot(p, p) <= 1) return {p[0] * radius, p[1] * radius, p[2] * radius};
  }
}

std::set<Edge> seam_of(const Facets& patch) {
  std::set<Edge> edges;
  for (const mesher::Facet& f : patch)
    for (int i = 0; i < 3; ++i) edges.insert({f.vertex[i], f.vertex[(i + 1) % 3]});
  std::set<Edge> seam;
  for (const auto& [a, b] : edges)
    if (!edges.contains({b, a})) seam.insert({a, b});
  return seam;
}

}  // namespace

Patches cube_sphere(const Vec3& centre, double radius, int n) {
  // The same integers on the cube give the same bits, whichever face they are on.
  const auto point = [&](const Vec3& cube) {
    const double scale = radius / std::sqrt(dot(cube, cube));
    return centre + cube * scale;
  };
  Patches patches;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {-n, n}) {
      const auto at = [&](int u, int v) {
        Vec3 cube;
        cube[axis] = side;
        cube[(axis + 1) % 3] = 2 * u - n;
        cube[(axis + 2) % 3] = 2 * v - n;
        return point(cube);
      };
      Facets& patch = patches.emplace_back();
      for (int u = 0; u < n; ++u)
        for (int v = 0; v < n; ++v) {
          patch.push_back({{at(u, v), at(u + 1, v), at(u + 1, v + 1)}});
          patch.push_back({{at(u, v), at(u + 1, v + 1), at(u, v + 1)}});
        }
      if (side < 0) patch = shapes::flip(patch);
    }
  return patches;
}

Facets refined(Facets facets, int levels) {
  for (; levels > 0; --levels) {
    Facets finer;
    for (const mesher::Facet& f : facets) {
      const auto& [a, b, c] = f.vertex;
      const auto halfway = [](const Vec3& p, const Vec3& q) { return along(std::min(p, q), std::max(p, q), 0.5); };  // the same for the neighbour
      const Vec3 ab = halfway(a, b), bc = halfway(b, c), ca = halfway(c, a);
      finer.insert(finer.end(), {{{a, ab, ca}}, {{b, bc, ab}}, {{c, ca, bc}}, {{ab, bc, ca}}});
    }
    facets = std::move(finer);
  }
  return facets;
}

Patches cut_by_seeds(const Facets& facets, std::mt19937_64& random, size_t patches) {
  std::vector<Vec3> seeds;
  for (size_t i = 0; i < patches; ++i) seeds.push_back(middle(facets[std::uniform_int_distribution<size_t>(0, facets.size() - 1)(random)]));
  Patches out(patches);
  for (const mesher::Facet& f : facets) {
    const Vec3 m = middle(f);
    out[std::ranges::min_element(seeds, {}, [&](const Vec3& s) { return distance(s, m); }) - seeds.begin()].push_back(f);
  }
  std::erase_if(out, [](const Facets& patch) { return patch.empty(); });
  return out;
}

Patches cut_by_planes(const Facets& facets, std::mt19937_64& random, int planes) {
  Vec3 lo = facets[0].vertex[0], hi = lo;
  for (const mesher::Facet& f : facets)
    for (const Vec3& v : f.vertex)
      for (int d = 0; d < 3; ++d) lo[d] = std::min(lo[d], v[d]), hi[d] = std::max(hi[d], v[d]);
  std::map<uint32_t, Facets> by_side;
  std::vector<std::pair<Vec3, Vec3>> cuts;  // a point, the normal
  for (int i = 0; i < planes; ++i) cuts.push_back({along(lo, hi, 0.5) + in_ball(random, distance(lo, hi) / 8), in_ball(random, 1)});
  for (const mesher::Facet& f : facets) {
    uint32_t side = 0;
    for (const auto& [p, n] : cuts) side = 2 * side + (dot(n, middle(f)) > dot(n, p));
    by_side[side].push_back(f);
  }
  Patches out;
  for (auto& [side, patch] : by_side) out.push_back(std::move(patch));
  return out;
}

Facets moved(Facets patch, std::mt19937_64& random, double by) {
  std::map<Vec3, Vec3> to;
  for (const auto& [a, b] : seam_of(patch)) to.try_emplace(a, a + in_ball(random, by));
  for (mesher::Facet& f : patch)
    for (Vec3& v : f.vertex)
      if (const auto it = to.find(v); it != to.end()) v = it->second;
  return patch;
}

Facets split(const Facets& patch, std::mt19937_64& random, double share, double off, int points) {
  const std::set<Edge> seam = seam_of(patch);
  Facets out;
  for (const mesher::Facet& f : patch) {
    std::vector<Vec3> polygon;
    for (int i = 0; i < 3; ++i) {
      const Vec3 &a = f.vertex[i], &b = f.vertex[(i + 1) % 3];
      polygon.push_back(a);
      if (!seam.contains({a, b}) || random_in(random, 0, 1) >= share) continue;
      for (int k = 1; k <= points; ++k) polygon.push_back(along(a, b, static_cast<double>(k) / (points + 1)) + in_ball(random, off));
    }
    for (size_t i = 1; i + 1 < polygon.size(); ++i) out.push_back({{polygon[0], polygon[i], polygon[i + 1]}});
  }
  return out;
}

Facets chords(Facets patch, std::mt19937_64& random, double share, double off) {
  std::map<Vec3, std::vector<Vec3>> next, before;
  for (const auto& [a, b] : seam_of(patch)) {
    next[a].push_back(b);
    before[b].push_back(a);
  }
  std::set<Vec3> met;  // vertices of chords: what lies beside such a one is another edge by now
  for (const auto& [v, after] : next) {
    if (after.size() != 1 || before[v].size() != 1 || met.contains(v)) continue;
    const Vec3 &p = before[v][0], &n = after[0];
    if (p == n || distance_from_edge(v, p, n) > off || random_in(random, 0, 1) >= share) continue;
    patch.push_back({{v, p, n}});  // matches p -> v -> n and leaves p -> n open
    met.insert({v, p, n});
  }
  return patch;
}

}  // namespace teracell::patchworks
