#include "tools/export/zarr/layout.hpp"

#include <algorithm>

#include "store/grid/ome.hpp"

namespace teracell::exports::zarr {
namespace {

// How many blocks cover the size.
Index3 blocks_of(const Index3& size, const Index3& block) {
  Index3 out;
  for (int d = 0; d < 3; ++d) out[d] = (size[d] - 1) / block[d] + 1;
  return out;
}

}  // namespace

Index3 Layout::shard_cells() const {
  Index3 out;
  for (int d = 0; d < 3; ++d) out[d] = shard_chunks[d] * chunk_cells[d];
  return out;
}

Box Layout::chunks_of_shard(const Index3& shard) const {
  Box out;
  for (int d = 0; d < 3; ++d) {
    out.lo[d] = shard[d] * shard_chunks[d];
    out.hi[d] = std::min(chunks[d], out.lo[d] + shard_chunks[d]);
  }
  return out;
}

Index3 block_within(const Index3& size, int64_t most) {
  Index3 block{1, 1, 1};
  for (;;) {
    int shortest = -1;  // of the sides that can grow
    for (int d = 0; d < 3; ++d)
      if (block[d] < size[d] && volume(block) / block[d] * std::min(size[d], 2 * block[d]) <= most && (shortest < 0 || block[d] < block[shortest]))
        shortest = d;
    if (shortest < 0) return block;
    block[shortest] = std::min(size[shortest], 2 * block[shortest]);
  }
}

std::vector<Layout> layouts_of(const Export& e, int64_t most_cells_of_chunk, int64_t most_chunks_of_shard) {
  std::vector<Layout> out;
  for (int level = e.level; level < e.reader.levels(); ++level) {
    Layout a{.level = level, .box = box_above(e.box, level - e.level)};
    a.cells = size_of(a.box);
    a.chunk_cells = block_within(a.cells, most_cells_of_chunk);
    a.chunks = blocks_of(a.cells, a.chunk_cells);
    a.shard_chunks = block_within(a.chunks, most_chunks_of_shard);
    a.shards = blocks_of(a.chunks, a.shard_chunks);
    out.push_back(a);
  }
  return out;
}

}  // namespace teracell::exports::zarr
