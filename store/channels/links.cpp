#include "store/channels/links.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "store/base/zstd_frame.hpp"
#include "store/runs/chunk_codec.hpp"

namespace teracell::inline store {
namespace {

constexpr int kLinksZstdLevel = 1, kFractionBits = 16;
constexpr BodyBound kLinksBound{kMaxChunkBytes / 4, kChunkBytesOfAnyFrame};  // a link in memory has more bytes than in a body

uint64_t zigzag(int64_t v) { return (static_cast<uint64_t>(v) << 1) ^ static_cast<uint64_t>(v >> 63); }
int64_t unzigzag(uint64_t v) { return static_cast<int64_t>(v >> 1) ^ -static_cast<int64_t>(v & 1); }

// Foretells the links of a line from those of the lines before it. Along neighbouring lines a flat surface climbs evenly, so the height of
// the n-th link, its cell and where the label ends, follows from those of the two n-th links before it.
class Forecast {
 public:
  explicit Forecast(uint32_t row) : row_(row) {}
  // REQUIRES: lines never fall, and after set() with the links of a line come its next ones.
  void at(uint64_t line) { number_ = line == line_ ? number_ + 1 : 0, line_ = line; }
  int64_t height() const {
    if (number_ == known_.size()) return number_ > 0 ? known_[number_ - 1].height : 0;
    const Known& k = known_[number_];
    return follows(k) ? k.height + k.slope : k.height;
  }
  uint32_t patch() const { return number_ < known_.size() ? known_[number_].patch : number_ > 0 ? known_[number_ - 1].patch : kNoPatch; }
  void set(int64_t height, uint32_t patch) {
    if (number_ == known_.size()) known_.push_back({});
    Known& k = known_[number_];
    const bool follows_it = follows(k);
    const int64_t slope = height - k.height;
    k = {line_, height, follows_it && std::abs(slope) <= kSteepest ? slope : 0, patch};
  }

 private:
  static constexpr int64_t kSteepest = int64_t{64} << kFractionBits;
  struct Known {
    uint64_t line = ~uint64_t{1};
    int64_t height = 0, slope = 0;
    uint32_t patch = kNoPatch;
  };
  bool follows(const Known& k) const { return k.line + 1 == line_ && line_ % row_ != 0; }
  const uint32_t row_;
  uint64_t line_ = ~uint64_t{0};
  size_t number_ = 0;
  std::vector<Known> known_;  // the latest link of each number
};

int64_t height_of(const Link& link) { return (int64_t{link.cell} << kFractionBits) + std::max(link.end, 1u) - 1; }

}  // namespace

// ---- encoding

struct LinksEncoder::Scratch {
  ZstdEncoder zstd;
  Bytes body, lines, heights, gaps, patches;
};

LinksEncoder::LinksEncoder() : s_(std::make_unique<Scratch>()) {}
LinksEncoder::~LinksEncoder() = default;

Bytes LinksEncoder::encode(const ChunkLinks& links) {
  Scratch& s = *s_;
  s.body.clear();
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<Link>& all = links.along[axis];
    for (Bytes* part : {&s.lines, &s.heights, &s.gaps, &s.patches}) part->clear();
    put_varint(s.body, all.size());
    // Groups of lines with equally many links.
    uint64_t next = 0, first = 0, each = 0;  // the line behind the group, its first line, and the links of each line
    uint64_t end = 0;                        // of the group before it
    const auto put_group = [&] {
      if (each == 0) return;
      put_varint(s.lines, first - end), put_varint(s.lines, next - first), put_varint(s.lines, each);
      end = next;
    };
    for (size_t i = 0; i < all.size();) {
      const uint64_t line = all[i].line;
      size_t to = i;
      while (to < all.size() && all[to].line == line) ++to;
      if (line != next || to - i != each) put_group(), first = line, each = to - i;
      next = line + 1;
      i = to;
    }
    put_group();
    Forecast forecast(links.row(axis));
    size_t gap = 0, patch = 0;  // what follows the latest exception
    for (size_t i = 0; i < all.size(); ++i) {
      const Link& link = all[i];
      const int64_t height = height_of(link);
      forecast.at(link.line);
      put_varint(s.heights, zigzag(height - forecast.height()));
      if (link.end != link.begin || link.end == 0) put_varint(s.gaps, i - gap), put_varint(s.gaps, link.begin - link.end), gap = i + 1;
      if (link.patch != forecast.patch()) put_varint(s.patches, i - patch), put_varint(s.patches, link.patch + 1), patch = i + 1;
      forecast.set(height, link.patch);
    }
    for (const Bytes* part : {&s.lines, &s.heights, &s.gaps, &s.patches}) {
      if (part != &s.heights) put_varint(s.body, part->size());
      s.body.insert(s.body.end(), part->begin(), part->end());
    }
  }
  if (s.body.size() > kLinksBound.most)
    throw InputError(
        fmt::format("a chunk of {} x {} rays of {} cells has {} links, more than fit in {} MiB: rays along another axis may have fewer in each",
                    links.nu, links.nv, links.length, links.along[0].size() + links.along[1].size() + links.along[2].size(), kLinksBound.most >> 20));
  return s.zstd.encode(s.body, kLinksZstdLevel, kLinksBound);
}

// ---- decoding

namespace {

// `cells`: of which a line may have links; `patches`: how many there are.
void decode_along(int axis, uint32_t cells, size_t patches, ByteReader& in, ChunkLinks& out) {
  std::vector<Link>& all = out.along[axis];
  const uint64_t number = in.varint(0, in.remaining(), "links");
  all.clear();
  all.reserve(number);
  if (number > 0 && cells == 0) in.fail("cells at the end of the grid have links");
  const auto part = [&](const char* name) { return ByteReader(in.take(in.varint(0, in.remaining(), name)), "links", "14.4"); };
  ByteReader lines = part("bytes of lines");
  for (uint64_t next = 0; all.size() < number;) {
    const uint64_t first = next + lines.varint(0, out.lines(axis) - next, "lines without links");
    const uint64_t count = lines.varint(1, out.lines(axis) - first, "lines of a group"), left = number - all.size();
    const uint64_t each = lines.varint(1, left / count, "links of a line");
    next = first + count;
    for (uint64_t line = first; line < next; ++line) all.insert(all.end(), each, Link{line, 0, 0, 0, kNoPatch});
  }
  lines.expect_end();
  for (Link& link : all) {  // what its height differs from the forecast
    const uint64_t difference = in.varint();
    link.end = static_cast<uint32_t>(difference), link.begin = static_cast<uint32_t>(difference >> 32);
  }
  ByteReader gaps = part("bytes of gaps"), changes = part("bytes of patches");
  // The number of the next exception; `number` if there is none.
  const auto next_of = [&](ByteReader& exceptions, uint64_t from) {
    return exceptions.remaining() == 0 ? number : from + exceptions.varint(0, number - 1 - from, "links without an exception");
  };
  in.clause("14.5");
  Forecast forecast(out.row(axis));
  uint64_t gap = number == 0 ? 0 : next_of(gaps, 0), patch = number == 0 ? 0 : next_of(changes, 0);
  const int64_t most = (int64_t{cells} << kFractionBits) - 1;
  for (uint64_t i = 0; i < number; ++i) {
    Link& link = all[i];
    forecast.at(link.line);
    const uint64_t height = static_cast<uint64_t>(forecast.height()) + static_cast<uint64_t>(unzigzag(uint64_t{link.begin} << 32 | link.end));
    if (height > static_cast<uint64_t>(most)) in.fail("a link lies beyond its line");
    link.cell = static_cast<uint32_t>(height >> kFractionBits);
    if (i > 0 && all[i - 1].line == link.line && all[i - 1].cell >= link.cell) in.fail("the links of a line don't ascend");
    link.end = link.begin = static_cast<uint32_t>(height & 0xFFFF) + 1;
    link.patch = forecast.patch();
    if (i == gap) {
      const auto size = static_cast<uint32_t>(gaps.varint(0, 65536 - link.end, "gap of a link"));
      if (size == 0) link.end = link.begin = 0;
      else link.begin += size;
      gap = i + 1 < number ? next_of(gaps, i + 1) : number;
    }
    if (i == patch) {
      const uint64_t of_link = changes.varint(0, patches, "patch of a link");
      link.patch = of_link == 0 ? kNoPatch : static_cast<uint32_t>(of_link - 1);
      patch = i + 1 < number ? next_of(changes, i + 1) : number;
    }
    forecast.set(static_cast<int64_t>(height), link.patch);
  }
  in.clause("14.4");
  gaps.expect_end(), changes.expect_end();
}

}  // namespace

void decode_links(const Metadata& meta, const ChunkKey& key, std::span<const uint8_t> frame, ChunkLinks& out) {
  const LevelShape s(meta, 0);
  out.nu = s.rays_u(key.cu), out.nv = s.rays_v(key.cv), out.length = s.length(key.segment);
  thread_local ZstdDecoder zstd;
  thread_local Bytes body;
  zstd.decode(frame, kLinksBound, "links", body);
  ByteReader in(body, "links", "14.4");
  // The last cell of the grid has no upper neighbour.
  const bool ends[] = {(key.cu + 1) * uint64_t{s.chunk_rays} >= s.nu, (key.cv + 1) * uint64_t{s.chunk_rays} >= s.nv, key.segment + 1 == s.segments};
  for (int axis = 0; axis < 3; ++axis) decode_along(axis, out.cells(axis) - ends[axis], meta.patches.size(), in, out);
  in.expect_end();
  if (out.empty()) in.fail("there is no link");
}

Channel links_channel() { return {kLinks, kDistances}; }

const Channel* find_links(const Metadata& meta) {
  const auto found = std::ranges::find_if(meta.others(), [](const Channel& c) { return c.name == kLinks && c.coding == kDistances; });
  return found == meta.others().end() ? nullptr : &*found;
}

}  // namespace teracell::store
