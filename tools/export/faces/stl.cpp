// Binary STL: a header of 80 bytes, the number of facets, and each facet with its normal and its corners in single precision. STL has
// no vertices that facets share: where cells touch along an edge alone, four facets have the edge. Those of one cell follow each
// other, so a program that joins facets as they come, such as admesh, joins them as they are meant.
#include <cmath>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/base/output_file.hpp"
#include "tools/export/faces/surface.hpp"
#include "tools/export/place.hpp"

namespace teracell::exports {
namespace faces {
namespace {

// Planes that are two for the grid have to be two in single precision.
void expect_distinct_planes(const Export& e) {
  for (int d = 0; d < 3; ++d)
    for (int64_t i = 0; i < size_of(e.box)[d]; ++i)
      if (static_cast<float>(plane_of(e, d, i)) >= static_cast<float>(plane_of(e, d, i + 1)) || std::isinf(static_cast<float>(plane_of(e, d, i + 1))))
        throw UsageError(
            fmt::format("--format: stl has coordinates of single precision, in which the planes {:.17g} and {:.17g} of {} are one: take ply",
                        plane_of(e, d, i), plane_of(e, d, i + 1), axis_name(d)));
}

void put_point(Bytes& out, const Vec3& point) {
  std::array<float, 3> p;
  for (size_t d = 0; d < 3; ++d) p[d] = static_cast<float>(point[d]) + 0.0F;  // no negative zeros: some programs compare bytes
  put_raw(out, p);
}

Vec3 normal_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  Vec3 n;
  for (size_t d = 0; d < 3; ++d) {
    const size_t u = (d + 1) % 3, v = (d + 2) % 3;
    n[d] = (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
  }
  const double length = std::hypot(n[0], n[1], n[2]);
  if (length > 0)
    for (double& d : n) d /= length;
  return n;
}

void write_stl(const Export& e) {
  expect_distinct_planes(e);
  OutputFile file(e.output);
  Surface surface(e, {0, 0.4}, {"stl", UINT64_MAX, UINT32_MAX, "ply, a coarser --level or a --region"});
  std::string header = fmt::format("teracell: boundary of cells, lengths in {}", e.reader.meta().units);
  header.resize(80, '\0');  // admesh takes it for a string that ends by itself
  Bytes bytes(header.begin(), header.end());
  put_raw(bytes, static_cast<uint32_t>(surface.facets()));
  surface.for_each_placed({0.4, 1}, [&](const Surface::Part& part) {
    part.piece.for_each_facet(part.box, [&](size_t, const std::array<uint32_t, 3>& vertex) {
      const Vec3 &a = part.places[vertex[0]], &b = part.places[vertex[1]], &c = part.places[vertex[2]];
      put_point(bytes, normal_of(a, b, c));
      for (const Vec3* point : {&a, &b, &c}) put_point(bytes, *point);
      put_raw(bytes, uint16_t{0});
      if (bytes.size() < size_t{1} << 16) return;
      file.append(bytes);
      bytes.clear();
    });
  });
  file.append(bytes);
  file.commit();
}

}  // namespace
}  // namespace faces

ExportFormat stl_format() {
  return {.name = "stl",
          .extensions = {".stl"},
          .holds = "the boundary of cells as a closed surface, in single precision",
          .write = faces::write_stl,
          .numbers = false,
          .options = faces::surface_options()};
}

}  // namespace teracell::exports
