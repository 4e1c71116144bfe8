// Zarr on disk: an array for each level from the chosen one up, in a folder or in a zip. Chunks of Zarr 3 are put together in shards, so
// there are few files; those of Zarr 2 are files of their own, so they are larger. Chunks of background alone are left out.
#pragma once
#include "tools/export/format.hpp"

namespace teracell::exports::zarr {

// How the cells are divided. Tests of small grids want small pieces.
struct Pieces {
  int64_t cells_of_chunk;
  int64_t chunks_of_shard;             // of one byte per cell; fewer of larger cells
  int64_t bytes_of_column = 16 << 20;  // that a thread works on at once
};
// Chunks of 64 and 128 cells a side. Shards have 8 chunks a side: one is kept in memory, and would take 128 MiB if it were noise. So
// 10^12 cells are at most 7,500 files of Zarr 3.
inline constexpr Pieces kPieces3{1 << 18, 1 << 9}, kPieces2{1 << 21, 1 << 9};

// `version` is 2 or 3.
void write_zarr(const Export& e, int version, const Pieces& pieces, int threads);

}  // namespace teracell::exports::zarr
