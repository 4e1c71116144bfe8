// The channel of fractions as verify() sees it: every cell that it has something of is mixed.

#include "store/channels/fractions.hpp"
#include "store/format/cell_frames.hpp"
#include "store/format/channel_kinds.hpp"
#include "store/read/reader.hpp"

namespace teracell::inline store {
namespace {

// Cells with the sub-samples of one label alone have another label themselves.
void expect_mixed(const RayBlock& rays, const MixedCells& cells) {
  for (uint32_t ray = 0; ray < rays.rays(); ++ray)
    for (const MixedCells::Run& run : cells.of_ray(ray))
      if (cells.labels(run).size() == 1)
        rays.for_each_run(ray, run.from, run.to, [&](uint32_t, uint32_t, SetId own) {
          if (own == cells.labels(run)[0]) throw FormatError("a cell is listed as mixed that has its own label alone (FORMAT.md 13.1)");
        });
}

void check_fractions(const GridReader& reader, const Channel& channel, const std::function<Bytes(uint64_t)>& frame) {
  const Subdivision samples = subdivision_of(channel);
  MixedCells cells;
  Chunk chunk;
  check_cell_frames(reader.meta(), channel, frame, [&](const ChunkKey& key, const Bytes* bytes) {
    if (!bytes) return;
    decode_fractions(reader.meta(), channel, key, samples, *bytes, cells);
    reader.read(key, chunk);
    expect_mixed(chunk.rays, cells);
  });
}

}  // namespace

const ChannelKind kFractionsKind = {kFractions, kStretches, check_fractions, [](const Channel& channel) { subdivision_of(channel); }};
const ChannelKind kOldFractionsKind = {kFractions, kShares, check_fractions, [](const Channel& channel) { subdivision_of(channel); }};

}  // namespace teracell::store
