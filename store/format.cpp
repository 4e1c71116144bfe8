#include "store/format.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <xxhash.h>
#include <zstd.h>

#include "store/color.hpp"
#include "store/json_text.hpp"
#include "store/zstd_frame.hpp"

namespace teracell {
namespace {

using nlohmann::ordered_json;

constexpr uint32_t kSkippableMagic = 0x184D2A5E;  // zstd tools step over frames that start with it
constexpr char kHeaderMagic[] = "teracell", kFooterMagic[] = "tcellend";
constexpr int kIndexLevel = 6;                    // pages are small: a good ratio costs microseconds
constexpr int kLongTextLevel = 1;                 // the report of 100,000 bodies: a fifth of the time, and smaller too
constexpr uint64_t kLongText = uint64_t{1} << 20;
constexpr uint64_t kMaxText = uint64_t{1} << 26;  // metadata, report, page: a parsed JSON takes some ten times as much

Bytes compress(std::span<const uint8_t> body) {
  if (body.size() > kMaxText)
    throw InputError(fmt::format("{} bytes of metadata, report or index page are more than the {} MiB that a file may hold", body.size(), kMaxText >> 20));
  return ZstdEncoder().encode(body, body.size() < kLongText ? kIndexLevel : kLongTextLevel);
}

Bytes decompress(std::span<const uint8_t> frame, const std::string& what) {
  Bytes body;
  ZstdDecoder().decode(frame, kMaxText, what, body);
  return body;
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

ordered_json to_json(const Axis& a) {
  if (a.is_graded()) return {{"type", "graded"}, {"planes", a.planes()}, {"sample", a.sample()}};
  return {{"type", "uniform"}, {"min", a.origin()}, {"step", a.step()}, {"first", a.first()}, {"cells", a.cells()}, {"sample", a.sample()}};
}

// A whole number in [0, hi]; nlohmann's own conversions would wrap or be undefined.
template <class T>
T whole(const ordered_json& j, const char* key, uint64_t hi) {
  const ordered_json& v = j.at(key);
  if (!v.is_number_unsigned() || v.get<uint64_t>() > hi)
    throw FormatError(fmt::format("metadata: {} must be a whole number from 0 to {}, found {}", key, hi, v.dump()));
  return static_cast<T>(v.get<uint64_t>());
}

Axis axis_from(const ordered_json& j) {
  if (j.at("type") == "graded") return Axis::graded(j.at("planes").get<std::vector<double>>(), j.at("sample"));
  if (j.at("type") != "uniform") throw FormatError("metadata: an axis is uniform or graded, found " + j.at("type").dump());
  return Axis::uniform(j.at("min"), j.at("step"), whole<int64_t>(j, "first", uint64_t{1} << 52),
                       whole<int64_t>(j, "cells", Axis::kMaxCells), j.at("sample"));
}

}  // namespace

std::string compressor_version() { return ZSTD_versionString(); }

uint64_t checksum(std::span<const uint8_t> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

// ---- metadata ---------------------------------------------------------------------------------------------------

LevelShape::LevelShape(const Metadata& meta, int level)
    : chunk_rays(meta.chunk_rays), chunk_cells(meta.chunk_cells), page_chunks(meta.page_chunks) {
  const Index3 n = meta.grid.cells(level);
  const Frame f = meta.frame();
  nu = static_cast<uint32_t>(n[f.u]);
  nv = static_cast<uint32_t>(n[f.v]);
  nw = static_cast<uint32_t>(n[f.w]);
  const auto parts = [](uint32_t whole, uint32_t part) { return static_cast<uint32_t>((uint64_t{whole} + part - 1) / part); };
  chunks_u = parts(nu, chunk_rays);
  chunks_v = parts(nv, chunk_rays);
  segments = parts(nw, chunk_cells);
  pages_u = parts(chunks_u, page_chunks);
  pages_v = parts(chunks_v, page_chunks);
}

uint32_t LevelShape::page_width(uint64_t page) const {
  return std::min(page_chunks, chunks_u - static_cast<uint32_t>(page % pages_u) * page_chunks);
}

uint32_t LevelShape::page_height(uint64_t page) const {
  return std::min(page_chunks, chunks_v - static_cast<uint32_t>(page / pages_u % pages_v) * page_chunks);
}

Bytes encode_metadata(const Metadata& meta) {
  ordered_json j;
  j["units"] = meta.units;
  j["ray_axis"] = axis_name(meta.ray_axis);
  for (const Axis& axis : meta.grid.axis) j["axes"].push_back(to_json(axis));
  for (const MaterialInfo& m : meta.materials) j["materials"].push_back({{"name", m.name}, {"color", m.color}, {"rank", m.rank}});
  for (const LabelInfo& l : meta.labels) {
    ordered_json label = {{"material", l.material}};
    if (!l.body.empty()) label["body"] = l.body;
    j["labels"].push_back(label);
  }
  j["chunk"] = {{"rays", meta.chunk_rays}, {"cells", meta.chunk_cells}, {"page", meta.page_chunks}};
  j["crossings"] = meta.crossings;
  ordered_json levels = ordered_json::array();
  for (const LevelInfo& l : meta.levels)
    levels.push_back({{"level", l.level}, {"directory", l.directory}, {"chunks", l.chunks}, {"bytes", l.bytes}, {"changes", l.changes}});
  j["channels"] = {{{"name", "labels"}, {"required", true}, {"coding", "runs"}, {"levels", levels}}};
  for (const OtherChannel& c : meta.others)
    j["channels"].push_back({{"name", c.name}, {"required", false}, {"cover", {{"offset", c.cover}, {"frames", c.frames}}}});
  return encode_text(j.dump());
}

namespace {

Metadata metadata_from(const ordered_json& j) {
  Metadata meta;
  try {
    meta.units = j.at("units");
    const std::string axis = j.at("ray_axis");
    if (axis != "x" && axis != "y" && axis != "z") throw FormatError("metadata: ray_axis is x, y or z, found " + axis);
    meta.ray_axis = axis[0] - 'x';
    if (j.at("axes").size() != 3) throw FormatError(fmt::format("metadata: expected 3 axes, found {}", j.at("axes").size()));
    for (int d = 0; d < 3; ++d) meta.grid.axis[d] = axis_from(j.at("axes").at(d));
    for (const auto& m : j.at("materials")) meta.materials.push_back({m.at("name"), m.at("color"), whole<uint32_t>(m, "rank", 65535)});
    for (const auto& l : j.at("labels")) meta.labels.push_back({whole<uint32_t>(l, "material", 65535), l.value("body", "")});
    meta.chunk_rays = whole<uint32_t>(j.at("chunk"), "rays", 256);
    meta.chunk_cells = whole<uint32_t>(j.at("chunk"), "cells", uint64_t{1} << 31);
    meta.page_chunks = whole<uint32_t>(j.at("chunk"), "page", 64);
    meta.crossings = whole<uint64_t>(j, "crossings", ~uint64_t{0});
    bool found = false;
    for (const auto& channel : j.at("channels")) {
      const std::string name = channel.at("name");
      if (name != "labels" && !channel.at("required").get<bool>()) {
        const auto& cover = channel.at("cover");
        meta.others.push_back({name, whole<uint64_t>(cover, "offset", ~uint64_t{0}), whole<uint64_t>(cover, "frames", ~uint64_t{0})});
        continue;
      }
      if (name != "labels" || channel.at("coding") != "runs" || found)
        throw FormatError(fmt::format("metadata: the file requires channel '{}' in coding {}, which this reader does not know", name,
                                      channel.at("coding").dump()));
      found = true;
      for (const auto& l : channel.at("levels"))
        meta.levels.push_back({whole<int>(l, "level", 31), whole<uint64_t>(l, "directory", ~uint64_t{0}), whole<uint64_t>(l, "chunks", ~uint64_t{0}),
                               whole<uint64_t>(l, "bytes", ~uint64_t{0}), whole<uint64_t>(l, "changes", ~uint64_t{0})});
    }
    if (!found) throw FormatError("metadata: no channel 'labels'");
  } catch (const nlohmann::json::exception& e) {
    throw FormatError(fmt::format("metadata: {}", e.what()));
  } catch (const UsageError& e) {  // an axis
    throw FormatError(fmt::format("metadata: {}", e.what()));
  }
  return meta;
}

void check(const Metadata& meta) {
  const auto expect = [](bool ok, const char* message) {
    if (!ok) throw FormatError(std::string("metadata: ") + message);
  };
  expect(meta.chunk_rays >= 4 && meta.chunk_rays <= 256 && meta.chunk_rays % 4 == 0, "chunk rays must be a multiple of 4 up to 256");
  expect(meta.chunk_cells >= 4 && meta.chunk_cells % 4 == 0, "chunk cells must be a multiple of 4");
  expect(meta.page_chunks >= 1 && meta.page_chunks <= 64, "a page has 1 to 64 chunks a side");
  expect(!meta.materials.empty() && meta.materials.size() <= 65536, "there are 1 to 65536 materials");
  expect(!meta.labels.empty(), "there is at least one label");
  std::vector<bool> taken(65536);  // by rank
  for (const MaterialInfo& m : meta.materials) {
    expect(parse_color(m.color).has_value(), "a colour is #rrggbb or #rrggbbaa");
    expect(!taken[m.rank], "no two materials may have the same rank");
    expect(m.rank <= meta.materials[0].rank, "no rank may be above the background's");
    taken[m.rank] = true;
  }
  for (const LabelInfo& l : meta.labels) expect(l.material < meta.materials.size(), "a label names a material that is not there");
  for (const OtherChannel& c : meta.others) expect(c.frames > 0, "the cover of a channel has at least one frame");
  expect(!meta.levels.empty() && meta.levels[0].level == 0, "level 0 must be stored");
  for (size_t i = 1; i < meta.levels.size(); ++i)
    expect(meta.levels[i].level > meta.levels[i - 1].level && meta.levels[i].level < meta.grid.levels(), "stored levels must ascend");
  for (size_t i = 0; i < meta.levels.size(); ++i) {
    const int next = i + 1 < meta.levels.size() ? meta.levels[i + 1].level : meta.grid.levels();
    expect(next - meta.levels[i].level <= 2, "of two successive levels at least one must be stored");
  }
}

}  // namespace

Metadata decode_metadata(std::span<const uint8_t> frame) {
  const Metadata meta = metadata_from(parse_json(decode_text(frame, "metadata"), "metadata"));
  check(meta);
  return meta;
}

Bytes encode_text(const std::string& text) {
  return compress({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

std::string decode_text(std::span<const uint8_t> frame, const std::string& what) {
  const Bytes body = decompress(frame, what);
  return {body.begin(), body.end()};
}

// ---- index ------------------------------------------------------------------------------------------------------

Bytes encode_page(const std::vector<ChunkEntry>& entries, bool with_stats) {
  Bytes out;
  uint64_t base = ~uint64_t{0};
  for (const ChunkEntry& e : entries)
    if (e.size != 0) base = std::min(base, e.offset);
  if (base == ~uint64_t{0}) base = 0;
  put_fixed(out, base);
  for (const ChunkEntry& e : entries) put_varint(out, e.size);
  for (const ChunkEntry& e : entries)
    if (e.size != 0) put_varint(out, e.offset - base);
  for (const ChunkEntry& e : entries)
    if (e.size != 0) put_fixed(out, e.checksum);
  for (const ChunkEntry& e : entries)
    if (e.size == 0) put_set(out, e.uniform);
  if (with_stats) {
    for (const ChunkEntry& e : entries) {
      if (e.size == 0) continue;
      put_varint(out, e.stats.size());
      for (const LabelStats& s : e.stats) {
        put_varint(out, s.label);
        put_varint(out, s.cells);
        for (int d = 0; d < 3; ++d) put_varint(out, s.lo[d]), put_varint(out, s.hi[d] - s.lo[d]);
      }
    }
  }
  return compress(out);
}

std::vector<ChunkEntry> decode_page(std::span<const uint8_t> frame, size_t chunks, bool with_stats, uint32_t labels) {
  const Bytes body = decompress(frame, "index page");
  ByteReader in(body, "index page");
  std::vector<ChunkEntry> entries(chunks);
  const auto base = in.fixed<uint64_t>();
  for (ChunkEntry& e : entries) e.size = static_cast<uint32_t>(in.varint(0, ~0u, "chunk size"));
  for (ChunkEntry& e : entries)
    if (e.size != 0) e.offset = base + in.varint(0, (uint64_t{1} << 62), "chunk offset");
  for (ChunkEntry& e : entries)
    if (e.size != 0) e.checksum = in.fixed<uint64_t>();
  for (ChunkEntry& e : entries)
    if (e.size == 0) e.uniform = take_set(in, labels, with_stats ? 1 : labels);  // level 0, with statistics, has one label a cell
  if (with_stats) {
    for (ChunkEntry& e : entries) {
      if (e.size == 0) continue;
      e.stats.resize(in.varint(1, std::min<uint64_t>(labels, in.remaining()), "labels of a chunk"));
      for (LabelStats& s : e.stats) {
        s.label = static_cast<Label>(in.varint(0, labels - 1, "label"));
        s.cells = in.varint();
        for (int d = 0; d < 3; ++d) {
          s.lo[d] = static_cast<uint32_t>(in.varint(0, Axis::kMaxCells, "box"));
          s.hi[d] = s.lo[d] + static_cast<uint32_t>(in.varint(0, Axis::kMaxCells, "box"));
        }
      }
    }
  }
  in.expect_end();
  return entries;
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
  ByteReader in(block, "directory block");
  if (block.size() < 8 || (block.size() - 8) % kDirectoryEntry != 0) in.fail(fmt::format("expected whole entries and a checksum, found {} bytes", block.size()));
  std::vector<DirectoryEntry> entries((block.size() - 8) / kDirectoryEntry);
  for (DirectoryEntry& e : entries) e = {in.fixed<uint64_t>(), in.fixed<uint64_t>(), in.fixed<uint64_t>()};
  const auto expected = in.fixed<uint64_t>(), found = checksum(block.first(block.size() - 8));
  if (found != expected) throw FormatError(fmt::format("directory block: expected checksum {:016x}, found {:016x}: the file is damaged", expected, found));
  return entries;
}

void check_directory_frame(std::span<const uint8_t> eight_bytes, uint64_t entries) {
  ByteReader in(eight_bytes, "directory");
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

uint16_t check_header(std::span<const uint8_t> bytes) {
  ByteReader in(bytes, "header");
  if (bytes.size() < kHeaderBytes || !std::equal(kHeaderMagic, kHeaderMagic + 8, bytes.begin() + 8))
    throw FormatError("not a teracell file: it does not start with a teracell header");
  check_skippable(in, kHeaderBytes - 8);
  in.take(8);
  const auto major = in.fixed<uint16_t>(), minor = in.fixed<uint16_t>();
  const auto reserved = in.fixed<uint32_t>();
  const auto expected = in.fixed<uint64_t>(), found = checksum(bytes.first(kHeaderBytes - 8));
  if (found != expected) throw FormatError(fmt::format("header: expected checksum {:016x}, found {:016x}: the file is damaged", expected, found));
  if (major != kFormatMajor)
    throw FormatError(fmt::format("the file has format version {}.{}, this program reads {}.x: use a{} teracell", major, minor, kFormatMajor,
                                  major > kFormatMajor ? " newer" : "n older"));
  if (reserved != 0) throw FormatError("header: reserved bits are set");
  return minor;
}

Bytes encode_footer(const Footer& footer) {
  Bytes out;
  put_skippable(out, kFooterBytes - 8);
  put_fixed(out, footer.file_bytes);
  for (const DirectoryEntry* e : {&footer.metadata, &footer.report})
    put_fixed(out, e->offset), put_fixed(out, e->size), put_fixed(out, e->checksum);
  out.insert(out.end(), footer.hash.begin(), footer.hash.end());
  out.resize(kFooterBytes - 16, 0);
  put_fixed(out, checksum(out));
  put_text(out, kFooterMagic);
  return out;
}

Footer decode_footer(std::span<const uint8_t> bytes) {
  if (bytes.size() != kFooterBytes || !std::equal(kFooterMagic, kFooterMagic + 8, bytes.end() - 8))
    throw FormatError("the file does not end with a teracell footer: it is cut short or not a teracell file");
  const auto expected = ByteReader(bytes.subspan(kFooterBytes - 16, 8), "footer").fixed<uint64_t>(), found = checksum(bytes.first(kFooterBytes - 16));
  if (found != expected) throw FormatError(fmt::format("footer: expected checksum {:016x}, found {:016x}: the file is damaged", expected, found));
  ByteReader in(bytes, "footer");
  check_skippable(in, kFooterBytes - 8);
  Footer footer;
  footer.file_bytes = in.fixed<uint64_t>();
  for (DirectoryEntry* e : {&footer.metadata, &footer.report})
    *e = {in.fixed<uint64_t>(), in.fixed<uint64_t>(), in.fixed<uint64_t>()};
  std::ranges::copy(in.take(16), footer.hash.begin());
  for (const uint8_t b : in.take(in.remaining() - 16))
    if (b != 0) in.fail("reserved bytes are set");
  return footer;
}

struct RunningChecksum::State {
  XXH3_state_t* xxh = XXH3_createState();
  ~State() { XXH3_freeState(xxh); }
};

RunningChecksum::RunningChecksum() : state_(std::make_unique<State>()) { XXH3_64bits_reset(state_->xxh); }
RunningChecksum::~RunningChecksum() = default;

void RunningChecksum::add(std::span<const uint8_t> bytes) { XXH3_64bits_update(state_->xxh, bytes.data(), bytes.size()); }

uint64_t RunningChecksum::value() const { return XXH3_64bits_digest(state_->xxh); }

struct ContentHash::State {
  XXH3_state_t* xxh = XXH3_createState();
  ~State() { XXH3_freeState(xxh); }
};

ContentHash::ContentHash() : state_(std::make_unique<State>()) { XXH3_128bits_reset(state_->xxh); }
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

}  // namespace teracell
