// Links and fractions with any bytes under right checksums: a FormatError, or links and shares that keep their promises.
//
// A small sound file gets both channels, with a frame for each chunk. The input says which of the frames to change, and how: those of chunks,
// of pages and of lists.
#include <fuzzer/FuzzedDataProvider.h>

#include <fmt/format.h>

#include "store/format/cell_frames.hpp"
#include "tests/fuzz/read_file.hpp"
#include "tests/support/forged.hpp"

namespace teracell {
namespace {

using namespace testing;

struct Sound {
  Bytes file;
  Metadata meta;
};

// Made once: several chunks along each axis, in several pages.
const Sound& sound() {
  static const Sound made = [] {
    std::mt19937_64 random(1);
    const Metadata meta = with_tiny_chunks(metadata_of(unit_grid({5, 3, 9}), 2, 3));
    return Sound{stored_cells(meta, random_cells(random, {5, 3, 9}, 3)), meta};
  }();
  return made;
}

constexpr Subdivision kSamples = {4, 4, 64};

Bytes honest_links(const LevelShape& s, const ChunkKey& key) {
  ChunkLinks out{s.rays_u(key.cu), s.rays_v(key.cv), s.length(key.segment), {}};
  for (int axis = 0; axis < 3; ++axis)
    for (uint64_t line = 0; line < out.lines(axis); ++line) out.along[axis].push_back({line, 0, 7, line % 3 == 0 ? 9u : 7u, 6});
  return LinksEncoder().encode(out);
}

MixedCells honest_cells(const LevelShape& s, const ChunkKey& key) {
  MixedCells out;
  out.reset(s.rays_u(key.cu), s.rays_v(key.cv), s.length(key.segment), sub_samples(kSamples));
  const uint32_t two[] = {0, 2}, all[] = {0, 1, 2}, halves[] = {512, 512}, thirds[] = {300, 300, 424};
  for (uint32_t ray = 0; ray < out.nu * out.nv; ++ray) {
    out.add(0, 1, two, halves);
    if (out.length > 1) out.add(1, out.length, all, thirds);
    out.end_ray();
  }
  return out;
}
Bytes honest_fractions(const LevelShape& s, const ChunkKey& key) { return MixedCellsEncoder().encode(honest_cells(s, key)); }
Bytes honest_shares(const LevelShape& s, const ChunkKey& key) { return old_mixed_frame(honest_cells(s, key)); }

class Hand {
 public:
  Hand(const uint8_t* data, size_t size) : in_(data, size) {}

  Bytes forged_file() {
    ForgedChannel links{kLinks, frames_of(honest_links), kDistances};
    const bool old = here();
    ForgedChannel fractions{kFractions, frames_of(old ? honest_shares : honest_fractions), old ? kShares : kStretches,
                            fractions_channel(kSamples).about};
    if (here()) fractions.about = fmt::format(R"({{"samples":[{},{},{}]}})", in_.ConsumeIntegral<int16_t>(), below(300), below(300));
    return forge(sound().file, {.channels = {links, fractions}});
  }

 private:
  bool here() { return in_.remaining_bytes() > 0 && in_.ConsumeIntegral<uint8_t>() % 8 == 0; }
  size_t below(size_t n) { return in_.ConsumeIntegralInRange<size_t>(0, n - 1); }

  std::vector<Bytes> frames_of(Bytes honest(const LevelShape&, const ChunkKey&)) {
    const LevelShape s(sound().meta, 0);
    CellFrames cells(sound().meta);
    std::vector<Bytes> out;
    for (uint64_t page = 0; page < s.pages(); ++page)
      for (uint32_t slot = 0; slot < s.page_size(page); ++slot) {
        const ChunkKey key = s.key_of(page, slot);
        const bool left_out = here();
        if (!left_out) out.push_back(edited(honest(s, key)));
        const auto of_page = cells.put(key, left_out ? kNoFrame : out.size() - 1, out.size());
        if (of_page && !of_page->empty()) out.push_back(edited(*of_page));
      }
    for (const Bytes& list : cells.lists()) out.push_back(edited(list));
    if (here() && !out.empty()) out.erase(out.begin() + static_cast<ptrdiff_t>(below(out.size())));
    return out;
  }

  // Of a chunk with mixed cells, which alone are no zstd frame, its body and its counts.
  Bytes edited(const Bytes& frame) {
    if (!here()) return frame;
    if (fixed_at<uint32_t>(frame.data()) != kSkippableMagic) return encode_text(edited(decode_text(frame, "honest")));
    MixedFrame parts = mixed_frame(frame);
    if (!here()) parts.body = edited(parts.body);
    const std::string counts = here() ? edited(std::string(parts.counts.begin(), parts.counts.end())) : "";
    if (!counts.empty()) parts.counts.assign(counts.begin(), counts.end());
    return forge(parts);
  }

  std::string edited(std::string body) {
    for (size_t left = below(4); left > 0 && !body.empty(); --left) {
      const size_t at = below(body.size());
      switch (below(4)) {
        case 0: body[at] = in_.ConsumeIntegral<char>(); break;
        case 1: body.resize(at); break;
        case 2: body.insert(at, 1, in_.ConsumeIntegral<char>()); break;
        default: {
          Bytes number;
          put_varint(number, in_.ConsumeIntegral<uint64_t>() >> below(64));
          body.replace(at, 1, std::string(number.begin(), number.end()));
        }
      }
    }
    return body;
  }

  FuzzedDataProvider in_;
};

}  // namespace
}  // namespace teracell

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  teracell::testing::read_file(teracell::Hand(data, size).forged_file());
  return 0;
}
