#include "store/write/part.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "store/format/metadata_json.hpp"
#include "store/text/json_node.hpp"

namespace teracell::inline store {
namespace {

constexpr std::string_view kMagic = "tcellptB";  // its last character is raised when the layout changes
constexpr uint64_t kPartFooter = 64;
enum Record : uint8_t { kChunk, kPage, kChild, kEnd, kCells, kFrame, kCellsPage };
constexpr uint64_t kMostBeside = uint64_t{1} << 32;  // bytes of the head, of the records and of what was found
constexpr size_t kMostHeadValues = 16;

Bytes encode_head(const PartHead& head) {
  const Json json = {{"run", head.run}, {"part", head.number}, {"parts", head.of}, {"first", head.range.first}, {"end", head.range.end}};
  Bytes out;
  put_sized(out, encode_text(json.dump()));
  Metadata meta = head.meta;
  meta.levels().clear();  // they are known when the grid is complete; until then they are listed with zeros
  for (int level = 0; level < meta.grid.levels(); level = next_stored(level)) meta.levels().push_back({level, 0, 0, 0, 0});
  for (size_t i = 1; i < meta.channels.size(); ++i) meta.channels[i].frames = 1;  // none is not allowed
  put_sized(out, encode_metadata(meta));
  return out;
}

std::string begin_of(const InputFile& file, size_t size) {
  std::string begin(size, ' ');
  file.read(0, {reinterpret_cast<uint8_t*>(begin.data()), begin.size()});
  return begin;
}

PartHead decode_head(std::span<const uint8_t> body, const std::string& name) {
  ByteReader in(body, name);
  const std::string text = decode_text(in.take_sized(), name);
  PartHead head;
  naming("its head", [&] {
    const Json json = parse_json(text, "", kMostHeadValues);
    const JsonNode node(json, "its head");
    const uint64_t number = node.require("part").whole(), of = node.require("parts").whole();
    head.run = node.require("run").any_text();
    head.range = {node.require("first").whole(), node.require("end").whole()};
    if (number >= of || of > ~uint32_t{0} || head.range.first > head.range.end)
      throw FormatError(fmt::format("expected a part of a grid, found part {} of {} from {} to {}", number, of, head.range.first, head.range.end));
    head.number = static_cast<uint32_t>(number), head.of = static_cast<uint32_t>(of);
  });
  head.meta = decode_metadata(in.take_sized());
  in.expect_end();
  return head;
}

// Whether all chunks of an index page lie in the range.
bool has_page(const TreeRange& range, const LevelShape& s, const ChunkKey& chunk) {
  const auto group = [&](uint32_t c) { return static_cast<uint32_t>((uint64_t{c} << s.level) >> 2); };  // the chunk of level 2 above or below
  const auto first = [&](uint32_t c) { return group(c / s.page_chunks * s.page_chunks); };
  const auto last = [&](uint32_t c, uint32_t chunks) {
    return group(std::min(c / s.page_chunks * s.page_chunks + s.page_chunks, chunks) - 1) | ((s.level > 2 ? 1u << (s.level - 2) : 1u) - 1);
  };
  const uint32_t u0 = first(chunk.cu), v0 = first(chunk.cv), u1 = last(chunk.cu, s.chunks_u), v1 = last(chunk.cv, s.chunks_v);
  int height = 0;
  while (u0 >> (kFanOutBits * height) != u1 >> (kFanOutBits * height) || v0 >> (kFanOutBits * height) != v1 >> (kFanOutBits * height)) ++height;
  return range.has_all(height, u0 >> (kFanOutBits * height), v0 >> (kFanOutBits * height));
}

}  // namespace

PartWriter::PartWriter(const std::filesystem::path& path, PartHead head, uint64_t keep)
    : head_(std::move(head)), encoded_head_(encode_head(head_)), bytes_(path, keep) {
  for (int level = 0; level < meta().grid.levels(); level = next_stored(level)) levels_.push_back({OpenPages(meta(), level), {}});
  for (size_t i = 1; i < meta().channels.size(); ++i) cells_.push_back({CellFrames(meta()), 0});
}

PartWriter::PartWriter(const std::filesystem::path& path, PartHead head) : PartWriter(path, std::move(head), 0) {
  Bytes begin(kMagic.begin(), kMagic.end());
  put_fixed(begin, uint64_t{encoded_head_.size()});
  put_fixed(begin, checksum(encoded_head_));
  begin.insert(begin.end(), encoded_head_.begin(), encoded_head_.end());
  bytes_.file().append(begin);
  recorded_ = bytes_.size();
}

PartWriter::PartWriter(const std::filesystem::path& path, PartHead head, ByteReader& state)
    : PartWriter(path, std::move(head), state.fixed<uint64_t>()) {
  bytes_.restore(state, kMagic.size() + 16 + encoded_head_.size());
  chunks_ = state.varint();
  recorded_ = state.varint();
  const auto records = state.take_sized();
  records_.assign(records.begin(), records.end());
  for (Level& l : levels_) {
    l.open.restore(state);
    for (uint64_t left = state.varint(0, l.open.shape().pages(), "open pages"); left > 0; --left) {
      const uint64_t page = state.varint();
      l.contents[page] = {l.open.shape().level, 0, state.varint(), state.varint(), state.varint()};
    }
  }
  for (Cells& c : cells_) {
    c.number = state.varint();
    c.frames.restore(state);
  }
}

// The state: the size of the file and the hash of the grid's bytes in it; the records; of each level, its open pages and what is in them.
void PartWriter::save(Bytes& state) {
  bytes_.save(state);
  put_varint(state, chunks_);
  put_varint(state, recorded_);
  put_sized(state, records_);
  for (const Level& l : levels_) {
    l.open.save(state);
    put_varint(state, l.contents.size());
    for (const auto& [page, info] : l.contents)
      for (const uint64_t n : {page, info.chunks, info.bytes, info.changes}) put_varint(state, n);
  }
  for (const Cells& c : cells_) {
    put_varint(state, c.number);
    c.frames.save(state);
  }
}

// A record begins with its kind and the number of bytes of the grid since the record before it.
void PartWriter::begin_record(uint8_t kind) {
  records_.push_back(kind);
  put_varint(records_, bytes_.size() - recorded_);
  recorded_ = bytes_.size();
}

void PartWriter::put(const ChunkKey& key, const EncodedChunk& chunk) {
  Level& l = levels_[stored_index(key.level)];
  const bool with_stats = key.level == 0;
  ChunkEntry entry = chunk.entry;
  entry.offset = bytes_.size();
  bytes_.append(chunk.frame);
  if (entry.size != 0) ++chunks_;
  if (!has_page(head_.range, l.open.shape(), key)) {
    begin_record(kChunk);
    for (const uint64_t n : {static_cast<uint64_t>(key.level), uint64_t{key.cu}, uint64_t{key.cv}, uint64_t{key.segment}, chunk.changes})
      put_varint(records_, n);
    put_entry(records_, entry, with_stats);
    return;
  }
  LevelInfo& info = l.contents[l.open.shape().page_of(key)];
  if (entry.size != 0) info.add(1, entry.size, chunk.changes);
  const auto page = l.open.put(key, std::move(entry));
  if (!page) return;
  const DirectoryEntry place = bytes_.append_frame(encode_page(page->entries, with_stats, bytes_.size()));
  begin_record(kPage);
  for (const uint64_t n : {static_cast<uint64_t>(key.level), info.chunks, info.bytes, info.changes, page->number, place.size})
    put_varint(records_, n);
  put_fixed(records_, place.checksum);
  l.contents.erase(page->number);
}

void PartWriter::put_frame_record(uint8_t kind, size_t channel, std::initializer_list<uint64_t> place, std::span<const uint8_t> frame) {
  bytes_.append(frame);
  begin_record(kind);
  put_varint(records_, channel);
  for (const uint64_t n : place) put_varint(records_, n);
  put_varint(records_, frame.size());
  if (!frame.empty()) put_fixed(records_, checksum(frame));
}

void PartWriter::put_cells(size_t channel, const ChunkKey& key, std::span<const uint8_t> frame) {
  const LevelShape& shape = levels_.front().open.shape();
  if (!has_page(head_.range, shape, key)) return put_frame_record(kCells, channel, {key.cu, key.cv, key.segment}, frame);
  Cells& c = cells_[channel - 1];
  if (!frame.empty()) put_frame_record(kFrame, channel, {}, frame), ++c.number;
  const auto page = c.frames.put(key, frame.empty() ? kNoFrame : c.number - 1, c.number);
  if (!page) return;
  put_frame_record(kCellsPage, channel, {shape.page_of(key)}, *page);
  if (!page->empty()) ++c.number;
}

void PartWriter::put_child(int level, uint32_t cu, uint32_t cv, const Chunk& coarsened) {
  begin_record(kChild);
  const RayBlock& rays = coarsened.rays;
  for (const uint64_t n : {static_cast<uint64_t>(level), uint64_t{cu}, uint64_t{cv}, uint64_t{rays.nu}, uint64_t{rays.nv}, uint64_t{rays.length}})
    put_varint(records_, n);
  put_sized(records_, encoder_.encode(rays, coarsened.sets));
}

// The footer: the sizes and checksums of the records and of what was found; the size of the file; the hash of the grid's bytes; a
// checksum of all these.
void PartWriter::finish(std::span<const uint8_t> found, bool durable) {
  begin_record(kEnd);
  Bytes footer;
  for (const std::span<const uint8_t> tail : {std::span<const uint8_t>(records_), found}) {
    put_fixed(footer, uint64_t{tail.size()});
    put_fixed(footer, checksum(tail));
    bytes_.file().append(tail);
  }
  put_fixed(footer, bytes_.size() + kPartFooter);
  const auto hash = bytes_.hash();
  footer.insert(footer.end(), hash.begin(), hash.end());
  put_fixed(footer, checksum(footer));
  bytes_.file().append(footer);
  bytes_.file().commit(durable);
}

// ---- reading

bool is_part(const std::filesystem::path& path) {
  const InputFile file(path);
  constexpr std::string_view kAnyVersion = kMagic.substr(0, kMagic.size() - 1);
  return file.size() >= kAnyVersion.size() && begin_of(file, kAnyVersion.size()) == kAnyVersion;
}

PartReader::PartReader(const std::filesystem::path& path) : file_(path) {
  const auto fail = [&](const std::string& what) { throw FormatError(fmt::format("{}: {}", name(), what)); };
  constexpr uint64_t kBegin = kMagic.size() + 16;
  if (file_.size() < kBegin + kPartFooter) fail(fmt::format("expected a part of a grid, found {} bytes", file_.size()));
  if (begin_of(file_, kMagic.size()) != kMagic)
    fail("expected a part of a grid, which `mesh --shard` writes, found another kind of file or another version");

  Bytes footer(kPartFooter);
  file_.read(file_.size() - kPartFooter, footer);
  ByteReader end(footer, name());
  for (DirectoryEntry* place : {&records_, &found_}) place->size = end.fixed<uint64_t>(), place->checksum = end.fixed<uint64_t>();
  const auto bytes = end.fixed<uint64_t>();
  std::ranges::copy(end.take(16), hash_.begin());
  if (end.fixed<uint64_t>() != checksum(std::span(footer).first(kPartFooter - 8)) || bytes != file_.size())
    fail("its end is damaged or missing: the file is cut or not a whole one");

  Bytes begin(16);
  file_.read(kMagic.size(), begin);
  ByteReader sizes(begin, name());
  const DirectoryEntry head{kBegin, sizes.fixed<uint64_t>(), sizes.fixed<uint64_t>()};
  uint64_t left = file_.size() - kBegin - kPartFooter;
  for (const uint64_t part : {head.size, records_.size, found_.size}) {
    if (part > left || part > kMostBeside) fail("its parts are larger than the file: it is damaged");
    left -= part;
  }
  head_ = naming(name(), [&] { return decode_head(take(head, "its head"), name()); });
  first_ = kBegin + head.size;
  bytes_ = left;
  records_.offset = first_ + bytes_;
  found_.offset = records_.offset + records_.size;
}

Bytes PartReader::take(const DirectoryEntry& place, const char* what) const {
  Bytes out(place.size);
  file_.read(place.offset, out);
  if (checksum(out) != place.checksum) throw FormatError(fmt::format("{}: the checksum of {} differs: it is damaged", name(), what));
  return out;
}

Bytes PartReader::found() const { return take(found_, "what was found"); }

void PartReader::replay(PartTaker& taker) const {
  naming(name(), [&] { replay_unnamed(taker); });
}

void PartReader::replay_frame(ByteReader& in, uint8_t kind, uint64_t bytes, PartTaker& taker) const {
  const Metadata& meta = head_.meta;
  const LevelShape shape(meta, 0);
  const size_t channel = in.varint(0, meta.channels.size() - 1, "channel");
  if (channel == 0) in.fail("the labels have chunks and pages");
  ChunkKey key{};
  uint64_t page = 0;
  if (kind == kCells)
    key = {0, static_cast<uint32_t>(in.varint(0, shape.chunks_u - 1, "chunk")), static_cast<uint32_t>(in.varint(0, shape.chunks_v - 1, "chunk")),
           static_cast<uint32_t>(in.varint(0, shape.segments - 1, "segment"))};
  if (kind == kCellsPage) page = in.varint(0, shape.pages() - 1, "page");
  const uint64_t size = in.varint(kind == kFrame, bytes, "bytes of a frame"), sum = size == 0 ? 0 : in.fixed<uint64_t>();
  if (kind == kCells) taker.cells(channel, key, size, sum);
  else if (kind == kFrame) taker.frame(channel, size, sum);
  else taker.cells_page(channel, page, size, sum);
}

void PartReader::replay_unnamed(PartTaker& taker) const {
  const Metadata& meta = head_.meta;
  const auto labels = static_cast<uint32_t>(meta.labels.size());
  ChunkDecoder decoder;
  uint64_t left = bytes_;
  const Bytes records = take(records_, "its records");
  for (ByteReader in(records, name());;) {
    const auto kind = in.fixed<uint8_t>();
    const uint64_t bytes = in.varint(0, left, "bytes of a record");
    left -= bytes;
    if (bytes > 0) taker.bytes(bytes);
    if (kind == kEnd) {
      if (left != 0) in.fail("the records end before the bytes of the grid");
      return in.expect_end();
    }
    if (kind == kCells || kind == kFrame || kind == kCellsPage) {
      replay_frame(in, kind, bytes, taker);
      continue;
    }
    const int level = static_cast<int>(in.varint(0, static_cast<uint64_t>(meta.grid.levels() - 1), "level"));
    if (level == 1) in.fail("level 1 is not stored");
    const LevelShape shape(meta, level);
    if (kind == kPage) {
      LevelInfo info{level, 0, in.varint(), in.varint(), in.varint()};
      const uint64_t page = in.varint(0, shape.pages() - 1, "page"), size = in.varint(1, bytes, "bytes of a page");
      taker.page(info, page, size, in.fixed<uint64_t>());
      continue;
    }
    const auto cu = static_cast<uint32_t>(in.varint(0, shape.chunks_u - 1, "chunk")),
               cv = static_cast<uint32_t>(in.varint(0, shape.chunks_v - 1, "chunk"));
    if (kind == kChild) {
      if (level % 2 != 0 || level == 0 || level + 1 >= meta.grid.levels()) in.fail("expected a child on a level that has parents, found another one");
      const auto half = [](uint32_t n) { return (n + 1) / 2; };
      const uint32_t nu = half(shape.rays_u(cu)), nv = half(shape.rays_v(cv)), length = half(shape.nw);
      if (in.varint() != nu || in.varint() != nv || in.varint() != length) in.fail("a child has not the rays and cells of its place");
      Chunk rays;
      decoder.decode(in.take_sized(), nu, nv, length, labels, rays);
      taker.child(level, cu, cv, std::move(rays));
      continue;
    }
    if (kind != kChunk) in.fail("expected a chunk, a page or a child");
    const ChunkKey key{level, cu, cv, static_cast<uint32_t>(in.varint(0, shape.segments - 1, "segment"))};
    const uint64_t changes = in.varint();
    ChunkEntry entry = take_entry(in, level == 0, labels);
    if (entry.size > bytes) in.fail("a chunk has more bytes than there are");
    taker.chunk(key, std::move(entry), changes);
  }
}

}  // namespace teracell::store
