// What all cells of level 0 add up to, chunk by chunk and in any order: one number for what they are, and how many each label has.
#pragma once
#include "store/format/format.hpp"
#include "store/format/labels_hash.hpp"

namespace teracell::inline store {

struct CellSums {
  LabelsSum labels;
  std::vector<LabelAmount> amounts;  // by label, up to the last one that has cells

  // Of a chunk, from its entry in the index. `shape` is that of level 0. REQUIRES: what the entry says lies in the chunk.
  void add_amounts(const LevelShape& shape, const RayFrame& frame, const ChunkKey& key, const ChunkEntry& entry);
  CellSums& operator+=(const CellSums& other);
  void save(Bytes& out) const;
  static CellSums restored(ByteReader& in);
};

}  // namespace teracell::store
