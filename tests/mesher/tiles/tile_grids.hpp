// Grids of few rays in many small tiles, facets all over them, and the rays that a facet meets by the plain definition.
#pragma once
#include "mesher/tiles/rays.hpp"
#include "tests/support/random.hpp"

namespace teracell::mesher {

// The axes along which the rays run and lie, by the frame: u, v, w.
inline Metadata tile_grid(int ray_axis, const Axis& u, const Axis& v, const Axis& w, uint32_t chunk_rays) {
  Metadata meta;
  meta.ray_axis = ray_axis;
  meta.chunk_rays = chunk_rays;
  const RayFrame f = meta.frame();
  meta.grid.axis[f.u] = u, meta.grid.axis[f.v] = v, meta.grid.axis[f.w] = w;
  return meta;
}

inline Axis graded_axis(double from, int64_t cells) {
  std::vector<double> planes;
  for (int64_t i = 0; i <= cells; ++i) planes.push_back(from + static_cast<double>(i) + static_cast<double>(i * i) * 0.01);
  return Axis::graded(std::move(planes), 0.5);
}

// One tile, several in one unit, trees of several levels, axes that chunks don't divide, a crop of a larger grid.
inline std::vector<Metadata> tile_grids() {
  const auto uniform = [](int64_t cells) { return Axis::uniform(0, 1, 0, cells, 0.5); };
  return {
      tile_grid(2, uniform(5), uniform(7), uniform(9), 64),
      tile_grid(2, uniform(16), uniform(13), uniform(8), 4),
      tile_grid(0, uniform(70), uniform(33), uniform(20), 2),
      tile_grid(1, uniform(130), uniform(3), uniform(20), 2),
      tile_grid(2, graded_axis(-3, 40), uniform(50), graded_axis(0, 12), 3),
      tile_grid(1, Axis::uniform(-7.3, 0.1, 1000, 60, 0.25), Axis::uniform(100, 0.3, 5, 41, 0), uniform(6), 4),
  };
}

// Rays of an axis that a facet from lo to hi meets, half open: shifted rays are above lo when they are at it, and above hi too.
inline std::pair<uint32_t, uint32_t> rays_between(const Axis& axis, double lo, double hi) {
  uint32_t first = 0, last = 0;
  while (first < axis.cells() && axis.centre(first) < lo) ++first;
  while (last < axis.cells() && axis.centre(last) < hi) ++last;
  return {first, last};
}

inline RayRange exact_range(const Metadata& meta, const Facet& facet) {
  const auto on = [&](int d) {
    const auto [lo, hi] = std::minmax({facet.vertex[0][d], facet.vertex[1][d], facet.vertex[2][d]});
    return rays_between(meta.grid.axis[d], lo, hi);
  };
  const auto [u0, u1] = on(meta.frame().u);
  const auto [v0, v1] = on(meta.frame().v);
  return {u0, u1, v0, v1};
}

// Facets from a tenth of a cell to all of the grid and beyond, often with vertices on sample points and planes.
inline std::vector<mesher::Facet> facets_over(std::mt19937_64& random, const Metadata& meta, size_t count) {
  std::vector<mesher::Facet> out(count);
  for (mesher::Facet& f : out) {
    const int kind = testing::random_int(random, 0, 9);
    for (int d = 0; d < 3; ++d) {
      const Axis& axis = meta.grid.axis[d];
      const double cell = axis.shortest_cell(), width = axis.max() - axis.min();
      const double at = testing::random_in(random, axis.min() - 2 * cell, axis.max() + 2 * cell), size = kind < 7   ? 1.5 * cell
                                                                                                         : kind < 9 ? width / 8
                                                                                                                    : 2 * width;
      for (Vec3& v : f.vertex) {
        v[d] = at + testing::random_in(random, -size, size);
        const int64_t i = testing::random_int(random, 0, static_cast<int>(axis.cells()) - 1);
        if (kind == 0) v[d] = axis.centre(i);
        if (kind == 1) v[d] = axis.plane(std::clamp<int64_t>(static_cast<int64_t>((v[d] - axis.min()) / cell), 0, axis.cells()));
      }
    }
  }
  return out;
}

}  // namespace teracell::mesher
