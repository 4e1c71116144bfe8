#include "mesher/closing/caps.hpp"

#include <algorithm>
#include <cmath>

#include "mesher/closing/lengths.hpp"

namespace teracell::mesher {
namespace {

// The boundary as a graph over its vertices in lexicographic order.
class Graph {
 public:
  Graph(const std::vector<BoundaryEdge>& edges, bool evenodd) {
    for (const BoundaryEdge& e : edges) vertices_.push_back(e.from), vertices_.push_back(e.to);
    std::ranges::sort(vertices_);
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
    leaving_.resize(vertices_.size());
    next_.resize(vertices_.size());
    uint32_t id = 0;
    for (const BoundaryEdge& e : edges) {
      const uint32_t from = number(e.from), to = number(e.to);
      for (uint64_t k = 0; k < (evenodd ? 1 : e.net); ++k, ++id) {
        leaving_[from].push_back({to, id});
        if (evenodd) leaving_[to].push_back({from, id});
      }
    }
    used_.resize(id);
    for (auto& list : leaving_) std::ranges::sort(list);
  }

  const std::vector<Vec3>& vertices() const { return vertices_; }
  bool has_unused(uint32_t v) {
    while (next_[v] < leaving_[v].size() && used_[leaving_[v][next_[v]].second]) ++next_[v];
    return next_[v] < leaving_[v].size();
  }
  // REQUIRES: has_unused(v).
  uint32_t take_smallest(uint32_t v) {
    const auto [to, id] = leaving_[v][next_[v]++];
    used_[id] = true;
    return to;
  }

 private:
  uint32_t number(const Vec3& v) const { return static_cast<uint32_t>(std::ranges::lower_bound(vertices_, v) - vertices_.begin()); }
  std::vector<Vec3> vertices_;
  std::vector<std::vector<std::pair<uint32_t, uint32_t>>> leaving_;  // of each vertex: the other end and the edge's number
  std::vector<size_t> next_;                                         // in leaving_
  std::vector<bool> used_;
};

// Calls f(loop) with the vertices of each simple loop. At every vertex as many edges enter as leave (by parity: an even number
// of edges meets), so a walk never gets stuck.
template <class F>
void for_each_loop(Graph& graph, F&& f) {
  const auto count = static_cast<uint32_t>(graph.vertices().size());
  constexpr uint32_t kOffPath = ~uint32_t{0};
  std::vector<uint32_t> path, place(count, kOffPath);
  for (uint32_t start = 0; start < count; ++start) {
    if (!graph.has_unused(start)) continue;
    path = {start};
    place[start] = 0;
    while (graph.has_unused(path.back())) {
      const uint32_t to = graph.take_smallest(path.back());
      if (place[to] == kOffPath) {
        place[to] = static_cast<uint32_t>(path.size());
        path.push_back(to);
        continue;
      }
      f(std::span<const uint32_t>(path).subspan(place[to]));
      while (path.back() != to) {
        place[path.back()] = kOffPath;
        path.pop_back();
      }
    }
    place[start] = kOffPath;
  }
}

double area(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 p = b - a, q = c - a;
  return length({p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]}) / 2;
}

}  // namespace

std::vector<Loop> cut_into_loops(const std::vector<BoundaryEdge>& edges, bool evenodd) {
  std::vector<Loop> out;
  Graph graph(edges, evenodd);
  for_each_loop(graph, [&](std::span<const uint32_t> loop) {
    Loop& vertices = out.emplace_back();
    for (const uint32_t v : loop) vertices.push_back(graph.vertices()[v]);
  });
  return out;
}

Vec3 apex_of(const Loop& loop, bool float32) {
  Loop ascending = loop;
  std::ranges::sort(ascending);
  Vec3 sum{}, lo = ascending[0], hi = lo, apex;
  for (const Vec3& v : ascending) {
    for (int d = 0; d < 3; ++d) sum[d] += v[d];
    extend(lo, hi, v);
  }
  for (int d = 0; d < 3; ++d) {
    apex[d] = std::clamp(sum[d] / static_cast<double>(loop.size()), lo[d], hi[d]);
    if (float32) apex[d] = static_cast<float>(apex[d]);
    if (std::abs(apex[d]) < 1e-75) apex[d] = 0;  // a remainder of vertices that cancel; smaller coordinates are not allowed
  }
  return apex;
}

// The plane goes through the mean of the vertices, and its normal is that of the area that the loop encloses, seen along it. Of a loop that
// encloses none, such as a crack that goes forth and back, it is that of the farthest vertex from the mean and of the vertex farthest from
// the line through both; there is none if all lie on that line.
double off_plane(const Loop& loop) {
  Vec3 mean{0, 0, 0}, normal{0, 0, 0};
  for (const Vec3& v : loop)
    for (int d = 0; d < 3; ++d) mean[d] += v[d] / static_cast<double>(loop.size());
  const auto from_mean = [&](size_t i) {
    const Vec3& v = loop[i % loop.size()];
    return Vec3{v[0] - mean[0], v[1] - mean[1], v[2] - mean[2]};
  };
  for (size_t i = 0; i < loop.size(); ++i) {
    const Vec3 a = from_mean(i), b = from_mean(i + 1);
    for (int d = 0; d < 3; ++d) normal[d] += a[(d + 1) % 3] * b[(d + 2) % 3] - a[(d + 2) % 3] * b[(d + 1) % 3];
  }
  const auto cross = [](const Vec3& a, const Vec3& b) {
    return Vec3{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const auto size = [](const Vec3& v) { return std::hypot(v[0], v[1], v[2]); };
  size_t farthest = 0;
  for (size_t i = 1; i < loop.size(); ++i)
    if (size(from_mean(i)) > size(from_mean(farthest))) farthest = i;
  const Vec3 far = from_mean(farthest);
  constexpr double kNoArea = 1e-9;  // of the square of the loop's size
  if (!(size(normal) > kNoArea * size(far) * size(far)))
    for (size_t i = 0; i < loop.size(); ++i)
      if (const Vec3 other = cross(far, from_mean(i)); size(other) > size(normal)) normal = other;
  const double length = size(normal);
  if (!(length > 0)) return 0;
  double off = 0;
  for (size_t i = 0; i < loop.size(); ++i) {
    const Vec3 v = from_mean(i);
    off = std::max(off, std::abs(v[0] * normal[0] + v[1] * normal[1] + v[2] * normal[2]) / length);
  }
  return off;
}

Hole measure_hole(const Loop& loop, const Vec3& apex) {
  Hole hole{apex, loop[0], loop[0], loop.size(), 0, 0, 0, off_plane(loop)};
  double around = 0;
  for (size_t i = 0; i < loop.size(); ++i) {
    const Vec3 &a = loop[i], &b = loop[(i + 1) % loop.size()];
    extend(hole.lo, hole.hi, a);
    hole.diameter = std::max(hole.diameter, 2 * distance(a, apex));
    hole.cap_area += area(a, b, apex);
    around += distance(a, b);
  }
  hole.width = around > 0 ? std::min(4 * hole.cap_area / around, hole.diameter) : 0;
  return hole;
}

void cap_loop(const Loop& loop, bool float32, const Matrix& matrix, Caps& out) {
  const Vec3 apex = apex_of(loop, float32);
  Loop moved;
  for (size_t i = 0; i < loop.size(); ++i) {
    out.facets.push_back({{loop[(i + 1) % loop.size()], loop[i], apex}});
    moved.push_back(transform(matrix, loop[i]));
  }
  out.holes.push_back(measure_hole(moved, transform(matrix, apex)));
}

}  // namespace teracell::mesher
