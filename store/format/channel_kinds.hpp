// The kinds of channels that this program knows. A new kind is a file that makes its frames, reads them, checks them and defines its
// ChannelKind, and a line here. The content hash and verify() need no change: they go through the cover of every channel, known
// or not. GridWriter::put_frame() writes the frames.
#pragma once
#include <functional>
#include <span>
#include <string_view>

#include "store/base/bytes.hpp"
#include "store/grid/metadata.hpp"

// clang-format off
#define TERACELL_CHANNEL_KINDS(kind) \
  kind(kLabelsKind) \
  kind(kFractionsKind) \
  kind(kOldFractionsKind) \
  kind(kLinksKind)
// clang-format on

namespace teracell::inline store {

class GridReader;

struct ChannelKind {
  std::string_view name, coding;
  // Throws FormatError unless the frames of the channel are what its coding says, and agree with the labels, which are sound; `frame(i)`
  // reads frame i of the cover, held against its checksum. Null for the labels: verify() holds their levels against each other.
  void (*check)(const GridReader& reader, const Channel& channel, const std::function<Bytes(uint64_t)>& frame);
  // Throws FormatError unless Channel::about says what the kind needs, so that a file that does not is refused when it is opened, and not by
  // the first that reads the channel. Null: it needs nothing.
  void (*check_about)(const Channel& channel) = nullptr;
};

#define DECLARED(name) extern const ChannelKind name;
TERACELL_CHANNEL_KINDS(DECLARED)
#undef DECLARED

std::span<const ChannelKind> channel_kinds();
// Null if `kinds` has none of this name and coding.
const ChannelKind* find_kind(std::span<const ChannelKind> kinds, std::string_view name, std::string_view coding);

}  // namespace teracell::store
