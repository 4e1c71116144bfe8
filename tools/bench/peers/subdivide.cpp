// subdivide IN OUT.stl DEPTH: cuts every facet of a surface into four, DEPTH times, and writes a binary STL: a large input for
// the benchmark. A midpoint depends on the edge's two ends alone, so a closed surface stays closed.
#include <array>
#include <cstdio>
#include <cstring>

#include "mesher/surface/read_facets.hpp"
#include "tools/bench/peers/peer.hpp"

namespace {

using Point = std::array<float, 3>;

Point middle(const Point& a, const Point& b) {
  Point m;
  for (int d = 0; d < 3; ++d) m[d] = static_cast<float>((double{a[d]} + double{b[d]}) / 2);
  return m;
}

void write(std::FILE* out, const Point& a, const Point& b, const Point& c, int64_t depth) {
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

void run(const teracell::bench::Arguments& arguments) {
  const int64_t depth = teracell::bench::whole_number(arguments[2]);
  if (depth < 0 || depth > 8) throw std::runtime_error("expected a depth of 0 to 8, found " + arguments[2]);
  std::FILE* out = std::fopen(arguments[1].c_str(), "wb");
  if (!out) throw std::runtime_error("can't write " + arguments[1]);
  char head[84] = {};
  std::fwrite(head, 84, 1, out);
  uint32_t facets = 0;
  teracell::mesher::read_facets(arguments[0], "", [&](std::span<const teracell::mesher::Facet> batch) {
    for (const teracell::mesher::Facet& f : batch) {
      std::array<Point, 3> p;
      for (int i = 0; i < 3; ++i)
        for (int d = 0; d < 3; ++d) p[i][d] = static_cast<float>(f.vertex[i][d]);
      write(out, p[0], p[1], p[2], depth);
      facets += 1u << 2 * depth;
    }
  });
  std::fseek(out, 80, SEEK_SET);
  std::fwrite(&facets, 4, 1, out);
  if (std::ferror(out) != 0 || std::fclose(out) != 0) throw std::runtime_error("can't write " + arguments[1] + ": no space?");
}

}  // namespace

int main(int argc, char** argv) { return teracell::bench::peer_main(argc, argv, "subdivide IN OUT.stl DEPTH", 3, 3, run); }
