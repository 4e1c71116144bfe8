// How the cells of a level lie in chunks and shards. Indices are x, y, z, and count from the lower corner of what is exported.
#pragma once
#include "tools/export/place.hpp"

namespace teracell::exports::zarr {

struct Layout {
  int level;
  Box box;             // of the level's cells: what the array holds
  Index3 cells;        // of the array
  Index3 chunk_cells;  // of a chunk; those at the upper sides reach beyond the array
  Index3 chunks;       // of the array
  Index3 shard_chunks, shards;

  Index3 shard_cells() const;
  // The chunks of a shard, without those beyond the array.
  Box chunks_of_shard(const Index3& shard) const;
};

// The sides of a block of at most `most` units within `size`, as equal as that allows: thin arrays get long blocks.
Index3 block_within(const Index3& size, int64_t most);

// The arrays of an export, from its level up.
std::vector<Layout> layouts_of(const Export& e, int64_t most_cells_of_chunk, int64_t most_chunks_of_shard);

inline int64_t volume(const Index3& n) { return n[0] * n[1] * n[2]; }
// The number of an element of an array in C order, x fastest.
inline int64_t in_c_order(const Index3& i, const Index3& size) { return (i[2] * size[1] + i[1]) * size[0] + i[0]; }
inline Index3 from_c_order(int64_t number, const Index3& size) { return {number % size[0], number / size[0] % size[1], number / size[0] / size[1]}; }

}  // namespace teracell::exports::zarr
