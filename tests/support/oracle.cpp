// The winding number as the multiplicity of a cone.
//
// Take any point O, the apex, and join every facet ABC to it. The tetrahedra OABC, each counted +1 or -1 by its
// orientation, form a solid chain whose boundary is the facets plus the triangles that join O to their edges. On a
// closed surface each edge is used once each way, so those triangles cancel and the boundary is the surface alone.
// Hence the winding number around p is the sum, over the tetrahedra that hold p, of their orientations; it does not
// depend on O. (F. Feito and J. C. Torres, "Inclusion test for general polyhedra", 1997.) Modulo 2 the same holds when
// each edge is merely used an even number of times, and the sum's parity is the number of tetrahedra that hold p.
//
// The shift (e, e^2, e^3). p is inside a tetrahedron when it lies on the inner side of its four planes. With n the
// plane's normal and a a point of the plane, the side of the shifted point is the sign of
//     n . (p + (e, e^2, e^3) - a)  =  (n . p - n . a)  +  n_x e  +  n_y e^2  +  n_z e^3,
// for small e > 0 the sign of its first coefficient that is not 0. A tetrahedron of nonzero volume has no zero normal,
// so that sign is never 0 and no tie is left. One without volume has no inside and counts nothing.
//
// Sheets. The line along axis d through a shifted point crosses a facet if the point lies on the same side of the three
// planes through the facet's edges and the direction d, all turned alike; the crossing lies between two points of the line
// when they are on different sides of the facet's plane. Where the facet's normal has no part along d, no line along d crosses
// it: the shift takes it off the facet's plane.
//
// Exactness. Every double is an integer times a power of two; with one power for all of them, all arithmetic above is
// in integers: 128 bits when the coordinates are below 2^40 (lattices), as many as needed otherwise.
#include "tests/support/oracle.hpp"

#include <boost/multiprecision/cpp_int.hpp>

namespace teracell::oracle {
namespace {

using boost::multiprecision::cpp_int;
using Int128 = __int128;

// The scale is 2^exponent: the lowest bit set in any coordinate. `bits` is the length of the longest integer.
struct Scale {
  int exponent = std::numeric_limits<int>::max();
  int top = std::numeric_limits<int>::min();
  int bits() const { return top > exponent ? top - exponent : 0; }

  void add(double v) {
    if (v == 0) return;
    int e;
    int64_t mantissa = static_cast<int64_t>(std::ldexp(std::frexp(std::abs(v), &e), 53));  // |v| = mantissa * 2^(e-53)
    top = std::max(top, e);
    for (e -= 53; mantissa % 2 == 0; mantissa /= 2) ++e;
    exponent = std::min(exponent, e);
  }
};

template <class Int>
Int scaled(double v, const Scale& scale) {
  if (v == 0) return 0;
  int e;
  Int mantissa = static_cast<int64_t>(std::ldexp(std::frexp(v, &e), 53));
  const int shift = e - 53 - scale.exponent;  // below 0 only over bits that are 0
  for (int i = 0; i < -shift; ++i) mantissa /= 2;
  return shift > 0 ? Int(mantissa * (Int(1) << shift)) : mantissa;
}

template <class Int>
using Point = std::array<Int, 3>;

template <class Int>
int sign(const Int& v) {
  return v > 0 ? 1 : v < 0 ? -1 : 0;
}

// The points with n . p + d = 0.
template <class Int>
struct Plane {
  Point<Int> n;
  Int d;

  Plane(const Point<Int>& a, const Point<Int>& b, const Point<Int>& c) {
    Point<Int> u, v;
    for (int i = 0; i < 3; ++i) {
      u[i] = b[i] - a[i];
      v[i] = c[i] - a[i];
    }
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      n[i] = u[j] * v[k] - u[k] * v[j];
    }
    d = -(n[0] * a[0] + n[1] * a[1] + n[2] * a[2]);
  }

  int side(const Point<Int>& p) const { return sign<Int>(n[0] * p[0] + n[1] * p[1] + n[2] * p[2] + d); }

  int shifted_side(const Point<Int>& p) const {
    if (const int s = side(p)) return s;
    for (int i = 0; i < 3; ++i) {
      if (const int s = sign(n[i])) return s;
    }
    throw std::logic_error("oracle: a plane without a normal");
  }
};

// The half-open range of an axis's cells whose centres lie in [lo, hi].
std::pair<int64_t, int64_t> centres_within(const Axis& axis, double lo, double hi) {
  int64_t first = 0, last = axis.cells();
  while (first < last && axis.centre(first) < lo) ++first;
  while (last > first && axis.centre(last - 1) > hi) --last;
  return {first, last};
}

template <class Int>
std::vector<int> windings(const std::vector<mesher::Facet>& facets, const Grid& grid, const Vec3& apex, const Scale& scale) {
  const auto point = [&](const Vec3& v) { return Point<Int>{scaled<Int>(v[0], scale), scaled<Int>(v[1], scale), scaled<Int>(v[2], scale)}; };
  const Index3 n = grid.cells();
  std::array<std::vector<Int>, 3> centre;
  for (int a = 0; a < 3; ++a) {
    for (int64_t i = 0; i < n[a]; ++i) centre[a].push_back(scaled<Int>(grid.axis[a].centre(i), scale));
  }

  std::vector<int> winding(n[0] * n[1] * n[2], 0);
  const Point<Int> o = point(apex);
  for (const mesher::Facet& facet : facets) {
    const Point<Int> a = point(facet.vertex[0]), b = point(facet.vertex[1]), c = point(facet.vertex[2]);
    // Each plane with the tetrahedron's fourth corner: its side is the inner one.
    const std::array<Plane<Int>, 4> plane = {Plane<Int>(a, b, c), Plane<Int>(o, a, b), Plane<Int>(o, b, c), Plane<Int>(o, c, a)};
    const std::array<int, 4> inner = {plane[0].side(o), plane[1].side(c), plane[2].side(a), plane[3].side(b)};
    // Of a facet that faces away from O, O is on the negative side: such a tetrahedron counts +1.
    const int orientation = -inner[0];
    if (orientation == 0) continue;

    // A shifted point is inside the tetrahedron only if the point itself is in its closed box.
    std::array<std::pair<int64_t, int64_t>, 3> range;
    for (int k = 0; k < 3; ++k) {
      const auto [lo, hi] = std::minmax({apex[k], facet.vertex[0][k], facet.vertex[1][k], facet.vertex[2][k]});
      range[k] = centres_within(grid.axis[k], lo, hi);
    }
    for (int64_t z = range[2].first; z < range[2].second; ++z) {
      for (int64_t y = range[1].first; y < range[1].second; ++y) {
        for (int64_t x = range[0].first; x < range[0].second; ++x) {
          const Point<Int> p = {centre[0][x], centre[1][y], centre[2][z]};
          bool inside = true;
          for (int k = 0; k < 4 && inside; ++k) inside = plane[k].shifted_side(p) == inner[k];
          if (inside) winding[(z * n[1] + y) * n[0] + x] += orientation;
        }
      }
    }
  }
  return winding;
}

template <class Int>
Point<Int> exact_point(const Vec3& v, const Scale& scale) {
  return {scaled<Int>(v[0], scale), scaled<Int>(v[1], scale), scaled<Int>(v[2], scale)};
}

// Lines along `axis` against one facet.
template <class Int>
class LinesAndFacet {
 public:
  LinesAndFacet(const mesher::Facet& facet, int axis, const Scale& scale)
      : a_(exact_point<Int>(facet.vertex[0], scale)),
        b_(exact_point<Int>(facet.vertex[1], scale)),
        c_(exact_point<Int>(facet.vertex[2], scale)),
        plane_(a_, b_, c_),
        turn_(sign(plane_.n[axis])) {
    if (turn_ == 0) return;
    const auto beside = [&](Point<Int> p) {
      p[axis] += 1;
      return p;
    };
    edges_ = {Plane<Int>(a_, b_, beside(a_)), Plane<Int>(b_, c_, beside(b_)), Plane<Int>(c_, a_, beside(c_))};
  }
  int turn() const { return turn_; }  // sign of the normal's part along the axis
  bool crosses(const Point<Int>& p) const {
    if (turn_ == 0) return false;
    const int side = edges_[0].shifted_side(p);
    return side == edges_[1].shifted_side(p) && side == edges_[2].shifted_side(p);
  }
  // Whether the facet is above p. REQUIRES: crosses(p).
  bool is_above(const Point<Int>& p) const { return plane_.shifted_side(p) != turn_; }

 private:
  Point<Int> a_, b_, c_;
  Plane<Int> plane_;
  int turn_;
  std::vector<Plane<Int>> edges_;
};

void add_vertices(Scale& scale, const std::vector<mesher::Facet>& facets) {
  for (const mesher::Facet& f : facets)
    for (const Vec3& vertex : f.vertex)
      for (const double v : vertex) scale.add(v);
}

void add_centres(Scale& scale, const Grid& grid) {
  for (const Axis& axis : grid.axis)
    for (int64_t i = 0; i < axis.cells(); ++i) scale.add(axis.centre(i));
}

// Of the lines along d that may meet the facet: all cells along d, else those between its ends.
std::array<std::pair<int64_t, int64_t>, 3> lines_within(const mesher::Facet& facet, const Grid& grid, int d) {
  std::array<std::pair<int64_t, int64_t>, 3> range;
  for (int k = 0; k < 3; ++k) {
    const auto [lo, hi] = std::minmax({facet.vertex[0][k], facet.vertex[1][k], facet.vertex[2][k]});
    range[k] = k == d ? std::pair{int64_t{0}, grid.axis[k].cells()} : centres_within(grid.axis[k], lo, hi);
  }
  return range;
}

template <class Int>
std::vector<bool> sheet(const std::vector<mesher::Facet>& facets, const Grid& grid, const Scale& scale) {
  const Index3 n = grid.cells();
  std::vector<bool> out(n[0] * n[1] * n[2], false);
  for (const mesher::Facet& facet : facets) {
    for (int d = 0; d < 3; ++d) {
      const LinesAndFacet<Int> lines(facet, d, scale);
      if (lines.turn() == 0) continue;
      const auto range = lines_within(facet, grid, d);
      for (int64_t z = range[2].first; z < range[2].second; ++z)
        for (int64_t y = range[1].first; y < range[1].second; ++y)
          for (int64_t x = range[0].first; x < range[0].second; ++x) {
            const Index3 i = {x, y, z};
            Point<Int> lower;
            for (int k = 0; k < 3; ++k) lower[k] = scaled<Int>(grid.axis[k].centre(i[k]), scale);
            lower[d] = scaled<Int>(grid.axis[d].plane(i[d]), scale);
            Point<Int> upper = lower;
            upper[d] = scaled<Int>(grid.axis[d].plane(i[d] + 1), scale);
            if (lines.crosses(lower) && lines.is_above(lower) != lines.is_above(upper)) out[(z * n[1] + y) * n[0] + x] = true;
          }
    }
  }
  return out;
}

template <class Int>
std::vector<Interval> crossed_intervals(const std::vector<mesher::Facet>& facets, const Grid& grid, const Scale& scale) {
  std::map<std::pair<int, Index3>, Interval> found;
  for (const mesher::Facet& facet : facets) {
    for (int d = 0; d < 3; ++d) {
      const LinesAndFacet<Int> lines(facet, d, scale);
      if (lines.turn() == 0) continue;
      const auto range = lines_within(facet, grid, d);
      Index3 i;
      for (i[2] = range[2].first; i[2] < range[2].second; ++i[2])
        for (i[1] = range[1].first; i[1] < range[1].second; ++i[1])
          for (i[0] = range[0].first; i[0] < range[0].second; ++i[0]) {
            if (i[d] + 1 == grid.axis[d].cells()) continue;
            Point<Int> p;
            for (int k = 0; k < 3; ++k) p[k] = scaled<Int>(grid.axis[k].centre(i[k]), scale);
            if (!lines.crosses(p) || !lines.is_above(p)) continue;
            const double lower = grid.axis[d].centre(i[d]), upper = grid.axis[d].centre(i[d] + 1);
            p[d] = scaled<Int>(upper, scale);
            if (lines.is_above(p)) continue;
            uint32_t before = 0, beyond = 65536;
            while (beyond - before > 1) {
              const uint32_t k = (before + beyond) / 2;
              p[d] = scaled<Int>(lower + (k / 65536.0) * (upper - lower), scale);
              (lines.is_above(p) ? before : beyond) = k;
            }
            // Where it goes out of a surface, along the facet's normal, the line leaves one winding behind.
            Interval& interval = found.try_emplace({d, i}, Interval{d, i, {}}).first->second;
            interval.steps.emplace_back(beyond, -lines.turn());
          }
    }
  }
  std::vector<Interval> out;
  for (auto& [key, interval] : found) {
    std::sort(interval.steps.begin(), interval.steps.end());
    out.push_back(std::move(interval));
  }
  return out;
}

}  // namespace

std::vector<Interval> intervals(const std::vector<mesher::Facet>& facets, const Grid& grid) {
  Scale scale;
  add_vertices(scale, facets);
  add_centres(scale, grid);
  scale.exponent -= 16;  // a sub-position has no bit below a 65536th of the lowest one of the sample points
  return scale.bits() <= 40 ? crossed_intervals<Int128>(facets, grid, scale) : crossed_intervals<cpp_int>(facets, grid, scale);
}

std::vector<bool> sheet_cells(const std::vector<mesher::Facet>& facets, const Grid& grid) {
  Scale scale;
  add_vertices(scale, facets);
  add_centres(scale, grid);
  for (const Axis& axis : grid.axis)
    for (int64_t i = 0; i <= axis.cells(); ++i) scale.add(axis.plane(i));
  return scale.bits() <= 40 ? sheet<Int128>(facets, grid, scale) : sheet<cpp_int>(facets, grid, scale);
}

bool is_closed(const std::vector<mesher::Facet>& facets, Rule rule) {
  std::map<std::pair<Vec3, Vec3>, int64_t> uses;  // of the edge from its smaller vertex to its larger one
  for (const mesher::Facet& f : facets) {
    for (int i = 0; i < 3; ++i) {
      const Vec3 &a = f.vertex[i], &b = f.vertex[(i + 1) % 3];
      if (a == b) continue;
      if (a < b) uses[{a, b}] += 1;
      if (b < a) uses[{b, a}] -= 1;
    }
  }
  // One use either way changes the count by 1, so its parity is that of the number of uses.
  return std::all_of(uses.begin(), uses.end(), [&](const auto& edge) { return rule == Rule::kNonzero ? edge.second == 0 : edge.second % 2 == 0; });
}

std::vector<int> winding_numbers(const std::vector<mesher::Facet>& facets, const Grid& grid, const Vec3& apex) {
  Scale scale;
  for (const double v : apex) scale.add(v);
  add_vertices(scale, facets);
  add_centres(scale, grid);
  // Coordinates below 2^40 differ by less than 2^41; a normal's entries stay below 2 * 2^82 and n . p and n . a below
  // 3 * 2^83 * 2^40 < 2^125 each: their sum fits 128 bits.
  return scale.bits() <= 40 ? windings<Int128>(facets, grid, apex, scale) : windings<cpp_int>(facets, grid, apex, scale);
}

std::vector<uint32_t> materials(const std::vector<Body>& bodies, const Grid& grid) {
  const Index3 n = grid.cells();
  std::vector<uint32_t> material(n[0] * n[1] * n[2], 0);
  std::vector<int64_t> priority(material.size(), std::numeric_limits<int64_t>::min());
  for (const Body& body : bodies) {
    if (body.facets.empty()) continue;
    if (!body.sheet && !is_closed(body.facets, body.rule)) throw std::invalid_argument("oracle: a body's surface is not closed");
    // Any apex will do; one on the surface keeps the tetrahedra, and so the cells to test, few.
    const std::vector<int> winding = body.sheet ? std::vector<int>() : winding_numbers(body.facets, grid, body.facets[0].vertex[0]);
    const std::vector<bool> owned = body.sheet ? sheet_cells(body.facets, grid) : std::vector<bool>();
    for (size_t cell = 0; cell < material.size(); ++cell) {
      const bool inside = body.sheet ? owned[cell] : body.rule == Rule::kNonzero ? winding[cell] != 0 : winding[cell] % 2 != 0;
      if (!inside || body.priority < priority[cell]) continue;
      material[cell] = body.material;
      priority[cell] = body.priority;
    }
  }
  return material;
}

}  // namespace teracell::oracle
