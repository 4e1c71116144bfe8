#include "tests/support/ties.hpp"

namespace teracell::shapes {
namespace {

using testing::random_in;
using testing::random_int;

// Half of its faces lie on the centres of unit cells.
Facets half_cell_box(std::mt19937_64& random, int n) {
  Vec3 lo, hi;
  for (int d = 0; d < 3; ++d) {
    lo[d] = random_int(random, -1, 2 * n - 2) / 2.0;
    hi[d] = lo[d] + random_int(random, 1, n) / 2.0;
  }
  return box(lo, hi);
}

Facets any_shell(std::mt19937_64& random, int n) {
  const Vec3 centre = {n / 2.0, n / 2.0, n / 2.0};
  switch (random_int(random, 0, 6)) {
    case 0: return half_cell_box(random, n);
    case 1: return join({half_cell_box(random, n), half_cell_box(random, n)});  // they may overlap
    case 2: return sphere(centre, random_in(random, 1, n / 2.0), 1, 0.5);
    case 3: return join(random_tetrahedra(random, 3, -1, n + 1, 0.5));
    case 4: return torus(centre, n / 3.0, n / 8.0, 7, 5, 0.25);
    case 5: return join(box_in_tetrahedra({0.5, 0.5, 0.5}, {n - 0.5, n - 0.5, n - 0.5}));  // they touch
    default: return l_shape({0.5, 1.5, 0.5}, n - 2, 1, n - 3);
  }
}

double tiny(std::mt19937_64& random) { return std::ldexp(1.0, -random_int(random, 20, 50)); }

}  // namespace

Facets shell_of_ties(std::mt19937_64& random, int n) {
  Facets facets = any_shell(random, n);
  return random_int(random, 0, 2) == 0 ? flip(std::move(facets)) : facets;
}

Axis axis_of_ties(std::mt19937_64& random, int n) {
  const double sample = std::array{0.5, 0.0, 0.25}[random_int(random, 0, 2)];
  if (random_int(random, 0, 2) == 0) {
    std::vector<double> planes = {-1};
    while (planes.back() < n + 1) planes.push_back(planes.back() + random_int(random, 1, 6) / 4.0);
    return Axis::graded(planes, sample);
  }
  const double step = std::array{1.0, 0.5, 0.75}[random_int(random, 0, 2)];
  return Axis::uniform(-0.5, step, 0, static_cast<int64_t>((n + 1) / step), sample);
}

Grid grid_of_ties(std::mt19937_64& random, int n) {
  Grid grid;
  for (Axis& axis : grid.axis) axis = axis_of_ties(random, n);
  return grid;
}

std::vector<oracle::Body> bodies_of_ties(std::mt19937_64& random, int n, int most) {
  std::vector<oracle::Body> bodies;
  for (int b = random_int(random, 1, most); b > 0; --b) {
    oracle::Body body{shell_of_ties(random, n)};
    if (random_int(random, 0, 2) == 0) body.rule = oracle::Rule::kEvenodd;
    body.material = static_cast<uint32_t>(random_int(random, 1, 3));
    body.priority = random_int(random, 0, 2);
    bodies.push_back(std::move(body));
  }
  return bodies;
}

std::vector<Facets> decimal_tetrahedra(std::mt19937_64& random, int count) {
  std::vector<Facets> all = random_tetrahedra(random, count, 0, 10, 1);
  for (Facets& facets : all)
    for (mesher::Facet& f : facets)
      for (Vec3& p : f.vertex)
        for (double& x : p) x = x / 10 + 0.05;
  return all;
}

std::vector<oracle::Body> decimal_bodies(std::mt19937_64& random, uint32_t materials) {
  std::vector<oracle::Body> bodies;
  for (uint32_t material = 1; material <= materials; ++material)
    bodies.push_back({join(decimal_tetrahedra(random, 2)), oracle::Rule::kNonzero, material});
  return bodies;
}

Facets needle(std::mt19937_64& random) {
  Vec3 p;
  for (double& x : p) x = random_in(random, 0, 9);
  Vec3 q = p, s = p;
  q[random_int(random, 0, 2)] += 9;
  Vec3 r = q;
  r[random_int(random, 0, 2)] += tiny(random);
  s[random_int(random, 0, 2)] -= 7;
  return tetrahedron(p, q, r, s);
}

Facets sheet(std::mt19937_64& random) {
  const double thickness = tiny(random);
  return tetrahedron({0.5, 0.5, 0.5}, {9.5, 9.5, 0.5 + thickness}, {9.5, 9.5, 9.5}, {9.5 + thickness, 9.5, 0.5});
}

Grid uneven_grid(int64_t nx, int64_t ny, size_t planes_of_z) {
  std::vector<double> planes = {-0.5};
  while (planes.size() < planes_of_z) planes.push_back(planes.back() + 0.25 * static_cast<double>(1 + planes.size() % 3));
  return {{Axis::uniform(0, 0.5, 0, nx, 0.5), Axis::uniform(-1, 1, 0, ny, 0.25), Axis::graded(planes, 0.5)}};
}

}  // namespace teracell::shapes
