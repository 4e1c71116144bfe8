#include "tests/support/shapes.hpp"

namespace teracell::shapes {
namespace {

Vec3 add(const Vec3& a, const Vec3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

Vec3 snapped(const Vec3& v, double lattice) {
  if (lattice == 0) return v;
  return {std::round(v[0] / lattice) * lattice, std::round(v[1] / lattice) * lattice, std::round(v[2] / lattice) * lattice};
}

// Six times the signed volume of the tetrahedron from the origin to a, b, c.
double triple(const Vec3& a, const Vec3& b, const Vec3& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

// The point of the sphere halfway along a chord; the same bits for (a, b) and (b, a), so that neighbours stay joined.
Vec3 midpoint_on_unit_sphere(const Vec3& a, const Vec3& b) {
  const Vec3 sum = add(a, b);
  const double length = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
  return {sum[0] / length, sum[1] / length, sum[2] / length};
}

void add_quad(Facets& facets, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  facets.push_back({{a, b, c}});
  facets.push_back({{a, c, d}});
}

}  // namespace

Facets box(const Vec3& lo, const Vec3& hi) { return extruded({{lo[0], lo[1]}, {hi[0], lo[1]}, {hi[0], hi[1]}, {lo[0], hi[1]}}, lo[2], hi[2]); }

std::vector<Facets> box_in_tetrahedra(const Vec3& lo, const Vec3& hi) {
  std::vector<Facets> parts;
  std::array<int, 3> order = {0, 1, 2};
  do {  // walk from lo to hi along the box's edges, one axis at a time
    Vec3 first = lo, second;
    first[order[0]] = hi[order[0]];
    second = first;
    second[order[1]] = hi[order[1]];
    parts.push_back(tetrahedron(lo, first, second, hi));
  } while (std::next_permutation(order.begin(), order.end()));
  return parts;
}

Facets tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Facets facets = {{{a, c, b}}, {{a, b, d}}, {{b, c, d}}, {{c, a, d}}};
  return volume(facets) < 0 ? flip(facets) : facets;
}

std::vector<Facets> random_tetrahedra(std::mt19937_64& random, int count, double lo, double hi, double lattice) {
  std::uniform_int_distribution<int64_t> step(static_cast<int64_t>(std::ceil(lo / lattice)), static_cast<int64_t>(std::floor(hi / lattice)));
  const auto corner = [&] {
    Vec3 v;
    for (double& x : v) x = static_cast<double>(step(random)) * lattice;
    return v;
  };
  std::vector<Facets> all;
  for (int i = 0; i < count; ++i) {
    const Vec3 a = corner(), b = corner(), c = corner(), d = corner();
    all.push_back(tetrahedron(a, b, c, d));
  }
  return all;
}

Facets sphere(const Vec3& centre, double radius, int levels, double lattice) {
  Facets facets;
  for (const double x : {1.0, -1.0}) {
    for (const double y : {1.0, -1.0}) {
      for (const double z : {1.0, -1.0}) {
        const mesher::Facet octant = {{Vec3{x, 0, 0}, Vec3{0, y, 0}, Vec3{0, 0, z}}};
        facets.push_back(x * y * z > 0 ? octant : flip({octant})[0]);
      }
    }
  }
  for (int level = 0; level < levels; ++level) {
    Facets finer;
    for (const mesher::Facet& f : facets) {
      const auto& [a, b, c] = f.vertex;
      const Vec3 ab = midpoint_on_unit_sphere(a, b), bc = midpoint_on_unit_sphere(b, c), ca = midpoint_on_unit_sphere(c, a);
      finer.insert(finer.end(), {{{a, ab, ca}}, {{ab, b, bc}}, {{ca, bc, c}}, {{ab, bc, ca}}});
    }
    facets = std::move(finer);
  }
  for (mesher::Facet& f : facets) {
    for (Vec3& v : f.vertex) v = snapped(add(centre, {v[0] * radius, v[1] * radius, v[2] * radius}), lattice);
  }
  return facets;
}

Facets torus(const Vec3& centre, double ring_radius, double tube_radius, int ring_steps, int tube_steps, double lattice) {
  const auto vertex = [&](int ring, int tube) {
    const double u = 2 * std::numbers::pi * (ring % ring_steps) / ring_steps;
    const double v = 2 * std::numbers::pi * (tube % tube_steps) / tube_steps;
    const double r = ring_radius + tube_radius * std::cos(v);
    return snapped(add(centre, {r * std::cos(u), r * std::sin(u), tube_radius * std::sin(v)}), lattice);
  };
  Facets facets;
  for (int i = 0; i < ring_steps; ++i) {
    for (int j = 0; j < tube_steps; ++j) {
      add_quad(facets, vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1));
    }
  }
  return facets;
}

Facets extruded(const std::vector<std::array<double, 2>>& polygon, double z0, double z1) {
  const size_t n = polygon.size();
  const auto at = [&](size_t i, double z) { return Vec3{polygon[i % n][0], polygon[i % n][1], z}; };
  Facets facets;
  for (size_t i = 0; i < n; ++i) add_quad(facets, at(i, z0), at(i + 1, z0), at(i + 1, z1), at(i, z1));
  for (size_t i = 1; i + 1 < n; ++i) {
    facets.push_back({{at(0, z1), at(i, z1), at(i + 1, z1)}});
    facets.push_back({{at(0, z0), at(i + 1, z0), at(i, z0)}});
  }
  return facets;
}

Facets prism(const Vec3& centre, double radius, int sides, double height, double lattice) {
  std::vector<std::array<double, 2>> polygon;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    const Vec3 v = snapped(add(centre, {radius * std::cos(angle), radius * std::sin(angle), 0}), lattice);
    polygon.push_back({v[0], v[1]});
  }
  const double z0 = snapped({0, 0, centre[2] - height / 2}, lattice)[2];
  const double z1 = snapped({0, 0, centre[2] + height / 2}, lattice)[2];
  return extruded(polygon, z0, z1);
}

Facets l_shape(const Vec3& corner, double length, double thickness, double height) {
  const auto [x, y, z] = corner;
  return extruded(
      {{x, y}, {x + length, y}, {x + length, y + thickness}, {x + thickness, y + thickness}, {x + thickness, y + length}, {x, y + length}}, z,
      z + height);
}

Facets flip(Facets facets) {
  for (mesher::Facet& f : facets) std::swap(f.vertex[1], f.vertex[2]);
  return facets;
}

Facets translate(Facets facets, const Vec3& by) {
  for (mesher::Facet& f : facets) {
    for (Vec3& v : f.vertex) v = add(v, by);
  }
  return facets;
}

Facets join(const std::vector<Facets>& shells) {
  Facets all;
  for (const Facets& shell : shells) all.insert(all.end(), shell.begin(), shell.end());
  return all;
}

double volume(const Facets& facets) {
  double six_volumes = 0;
  for (const mesher::Facet& f : facets) six_volumes += triple(f.vertex[0], f.vertex[1], f.vertex[2]);
  return six_volumes / 6;
}

}  // namespace teracell::shapes
