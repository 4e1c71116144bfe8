// The channel `fractions`: what mixed cells are made of (mixed_cells.hpp), a frame for each chunk that has any.
#pragma once
#include "store/channels/mixed_cells.hpp"

namespace teracell::inline store {

Channel fractions_channel(const Subdivision& samples);
// Of a channel of this kind. Throws FormatError unless it says how many sub-samples a cell has.
Subdivision subdivision_of(const Channel& channel);
// The channel of a grid; null if it has none.
const Channel* find_fractions(const Metadata& meta);
// Decodes the frame of a chunk of the channel.
void decode_fractions(const Metadata& meta, const Channel& channel, const ChunkKey& key, const Subdivision& samples, std::span<const uint8_t> frame,
                      MixedCells& out);

}  // namespace teracell::store
