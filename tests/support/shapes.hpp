// Closed surfaces for tests, and the mesh files that hold them. Facets run anticlockwise seen from outside. Where a
// `lattice` is taken, vertices are rounded to its multiples (0 leaves them alone); facets that this collapses stay, so
// that the surface stays closed and the readers of it meet degenerate facets.
#pragma once
#include "mesher/surface/facet.hpp"
#include "tests/support/test.hpp"

namespace teracell::shapes {

using Facets = std::vector<mesher::Facet>;

Facets box(const Vec3& lo, const Vec3& hi);
// The box cut into six tetrahedra around its main diagonal (Kuhn's): they fill it without overlap.
std::vector<Facets> box_in_tetrahedra(const Vec3& lo, const Vec3& hi);
// Outward whatever the order of the corners, by the sign of the volume in doubles.
Facets tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
// Corners at random multiples of `lattice` in [lo, hi] on every axis. `lattice` > 0. Some may be flat.
std::vector<Facets> random_tetrahedra(std::mt19937_64& random, int count, double lo, double hi, double lattice);
// An octahedron whose facets are cut in four `levels` times: 8 * 4^levels facets.
Facets sphere(const Vec3& centre, double radius, int levels, double lattice = 0);
// Around the z axis through `centre`.
Facets torus(const Vec3& centre, double ring_radius, double tube_radius, int ring_steps, int tube_steps, double lattice = 0);
// A polygon of xy points, anticlockwise, star-shaped as seen from its first point, extruded from z0 to z1.
Facets extruded(const std::vector<std::array<double, 2>>& polygon, double z0, double z1);
// A regular polygon extruded.
Facets prism(const Vec3& centre, double radius, int sides, double height, double lattice = 0);
// Two arms of the given length and thickness along +x and +y from `corner`, `height` tall. length > thickness.
Facets l_shape(const Vec3& corner, double length, double thickness, double height);

Facets flip(Facets facets);  // inside out
Facets translate(Facets facets, const Vec3& by);
Facets join(const std::vector<Facets>& shells);
// Exact for lattice vertices of few bits.
double volume(const Facets& facets);

enum class Encoding { kAscii, kLittleEndian, kBigEndian };

// Throw std::runtime_error when the file can't be written. Vertices are rounded to float32 by STL and by PLY `float`.
void write_stl(const std::filesystem::path& path, const Facets& facets, Encoding encoding,
               const std::string& name = "shape");  // kAscii or kLittleEndian
void write_obj(const std::filesystem::path& path, const Facets& facets);
void write_ply(const std::filesystem::path& path, const Facets& facets, Encoding encoding, bool doubles);
// As the mesher reads them.
Facets facets_in(const std::filesystem::path& path);

}  // namespace teracell::shapes
