// The channel `fractions`: what mixed cells are made of (mixed_cells.hpp), chunk by chunk.
#pragma once
#include "store/mixed_cells.hpp"
#include "store/reader.hpp"

namespace teracell {

Channel fractions_channel(const Subdivision& samples);
// Of a channel of this kind. Throws FormatError unless it says how many sub-samples a cell has.
Subdivision subdivision_of(const Channel& channel);
// The channel of a grid; null if it has none.
const Channel* find_fractions(const Metadata& meta);

// The mixed cells of a chunk of level 0. Throws FormatError or IoError. REQUIRES: the channel is one of fractions.
void read_mixed_cells(const GridReader& reader, const Channel& channel, const ChunkKey& key, MixedCells& out);

}  // namespace teracell
