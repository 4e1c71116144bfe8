// The links between neighbouring cells, read from a grid.
#pragma once
#include <functional>

#include "store/channels/links.hpp"
#include "store/read/cell_chunks.hpp"

namespace teracell::inline store {

// A link between a cell and its upper neighbour along an axis.
struct CellLink {
  Index3 cell;
  uint32_t end, begin;  // as in links.hpp
  uint32_t patch;       // kNoPatch: none is known
  friend bool operator==(const CellLink&, const CellLink&) = default;
};

// Reads the links of a grid. Threads may share it. Throws IoError or FormatError, like its reader.
class LinkReader {
 public:
  // Keeps a reference to the reader. Throws UsageError if the grid has no links.
  explicit LinkReader(const GridReader& reader);

  // The links of a chunk of level 0.
  std::shared_ptr<const ChunkLinks> chunk(const ChunkKey& key) const { return chunks_.get(key); }
  // Calls visit(links) with the links along an axis whose lower cells lie in `box`, chunk by chunk. Within a chunk they ascend by line and cell.
  // The part of the box outside the grid is left out.
  void for_each(int axis, const Box& box, const std::function<void(std::span<const CellLink>)>& visit) const;

 private:
  const GridReader& reader_;
  const CellChunks<ChunkLinks> chunks_;
};

}  // namespace teracell::store
