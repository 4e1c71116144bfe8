// The chunks that a box of cells meets, and the part of each that lies in the box: what all questions about a box go through.
#pragma once
#include <algorithm>
#include <tuple>
#include <type_traits>

#include "store/grid/metadata.hpp"
#include "store/runs/run.hpp"

namespace teracell::inline store {

// Throws UsageError unless the box lies in the level.
void check_box(const Metadata& meta, int level, const Box& box);

// A box in the frame of the rays.
struct RayBox {
  int64_t u0, u1, v0, v1, w0, w1;
  RayBox(const Box& b, const RayFrame& f) : u0(b.lo[f.u]), u1(b.hi[f.u]), v0(b.lo[f.v]), v1(b.hi[f.v]), w0(b.lo[f.w]), w1(b.hi[f.w]) {}
};

// A chunk and the part of it that lies in a box, in the chunk's own rays and cells.
struct ChunkPart {
  ChunkKey key;
  uint32_t u0, u1, v0, v1, w0, w1;
  int64_t first_u, first_v, first_w;  // of the chunk, in the level
  bool all_rays, whole;
};

// Calls f(part) for the chunks that meet the box; if f returns a bool, up to the first false. REQUIRES: the box lies in the level.
template <class F>
void for_each_part(const LevelShape& s, const RayBox& b, F&& f) {
  const auto cut = [](int64_t lo, int64_t hi, int64_t first, int64_t size) {
    return std::pair{static_cast<uint32_t>(std::max<int64_t>(lo - first, 0)), static_cast<uint32_t>(std::min(hi - first, size))};
  };
  const auto chunk = [&](int64_t cu, int64_t cv, int64_t segment) {
    ChunkPart p;
    p.key = {s.level, static_cast<uint32_t>(cu), static_cast<uint32_t>(cv), static_cast<uint32_t>(segment)};
    p.first_u = cu * s.chunk_rays, p.first_v = cv * s.chunk_rays, p.first_w = segment * s.chunk_cells;
    std::tie(p.u0, p.u1) = cut(b.u0, b.u1, p.first_u, s.rays_u(p.key.cu));
    std::tie(p.v0, p.v1) = cut(b.v0, b.v1, p.first_v, s.rays_v(p.key.cv));
    std::tie(p.w0, p.w1) = cut(b.w0, b.w1, p.first_w, s.length(p.key.segment));
    p.all_rays = p.u0 == 0 && p.v0 == 0 && p.u1 == s.rays_u(p.key.cu) && p.v1 == s.rays_v(p.key.cv);
    p.whole = p.all_rays && p.w0 == 0 && p.w1 == s.length(p.key.segment);
    if constexpr (std::is_same_v<decltype(f(p)), bool>) return f(p);
    else return f(p), true;
  };
  // Page by page, so that each page of the index is read once.
  const int64_t side = s.page_chunks;
  const int64_t u0 = b.u0 / s.chunk_rays, u1 = (b.u1 - 1) / s.chunk_rays, v0 = b.v0 / s.chunk_rays, v1 = (b.v1 - 1) / s.chunk_rays;
  for (int64_t segment = b.w0 / s.chunk_cells; segment * s.chunk_cells < b.w1; ++segment)
    for (int64_t pv = v0 / side; pv <= v1 / side; ++pv)
      for (int64_t pu = u0 / side; pu <= u1 / side; ++pu)
        for (int64_t cv = std::max(v0, pv * side); cv <= std::min(v1, pv * side + side - 1); ++cv)
          for (int64_t cu = std::max(u0, pu * side); cu <= std::min(u1, pu * side + side - 1); ++cu)
            if (!chunk(cu, cv, segment)) return;
}

// Calls f(u, v) for the rays of a part.
template <class F>
void for_each_ray(const ChunkPart& p, F&& f) {
  for (uint32_t v = p.v0; v < p.v1; ++v)
    for (uint32_t u = p.u0; u < p.u1; ++u) f(u, v);
}

// Calls f(u, v, from, to, set id) for the runs of a part, in the chunk's own rays and cells.
template <class F>
void for_each_part_run(const RayBlock& rays, const ChunkPart& p, F&& f) {
  for (uint32_t v = p.v0; v < p.v1; ++v)
    for (uint32_t u = p.u0; u < p.u1; ++u)
      rays.for_each_run(v * rays.nu + u, p.w0, p.w1, [&](uint32_t from, uint32_t to, SetId set) { f(u, v, from, to, set); });
}

}  // namespace teracell::store
