// The shape of a level: chunks and pages against counting them one by one.
#include "store/grid/metadata.hpp"

#include "tests/support/cube_grid.hpp"
#include "tests/support/test.hpp"

namespace teracell {
namespace {

TEST_CASE("Chunks and pages of a level divide its rays and cells without gap or overlap") {
  Metadata meta;
  meta.grid = unit_grid({300, 41, 97});
  meta.ray_axis = 1;
  meta.chunk_rays = 8;
  meta.chunk_cells = 16;
  meta.page_chunks = 3;
  for (int level = 0; level < meta.grid.levels(); ++level) {
    const LevelShape s(meta, level);
    const Index3 n = meta.grid.cells(level);
    REQUIRE((s.nu == n[0] && s.nv == n[2] && s.nw == n[1]));
    uint64_t rays = 0;
    std::vector<uint32_t> chunks(s.pages(), 0);
    for (uint32_t w = 0; w < s.segments; ++w)
      for (uint32_t v = 0; v < s.chunks_v; ++v)
        for (uint32_t u = 0; u < s.chunks_u; ++u) {
          const ChunkKey key{level, u, v, w};
          const uint64_t page = s.page_of(key);
          REQUIRE(page < s.pages());
          REQUIRE(s.key_of(page, chunks[page]) == key);
          REQUIRE(s.slot_of(key, page) == chunks[page]++);  // raster order within the page
          rays += uint64_t{s.rays_u(u)} * s.rays_v(v) * s.length(w);
        }
    REQUIRE(rays == uint64_t{s.nu} * s.nv * s.nw);
    for (uint64_t page = 0; page < s.pages(); ++page) REQUIRE(chunks[page] == s.page_size(page));
  }
}

}  // namespace
}  // namespace teracell
