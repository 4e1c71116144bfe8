#include "tools/export/faces/smooth.hpp"

#include <algorithm>

namespace teracell::exports::faces {
namespace {

// The edges of a piece. Vertices without edges stay where they are.
struct Links {
  explicit Links(const Piece& piece) : begin(piece.vertices() + 1, 0) {
    piece.for_each_link([&](uint32_t vertex, uint32_t neighbour) {
      ++begin[vertex + 1];
      neighbours.push_back(neighbour);
    });
    for (size_t v = 1; v < begin.size(); ++v) begin[v] += begin[v - 1];
  }
  std::vector<uint32_t> begin, neighbours;
};

struct Bounds {
  Vec3 least, most;
};

double plane(const Planes& planes, int axis, int64_t i) { return planes.at[axis][static_cast<size_t>(i - planes.first[axis])]; }

Bounds bounds_of(const Planes& planes, const Index3& place) {
  Bounds out;
  for (int d = 0; d < 3; ++d) {
    const double here = plane(planes, d, place[d]);
    const auto towards = [&](int64_t other) { return here + kReach / 2 * (plane(planes, d, other) - here); };
    out.least[d] = towards(place[d] - 1), out.most[d] = towards(place[d] + 1);
  }
  return out;
}

void step(const Links& links, const std::vector<Bounds>& bounds, double factor, const std::vector<Vec3>& from, std::vector<Vec3>& to) {
  for (size_t v = 0; v < from.size(); ++v) {
    to[v] = from[v];
    const uint32_t begin = links.begin[v], end = links.begin[v + 1];
    if (begin == end) continue;
    Vec3 sum{};
    for (uint32_t i = begin; i < end; ++i)
      for (int d = 0; d < 3; ++d) sum[d] += from[links.neighbours[i]][d];
    for (int d = 0; d < 3; ++d)
      to[v][d] = std::clamp(from[v][d] + factor * (sum[d] / (end - begin) - from[v][d]), bounds[v].least[d], bounds[v].most[d]);
  }
}

}  // namespace

void place_vertices(const Piece& piece, const Planes& planes, int rounds, std::vector<Vec3>& out) {
  out.resize(piece.vertices());
  for (uint32_t v = 0; v < piece.vertices(); ++v) {
    const Index3 place = piece.place(v);
    for (int d = 0; d < 3; ++d) out[v][d] = plane(planes, d, place[d]);
  }
  if (rounds > 0) {
    // Waves of less than some 10 cells are damped, longer ones stay: 1 / kShrink + 1 / kExpand = 0.1, as in an example of Taubin's.
    constexpr double kShrink = 0.6307, kExpand = -1 / (1 / kShrink - 0.1);
    const Links links(piece);
    std::vector<Bounds> bounds;
    for (uint32_t v = 0; v < piece.vertices(); ++v) bounds.push_back(bounds_of(planes, piece.place(v)));
    std::vector<Vec3> moved(out.size());
    for (int i = 0; i < rounds; ++i) {
      step(links, bounds, kShrink, out, moved);
      step(links, bounds, kExpand, moved, out);
    }
  }
  for (const MiddleVertex& m : piece.middles())
    for (int d = 0; d < 3; ++d) out[m.vertex][d] = (out[m.from][d] + out[m.to][d]) / 2;
}

}  // namespace teracell::exports::faces
