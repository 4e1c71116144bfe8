// The same cells in another order, for readers that are far away and pay for each request:
//
//   header | frames of other channels | chunks of level 0, 2, 3 ... | chunks and pages of level 1 | pages of level 0, 2, 3 ... |
//   directories | metadata | report | footer
//
// So the end of the file, which a reader fetches first, leads to chunks of coarse levels at once, and to those of level 0 by one page.
// Chunks lie in Morton order, page by page: a square of them that begins at a multiple of its side is one stretch of bytes.
#pragma once
#include <filesystem>
#include <functional>

#include "store/read/reader.hpp"

namespace teracell::inline store {

struct PackOptions {
  bool with_level_1 = true;  // as large as level 0; otherwise it stays derived from it, which takes four times the bytes of other tiles
  int threads = 1;           // that make level 1
};

// Writes the grid to `path`. Frames of chunks and of other channels are copied as they are, against their checksums. progress(share) may
// throw to stop. When it returns the file is durable. Memory: 40 bytes per page, and two pages of chunks per thread.
void pack(const GridReader& reader, const std::filesystem::path& path, const PackOptions& options, const std::function<void(double)>& progress);

}  // namespace teracell::store
