#include "store/channels/fractions.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "store/text/json_text.hpp"

namespace teracell::inline store {

Channel fractions_channel(const Subdivision& samples) {
  Channel out{kFractions, kShares};
  out.about = nlohmann::ordered_json{{"samples", samples}}.dump();
  return out;
}

Subdivision subdivision_of(const Channel& channel) {
  const auto about = parse_json(channel.about.empty() ? "{}" : channel.about, "metadata", 16);
  const auto samples = about.find("samples");
  Subdivision out{1, 1, 1};
  bool valid = samples != about.end() && samples->is_array() && samples->size() == 3;
  for (size_t d = 0; valid && d < 3; ++d) {
    const auto& n = (*samples)[d];
    valid = n.is_number_unsigned() && n.get<uint64_t>() <= 65536;
    if (valid) out[d] = n.get<uint32_t>();
  }
  if (!valid) throw FormatError(fmt::format("metadata: channel '{}' does not say how many sub-samples a cell has (FORMAT.md 13.1)", channel.name));
  if (const std::string beyond = beyond_bounds(out); !beyond.empty())
    throw FormatError(fmt::format("metadata: channel '{}': {} (FORMAT.md 13.1)", channel.name, beyond));
  return out;
}

const Channel* find_fractions(const Metadata& meta) {
  const auto found = std::ranges::find_if(meta.others(), [](const Channel& c) { return c.name == kFractions && c.coding == kShares; });
  return found == meta.others().end() ? nullptr : &*found;
}

void decode_fractions(const Metadata& meta, const ChunkKey& key, const Subdivision& samples, std::span<const uint8_t> frame, MixedCells& out) {
  const LevelShape s(meta, 0);
  decode_mixed_cells(frame, s.rays_u(key.cu), s.rays_v(key.cv), s.length(key.segment), static_cast<uint32_t>(meta.labels.size()),
                     sub_samples(samples), out);
}

}  // namespace teracell::store
