// What the benchmark peers share: a triangle mesh from an OBJ file, and the cubic domain around it. It does not use the
// project's own reader, so that a peer can be built and timed alone.
#pragma once
#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "tools/bench/peers/peer.hpp"

namespace teracell::bench {

struct Mesh {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;
};

// n^3 cells; cell i of axis a has its centre at min[a] + (i + 0.5) * step.
struct CubicDomain {
  std::array<double, 3> min;
  double step;
  int64_t n;
  double centre(int axis, int64_t i) const { return min[axis] + (static_cast<double>(i) + 0.5) * step; }
};

// The domain's centre is that of the box; its edge is the longest extent with one cell of pad at either end.
inline CubicDomain cubic_domain(const std::array<double, 3>& lo, const std::array<double, 3>& hi, int64_t n) {
  if (n < 3) throw std::runtime_error("at least 3 cells are needed: one of the mesh, one of pad at either end");
  const double longest = std::max({hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]});
  const double step = longest / static_cast<double>(n - 2);
  CubicDomain domain{{}, step, n};
  for (int a = 0; a < 3; ++a) domain.min[a] = (lo[a] + hi[a]) / 2 - step * static_cast<double>(n) / 2;
  return domain;
}

inline CubicDomain cubic_domain(const Mesh& mesh, int64_t n) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::array<double, 3> lo = {kInfinity, kInfinity, kInfinity}, hi = {-kInfinity, -kInfinity, -kInfinity};
  for (const auto& v : mesh.vertices) {
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], v[a]);
      hi[a] = std::max(hi[a], v[a]);
    }
  }
  return cubic_domain(lo, hi, n);
}

// `v` and `f` lines only, polygons as fans. Trusts the file: these are benchmark inputs.
inline Mesh load_obj(const std::string& path) {
  const std::string text = bytes_of(path);
  Mesh mesh;
  const char *at = text.data(), *const end = at + text.size();
  while (at < end) {
    const char* line_end = std::find(at, end, '\n');
    const auto skip_blanks = [&] {
      while (at < line_end && (*at == ' ' || *at == '\t' || *at == '\r')) ++at;
    };
    const bool is_vertex = line_end - at > 1 && at[0] == 'v' && at[1] == ' ';
    const bool is_face = line_end - at > 1 && at[0] == 'f' && at[1] == ' ';
    ++at;
    if (is_vertex) {
      auto& v = mesh.vertices.emplace_back();
      for (double& x : v) {
        skip_blanks();
        at = std::from_chars(at, line_end, x).ptr;
      }
    } else if (is_face) {
      std::vector<uint32_t> corners;
      for (skip_blanks(); at < line_end; skip_blanks()) {
        int64_t index = 0;
        at = std::from_chars(at, line_end, index).ptr;
        while (at < line_end && *at != ' ' && *at != '\r') ++at;  // texture and normal indices
        corners.push_back(static_cast<uint32_t>(index < 0 ? static_cast<int64_t>(mesh.vertices.size()) + index : index - 1));
      }
      for (size_t i = 2; i < corners.size(); ++i) mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
    }
    at = line_end + 1;
  }
  return mesh;
}

}  // namespace teracell::bench
