// The channel that every file has. Its frames are chunks and pages, which have files of their own (chunk_codec, format), and
// verify() holds its levels against each other.
#include "store/format/channel_kinds.hpp"

namespace teracell::inline store {

const ChannelKind kLabelsKind = {kLabels, kRuns, nullptr};

}  // namespace teracell::store
