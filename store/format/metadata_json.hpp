// Metadata <-> bytes: a zstd frame of JSON (FORMAT.md, "Metadata"). Pure: no I/O.
#pragma once
#include "store/format/channel_kinds.hpp"

namespace teracell::inline store {

Bytes encode_metadata(const Metadata& meta);
// Throws FormatError for what breaks FORMAT.md, and for a channel that the file requires and `known` does not have.
Metadata decode_metadata(std::span<const uint8_t> frame, std::span<const ChannelKind> known = channel_kinds());

}  // namespace teracell::store
