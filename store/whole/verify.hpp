// Holds the whole of a file against FORMAT.md: every byte is read, belongs to exactly one part, and agrees with all that is
// said of it elsewhere in the file.
#pragma once
#include "store/format/channel_kinds.hpp"
#include "store/read/reader.hpp"
#include "store/write/part.hpp"

namespace teracell::inline store {

// Returns the hash of the labels (store/format/labels_hash.hpp). Throws FormatError at the first rule that is broken. `progress` gets the share that
// is done, from 0 to 1. The frames of a channel that `known` does not have are checked as bytes.
std::string verify(const GridReader& reader, int threads, const std::function<void(double)>& progress,
                   std::span<const ChannelKind> known = channel_kinds());
// The same of a part of a grid: each block is read, and each chunk decoded. Returns the number of chunks.
uint64_t verify(const PartReader& part);

}  // namespace teracell::store
