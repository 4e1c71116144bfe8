#include "store/channels/fractions.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "store/text/json_node.hpp"

namespace teracell::inline store {

Channel fractions_channel(const Subdivision& samples) {
  Channel out{kFractions, kStretches};
  out.about = Json{{"samples", samples}}.dump();
  return out;
}

Subdivision subdivision_of(const Channel& channel) {
  const std::string place = fmt::format("metadata: channel '{}'", channel.name);
  const Json about = parse_json(channel.about.empty() ? "{}" : channel.about, place, 16);
  Subdivision out;
  naming(place, [&] {
    const JsonNode node(about, place), samples = node.require("samples");
    const std::vector<JsonNode> items = samples.items(3);
    for (size_t d = 0; d < 3; ++d) out[d] = static_cast<uint32_t>(items[d].whole(65536));
    if (const std::string beyond = beyond_bounds(out); !beyond.empty()) throw FormatError(fmt::format("{} (FORMAT.md 13.1)", beyond));
  });
  return out;
}

const Channel* find_fractions(const Metadata& meta) {
  const auto found =
      std::ranges::find_if(meta.others(), [](const Channel& c) { return c.name == kFractions && (c.coding == kStretches || c.coding == kShares); });
  return found == meta.others().end() ? nullptr : &*found;
}

void decode_fractions(const Metadata& meta, const Channel& channel, const ChunkKey& key, const Subdivision& samples, std::span<const uint8_t> frame,
                      MixedCells& out) {
  const LevelShape s(meta, 0);
  const auto decode = channel.coding == kShares ? decode_shares : decode_mixed_cells;
  decode(frame, s.rays_u(key.cu), s.rays_v(key.cv), s.length(key.segment), static_cast<uint32_t>(meta.labels.size()), sub_samples(samples), out);
}

}  // namespace teracell::store
