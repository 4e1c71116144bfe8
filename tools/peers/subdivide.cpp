// subdivide IN OUT.stl DEPTH: a surface with every facet cut into four, DEPTH times, as a binary STL: large real input
// for the benchmark. A midpoint depends on the edge's two ends alone, so a closed surface stays closed.
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "mesher/facets.hpp"

namespace {

using Point = std::array<float, 3>;

Point middle(const Point& a, const Point& b) {
  Point m;
  for (int d = 0; d < 3; ++d) m[d] = static_cast<float>((double{a[d]} + double{b[d]}) / 2);
  return m;
}

void write(std::FILE* out, const Point& a, const Point& b, const Point& c, int depth) {
  if (depth > 0) {
    const Point ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    write(out, a, ab, ca, depth - 1);
    write(out, ab, b, bc, depth - 1);
    write(out, ca, bc, c, depth - 1);
    write(out, ab, bc, ca, depth - 1);
    return;
  }
  char facet[50] = {};
  std::memcpy(facet + 12, &a, 12);
  std::memcpy(facet + 24, &b, 12);
  std::memcpy(facet + 36, &c, 12);
  std::fwrite(facet, 50, 1, out);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return std::fprintf(stderr, "usage: subdivide IN OUT.stl DEPTH\n"), 2;
  const int depth = std::atoi(argv[3]);
  std::FILE* out = std::fopen(argv[2], "wb");
  if (!out) return std::perror(argv[2]), 1;
  char head[84] = {};
  std::fwrite(head, 84, 1, out);
  uint32_t facets = 0;
  teracell::read_facets(argv[1], "", [&](std::span<const teracell::Facet> batch) {
    for (const teracell::Facet& f : batch) {
      std::array<Point, 3> p;
      for (int i = 0; i < 3; ++i)
        for (int d = 0; d < 3; ++d) p[i][d] = static_cast<float>(f.vertex[i][d]);
      write(out, p[0], p[1], p[2], depth);
      facets += 1u << 2 * depth;
    }
  });
  std::fseek(out, 80, SEEK_SET);
  std::fwrite(&facets, 4, 1, out);
  return std::fclose(out) != 0;
}
