#include "store/format/format.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <xxhash.h>
#include <zstd.h>

#include "store/base/zstd_frame.hpp"
#include "store/grid/grid.hpp"

namespace teracell::inline store {
namespace {

constexpr char kHeaderMagic[] = "teracell", kFooterMagic[] = "tcellend";
constexpr std::string_view kPartMagic = "tcellpt";  // of any layout (part.cpp)
constexpr int kTextLevel = 6;
constexpr int kPageLevel = 3;                     // level 6 makes pages 1 % smaller; it takes thrice as long, on the one thread that puts them
constexpr int kLongTextLevel = 1;                 // a report of 100,000 bodies takes a fifth of the time and is smaller, too
constexpr uint64_t kLeastStats = 8;               // bytes of a summary
constexpr uint64_t kLongText = uint64_t{1} << 20;
constexpr BodyBound kTextBound = {kMostText, kMostTextOfAnyFrame}, kPageBound = {kMostText, kMostPageOfAnyFrame};

Bytes compress(ZstdEncoder& zstd, std::span<const uint8_t> body, int level, const BodyBound& bound) {
  if (body.size() > bound.most)
    throw InputError(
        fmt::format("{} bytes of metadata, report or index page are more than the {} MiB that a file may hold", body.size(), bound.most >> 20));
  return zstd.encode(body, level, bound);
}

void put_skippable(Bytes& out, uint64_t payload) {
  put_fixed<uint32_t>(out, kSkippableMagic);
  put_fixed<uint32_t>(out, static_cast<uint32_t>(payload));
}

void check_skippable(ByteReader& in, uint64_t payload) {
  const auto magic = in.fixed<uint32_t>(), size = in.fixed<uint32_t>();
  if (magic != kSkippableMagic || size != payload)
    in.fail(fmt::format("expected a skippable frame ({:08x}) of {} bytes, found {:08x} of {}", kSkippableMagic, payload, magic, size));
}

void put_text(Bytes& out, const char* text) { out.insert(out.end(), text, text + 8); }

}  // namespace

std::string compressor_version() { return ZSTD_versionString(); }

uint64_t checksum(std::span<const uint8_t> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

Bytes encode_text(const std::string& text) {
  ZstdEncoder zstd;
  return compress(zstd, {reinterpret_cast<const uint8_t*>(text.data()), text.size()}, text.size() < kLongText ? kTextLevel : kLongTextLevel,
                  kTextBound);
}

void append_decoded(std::span<const uint8_t> frame, const std::string& what, std::string& text) {
  ZstdDecoder().append(frame, kTextBound, what, text);
}

std::string decode_text(std::span<const uint8_t> frame, const std::string& what) {
  std::string text;
  append_decoded(frame, what, text);
  return text;
}

// ---- index ------------------------------------------------------------------------------------------------------

namespace {

void put_stats(Bytes& out, const std::vector<LabelStats>& stats) {
  put_varint(out, stats.size());
  for (const LabelStats& s : stats) {
    put_varint(out, s.label);
    put_varint(out, s.cells);
    for (int d = 0; d < 3; ++d) put_varint(out, s.lo[d]), put_varint(out, s.hi[d] - s.lo[d]);
  }
}

std::vector<LabelStats> take_stats(ByteReader& in, uint32_t labels) {
  std::vector<LabelStats> stats(in.varint(1, std::min<uint64_t>(labels, in.remaining() / kLeastStats), "labels of a chunk"));
  for (LabelStats& s : stats) {
    s.label = static_cast<Label>(in.varint(0, labels - 1, "label"));
    s.cells = in.varint();
    for (int d = 0; d < 3; ++d) {
      s.lo[d] = static_cast<uint32_t>(in.varint(0, Axis::kMaxCells, "box"));
      s.hi[d] = s.lo[d] + static_cast<uint32_t>(in.varint(0, Axis::kMaxCells, "box"));
    }
  }
  return stats;
}

}  // namespace

Bytes encode_page(const std::vector<ChunkEntry>& entries, bool with_stats, uint64_t place) {
  Bytes out;
  uint64_t first = ~uint64_t{0};
  for (const ChunkEntry& e : entries)
    if (e.size != 0) first = std::min(first, e.offset);
  put_fixed(out, first == ~uint64_t{0} ? 0 : place - first);
  for (const ChunkEntry& e : entries) put_varint(out, e.size);
  for (const ChunkEntry& e : entries)
    if (e.size != 0) put_varint(out, e.offset - first);
  for (const ChunkEntry& e : entries)
    if (e.size != 0) put_fixed(out, e.checksum);
  for (const ChunkEntry& e : entries)
    if (e.size == 0) put_set(out, e.uniform);
  if (with_stats)
    for (const ChunkEntry& e : entries)
      if (e.size != 0) put_stats(out, e.stats);
  thread_local ZstdEncoder zstd;  // making one takes as long as encoding a small page
  return compress(zstd, out, kPageLevel, kPageBound);
}

std::vector<ChunkEntry> decode_page(std::span<const uint8_t> frame, size_t chunks, bool with_stats, uint32_t labels, uint64_t place) {
  Bytes body;
  thread_local ZstdDecoder decoder;  // making one takes longer than decoding a small page
  decoder.decode(frame, kPageBound, "index page", body);
  ByteReader in(body, "index page", "10.1");
  std::vector<ChunkEntry> entries(chunks);
  const uint64_t first = place - in.fixed<uint64_t>();
  for (ChunkEntry& e : entries) e.size = static_cast<uint32_t>(in.varint(0, ~0u, "chunk size"));
  for (ChunkEntry& e : entries)
    if (e.size != 0) e.offset = first + in.varint(0, (uint64_t{1} << 62), "chunk offset");
  for (ChunkEntry& e : entries)
    if (e.size != 0) e.checksum = in.fixed<uint64_t>();
  for (ChunkEntry& e : entries)
    if (e.size == 0) e.uniform = take_set(in, labels, with_stats ? 1 : labels);  // a cell of level 0, the level with statistics, has one label
  if (with_stats)
    for (ChunkEntry& e : entries)
      if (e.size != 0) e.stats = take_stats(in, labels);
  in.expect_end();
  return entries;
}

void put_entry(Bytes& out, const ChunkEntry& entry, bool with_stats) {
  put_varint(out, entry.size);
  if (entry.size == 0) return put_set(out, entry.uniform);
  put_fixed(out, entry.checksum);
  if (with_stats) put_stats(out, entry.stats);
}

ChunkEntry take_entry(ByteReader& in, bool with_stats, uint32_t labels) {
  ChunkEntry entry;
  entry.size = static_cast<uint32_t>(in.varint(0, ~0u, "chunk size"));
  if (entry.size == 0) {
    entry.uniform = take_set(in, labels, with_stats ? 1 : labels);
    return entry;
  }
  entry.checksum = in.fixed<uint64_t>();
  if (with_stats) entry.stats = take_stats(in, labels);
  return entry;
}

Bytes encode_directory(const std::vector<DirectoryEntry>& entries) {
  Bytes out;
  put_skippable(out, directory_bytes(entries.size()) - 8);
  for (size_t i = 0; i < entries.size(); i += kBlockEntries) {
    const size_t start = out.size();
    for (size_t e = i; e < std::min<size_t>(i + kBlockEntries, entries.size()); ++e)
      put_fixed(out, entries[e].offset), put_fixed(out, entries[e].size), put_fixed(out, entries[e].checksum);
    put_fixed(out, checksum({out.data() + start, out.size() - start}));
  }
  return out;
}

BlockPlace directory_block(uint64_t block, uint64_t entries) {
  return {8 + block * kBlockBytes, std::min(kBlockEntries, entries - block * kBlockEntries)};
}

uint64_t directory_bytes(uint64_t entries) {
  const uint64_t last = (entries - 1) / kBlockEntries;
  const BlockPlace place = directory_block(last, entries);
  return place.offset + place.bytes();
}

std::vector<DirectoryEntry> decode_directory_block(std::span<const uint8_t> block) {
  ByteReader in(block, "directory block", "9.1");
  if (block.size() < 8 || (block.size() - 8) % kDirectoryEntry != 0)
    in.fail(fmt::format("expected whole entries and a checksum, found {} bytes", block.size()));
  std::vector<DirectoryEntry> entries((block.size() - 8) / kDirectoryEntry);
  for (DirectoryEntry& e : entries) e = {in.fixed<uint64_t>(), in.fixed<uint64_t>(), in.fixed<uint64_t>()};
  const auto expected = in.fixed<uint64_t>(), found = checksum(block.first(block.size() - 8));
  if (found != expected)
    throw FormatError(fmt::format("directory block: expected checksum {:016x}, found {:016x}: the file is damaged (FORMAT.md 9.1)", expected, found));
  return entries;
}

void check_directory_frame(std::span<const uint8_t> eight_bytes, uint64_t entries) {
  ByteReader in(eight_bytes, "directory", "9.1");
  check_skippable(in, directory_bytes(entries) - 8);
}

// ---- header and footer ------------------------------------------------------------------------------------------

Bytes encode_header() {
  Bytes out;
  put_skippable(out, kHeaderBytes - 8);
  put_text(out, kHeaderMagic);
  put_fixed(out, kFormatMajor);
  put_fixed(out, kFormatMinor);
  put_fixed<uint32_t>(out, 0);
  put_fixed(out, checksum(out));
  return out;
}

std::pair<uint16_t, uint16_t> check_header(std::span<const uint8_t> bytes) {
  ByteReader in(bytes, "header", "5.1");
  if (bytes.size() < kHeaderBytes || !std::equal(kHeaderMagic, kHeaderMagic + 8, bytes.begin() + 8))
    throw FormatError(bytes.size() >= kPartMagic.size() && std::equal(kPartMagic.begin(), kPartMagic.end(), bytes.begin())
                          ? "expected a grid, found a part of one: merged with the other parts it becomes a grid (FORMAT.md 16.1)"
                          : "not a teracell file: it does not start with a teracell header (FORMAT.md 5.1)");
  check_skippable(in, kHeaderBytes - 8);
  in.take(8);
  const auto major = in.fixed<uint16_t>(), minor = in.fixed<uint16_t>();
  const auto reserved = in.fixed<uint32_t>();
  const auto expected = in.fixed<uint64_t>(), found = checksum(bytes.first(kHeaderBytes - 8));
  if (found != expected)
    throw FormatError(fmt::format("header: expected checksum {:016x}, found {:016x}: the file is damaged (FORMAT.md 5.1)", expected, found));
  if (major < kOldestMajor || major > kFormatMajor)
    throw FormatError(fmt::format("the file has format version {}.{}, this program reads {}.x to {}.x: {} (FORMAT.md 5.2)", major, minor,
                                  kOldestMajor, kFormatMajor,
                                  major > kFormatMajor ? "use a newer teracell" : "mesh the surfaces again, or use an older teracell"));
  if (reserved != 0) throw FormatError("header: reserved bits are set (FORMAT.md 5.1)");
  return {major, minor};
}

Bytes encode_footer(const Footer& footer) {
  Bytes out;
  put_skippable(out, kFooterBytes - 8);
  put_fixed(out, footer.file_bytes);
  for (const DirectoryEntry* e : {&footer.metadata, &footer.report}) put_fixed(out, e->offset), put_fixed(out, e->size), put_fixed(out, e->checksum);
  out.insert(out.end(), footer.hash.begin(), footer.hash.end());
  out.resize(kFooterBytes - 16, 0);
  put_fixed(out, checksum(out));
  put_text(out, kFooterMagic);
  return out;
}

Footer decode_footer(std::span<const uint8_t> bytes) {
  if (bytes.size() != kFooterBytes || !std::equal(kFooterMagic, kFooterMagic + 8, bytes.end() - 8))
    throw FormatError("the file does not end with a teracell footer: it is cut short or not a teracell file (FORMAT.md 6.1)");
  const auto expected = ByteReader(bytes.subspan(kFooterBytes - 16, 8), "footer").fixed<uint64_t>(), found = checksum(bytes.first(kFooterBytes - 16));
  if (found != expected)
    throw FormatError(fmt::format("footer: expected checksum {:016x}, found {:016x}: the file is damaged (FORMAT.md 6.1)", expected, found));
  ByteReader in(bytes, "footer", "6.1");
  check_skippable(in, kFooterBytes - 8);
  Footer footer;
  footer.file_bytes = in.fixed<uint64_t>();
  for (DirectoryEntry* e : {&footer.metadata, &footer.report}) *e = {in.fixed<uint64_t>(), in.fixed<uint64_t>(), in.fixed<uint64_t>()};
  std::ranges::copy(in.take(16), footer.hash.begin());
  for (const uint8_t b : in.take(in.remaining() - 16))
    if (b != 0) in.fail("reserved bytes are set");
  return footer;
}

struct HashState {
  XXH3_state_t* xxh = XXH3_createState();
  ~HashState() { XXH3_freeState(xxh); }
};

RunningChecksum::RunningChecksum() : state_(std::make_unique<HashState>()) { XXH3_64bits_reset(state_->xxh); }
RunningChecksum::~RunningChecksum() = default;

void RunningChecksum::add(std::span<const uint8_t> bytes) { XXH3_64bits_update(state_->xxh, bytes.data(), bytes.size()); }

uint64_t RunningChecksum::value() const { return XXH3_64bits_digest(state_->xxh); }

ContentHash::ContentHash() : state_(std::make_unique<HashState>()) { XXH3_128bits_reset(state_->xxh); }
ContentHash::~ContentHash() = default;

void ContentHash::add(std::span<const uint8_t> bytes) { XXH3_128bits_update(state_->xxh, bytes.data(), bytes.size()); }

std::array<uint8_t, 16> ContentHash::digest() const {
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(state_->xxh));
  return std::to_array(canonical.digest);
}

std::string hex(const std::array<uint8_t, 16>& hash) {
  std::string text;
  for (const uint8_t b : hash) text += fmt::format("{:02x}", b);
  return text;
}

}  // namespace teracell::store
