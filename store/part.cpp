#include "store/part.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "store/metadata_json.hpp"

namespace teracell {
namespace {

constexpr std::string_view kMagic = "tcellpt1";  // its last digit is raised when the layout changes
constexpr uint64_t kBlockHead = 16, kPartFooter = 40;
enum Kind : uint8_t { kHead, kChunks, kFound };
enum Record : uint8_t { kChunk, kChild };
// A block ends with the record that reaches one of these.
constexpr uint64_t kMostFrames = uint64_t{1} << 20, kMostRecords = 256;
constexpr uint64_t kLongest = uint64_t{1} << 30;  // bytes of a block: a chunk of kMaxChunkBytes fits

void put_bytes(Bytes& out, std::span<const uint8_t> bytes) {
  put_varint(out, bytes.size());
  out.insert(out.end(), bytes.begin(), bytes.end());
}

Bytes encode_head(const PartHead& head) {
  const nlohmann::ordered_json json = {
      {"run", head.run}, {"part", head.number}, {"parts", head.of}, {"first", head.range.first}, {"end", head.range.end}};
  Bytes out;
  put_bytes(out, encode_text(json.dump()));
  Metadata meta = head.meta;
  meta.levels().clear();  // they are known when the grid is complete; until then they are listed with zeros
  for (int level = 0; level < meta.grid.levels(); level += level == 0 ? 2 : 1) meta.levels().push_back({level, 0, 0, 0, 0});
  put_bytes(out, encode_metadata(meta));
  return out;
}

PartHead decode_head(std::span<const uint8_t> body, const std::string& name) {
  ByteReader in(body, name);
  const auto json = nlohmann::json::parse(decode_text(in.take(in.varint()), name));
  const Metadata meta = decode_metadata(in.take(in.varint()));
  return {json.at("run").get<std::string>(),
          json.at("part").get<uint32_t>(),
          json.at("parts").get<uint32_t>(),
          {json.at("first").get<uint64_t>(), json.at("end").get<uint64_t>()},
          meta};
}

Bytes encode_block(const PartBlock& block) {
  Bytes out;
  put_varint(out, block.records);
  put_bytes(out, block.places);
  for (const auto* entries : {&block.fine, &block.coarse}) {
    put_varint(out, entries->size());
    put_bytes(out, encode_page(*entries, entries == &block.fine));
  }
  put_bytes(out, block.frames);
  return out;
}

}  // namespace

PartWriter::PartWriter(const std::filesystem::path& path, PartHead head) : head_(std::move(head)), file_(path) {
  file_.append({reinterpret_cast<const uint8_t*>(kMagic.data()), kMagic.size()});
  append(kHead, encode_head(head_));
}

PartWriter::PartWriter(const std::filesystem::path& path, PartHead head, ByteReader& state)
    : head_(std::move(head)), file_(path, state.fixed<uint64_t>()) {
  Bytes piece(1 << 20);
  for (uint64_t at = kMagic.size(); at < file_.size(); at += piece.size()) {
    piece.resize(std::min<uint64_t>(piece.size(), file_.size() - at));
    file_.read_kept(at, piece);
    hash_.add(piece);
  }
  if (!std::ranges::equal(state.take(16), hash_.digest())) {
    file_.abandon();
    state.fail("the partial file has other bytes than it had: it is damaged", Remedy::kFreshStart);
  }
  chunks_ = state.varint();
  block_.records = state.varint();
  for (Bytes* bytes : {&block_.places, &block_.frames}) {
    const auto kept = state.take(state.varint());
    bytes->assign(kept.begin(), kept.end());
  }
  for (auto* entries : {&block_.fine, &block_.coarse}) {
    const uint64_t count = state.varint(0, kMostRecords, "chunks of a block");
    *entries = decode_page(state.take(state.varint()), count, entries == &block_.fine, static_cast<uint32_t>(meta().labels.size()));
  }
}

// The state: the size and the hash of the file, and what is not in it yet.
void PartWriter::save(Bytes& state) {
  file_.sync();
  put_fixed(state, file_.size());
  const auto hash = hash_.digest();
  state.insert(state.end(), hash.begin(), hash.end());
  put_varint(state, chunks_);
  put_varint(state, block_.records);
  put_bytes(state, block_.places);
  put_bytes(state, block_.frames);
  for (const auto* entries : {&block_.fine, &block_.coarse}) {
    put_varint(state, entries->size());
    put_bytes(state, encode_page(*entries, entries == &block_.fine));
  }
}

void PartWriter::append(uint8_t kind, std::span<const uint8_t> body) {
  Bytes bytes;
  bytes.reserve(kBlockHead + 1 + body.size());
  put_fixed(bytes, uint64_t{body.size() + 1});
  bytes.resize(kBlockHead);
  bytes.push_back(kind);
  bytes.insert(bytes.end(), body.begin(), body.end());
  Bytes sum;
  put_fixed(sum, checksum(std::span(bytes).subspan(kBlockHead)));
  std::ranges::copy(sum, bytes.begin() + 8);
  hash_.add(bytes);
  file_.append(bytes);
}

void PartWriter::put(const ChunkKey& key, const EncodedChunk& chunk) {
  block_.places.push_back(kChunk);
  for (const uint64_t n : {static_cast<uint64_t>(key.level), uint64_t{key.cu}, uint64_t{key.cv}, uint64_t{key.segment}, chunk.changes})
    put_varint(block_.places, n);
  ChunkEntry entry = chunk.entry;
  entry.offset = block_.frames.size();
  block_.frames.insert(block_.frames.end(), chunk.frame.begin(), chunk.frame.end());
  if (entry.size != 0) ++chunks_;
  (key.level == 0 ? block_.fine : block_.coarse).push_back(std::move(entry));
  if (++block_.records == kMostRecords || block_.frames.size() >= kMostFrames) flush();
}

void PartWriter::put_child(int level, uint32_t cu, uint32_t cv, const Chunk& coarsened) {
  block_.places.push_back(kChild);
  const RayBlock& rays = coarsened.rays;
  for (const uint64_t n : {static_cast<uint64_t>(level), uint64_t{cu}, uint64_t{cv}, uint64_t{rays.nu}, uint64_t{rays.nv}, uint64_t{rays.length}})
    put_varint(block_.places, n);
  put_bytes(block_.places, encoder_.encode(rays, coarsened.sets));
  if (++block_.records == kMostRecords) flush();
}

void PartWriter::flush() {
  if (block_.records == 0) return;
  append(kChunks, encode_block(block_));
  block_ = {};
}

// The footer: where the block of what was found begins, the size of the file, the hash of all before it, and a checksum of these.
void PartWriter::finish(std::span<const uint8_t> found) {
  flush();
  Bytes footer;
  put_fixed(footer, file_.size());
  append(kFound, found);
  put_fixed(footer, file_.size() + kPartFooter);
  const auto hash = hash_.digest();
  footer.insert(footer.end(), hash.begin(), hash.end());
  put_fixed(footer, checksum(footer));
  file_.append(footer);
  file_.commit();
}

// ---- reading

bool is_part(const std::filesystem::path& path) {
  const InputFile file(path);
  std::string begin(std::min<uint64_t>(kMagic.size() - 1, file.size()), ' ');
  file.read(0, {reinterpret_cast<uint8_t*>(begin.data()), begin.size()});
  return begin == kMagic.substr(0, kMagic.size() - 1);
}

PartReader::PartReader(const std::filesystem::path& path) : file_(path) {
  const auto fail = [&](const std::string& what) { throw FormatError(fmt::format("{}: {}", name(), what)); };
  if (file_.size() < kMagic.size() + kPartFooter) fail(fmt::format("expected a part of a grid, found {} bytes", file_.size()));
  std::string magic(kMagic.size(), ' ');
  file_.read(0, {reinterpret_cast<uint8_t*>(magic.data()), magic.size()});
  if (magic != kMagic) fail("expected a part of a grid, which `mesh --shard` writes, found another kind of file or another version");
  Bytes footer(kPartFooter);
  file_.read(file_.size() - kPartFooter, footer);
  ByteReader in(footer, name());
  in.fixed<uint64_t>();
  const auto bytes = in.fixed<uint64_t>();
  in.take(16);
  if (in.fixed<uint64_t>() != checksum(std::span(footer).first(kPartFooter - 8)) || bytes != file_.size())
    fail("its end is damaged or missing: the file is cut or not a whole one");
  uint64_t offset = kMagic.size();
  const Block head = block_at(offset);
  if (head.kind != kHead) fail("expected the head of a part first");
  head_ = decode_head(head.body, name());
  first_block_ = offset;
}

// Reads the block at `offset`, which is moved on to the next one.
PartReader::Block PartReader::block_at(uint64_t& offset) const {
  const auto fail = [&](const std::string& what) { throw FormatError(fmt::format("{}: byte {}: {}", name(), offset, what)); };
  const uint64_t end = file_.size() - kPartFooter;
  Bytes head(kBlockHead + 1);
  if (end - offset < head.size()) fail("expected a block, found the end");
  file_.read(offset, head);
  ByteReader in(head, name());
  const auto length = in.fixed<uint64_t>(), expected = in.fixed<uint64_t>();
  if (length == 0 || length > kLongest || length > end - offset - kBlockHead) fail("the block is longer than the file: it is damaged");
  Block out{0, Bytes(length)};
  file_.read(offset + kBlockHead, out.body);
  if (checksum(out.body) != expected) fail("the block's checksum differs: it is damaged");
  out.kind = out.body[0];
  out.body.erase(out.body.begin());
  offset += kBlockHead + length;
  return out;
}

Bytes PartReader::read(const TakeChunk& chunk, const TakeChild& child) const {
  const Metadata& meta = head_.meta;
  const auto labels = static_cast<uint32_t>(meta.labels.size());
  ChunkDecoder decoder;
  for (uint64_t offset = first_block_;;) {
    Block block = block_at(offset);
    if (block.kind == kFound) {
      if (offset != file_.size() - kPartFooter) throw FormatError(fmt::format("{}: byte {}: expected the end", name(), offset));
      return std::move(block.body);
    }
    ByteReader in(block.body, name());
    const uint64_t records = in.varint(0, kMostRecords, "records");
    ByteReader places(in.take(in.varint()), name());
    std::array<std::vector<ChunkEntry>, 2> entries;
    for (size_t coarse = 0; coarse < 2; ++coarse) {
      const uint64_t count = in.varint(0, kMostRecords, "chunks");
      entries[coarse] = decode_page(in.take(in.varint()), count, coarse == 0, labels);
    }
    const auto frames = in.take(in.varint());
    in.expect_end();
    std::array<size_t, 2> next{};
    for (uint64_t i = 0; i < records; ++i) {
      const auto what = places.fixed<uint8_t>();
      const int level = static_cast<int>(places.varint(0, static_cast<uint64_t>(meta.grid.levels() - 1), "level"));
      const LevelShape shape(meta, level);
      const auto cu = static_cast<uint32_t>(places.varint(0, shape.chunks_u - 1, "chunk")),
                 cv = static_cast<uint32_t>(places.varint(0, shape.chunks_v - 1, "chunk"));
      if (what == kChild) {
        Chunk rays;
        const auto nu = static_cast<uint32_t>(places.varint(1, meta.chunk_rays, "rays")),
                   nv = static_cast<uint32_t>(places.varint(1, meta.chunk_rays, "rays"));
        const auto length = static_cast<uint32_t>(places.varint(1, Axis::kMaxCells, "cells"));
        decoder.decode(places.take(places.varint()), nu, nv, length, labels, rays);
        child(level, cu, cv, std::move(rays));
        continue;
      }
      if (what != kChunk) places.fail("expected a chunk or a child");
      const ChunkKey key{level, cu, cv, static_cast<uint32_t>(places.varint(0, shape.segments - 1, "segment"))};
      EncodedChunk made;
      made.changes = places.varint();
      const size_t coarse = level == 0 ? 0 : 1;
      if (next[coarse] == entries[coarse].size()) places.fail("expected an entry for each chunk");
      made.entry = std::move(entries[coarse][next[coarse]++]);
      if (made.entry.size != 0) {
        if (made.entry.offset > frames.size() || made.entry.size > frames.size() - made.entry.offset) places.fail("the chunk lies outside its block");
        const auto frame = frames.subspan(made.entry.offset, made.entry.size);
        made.frame.assign(frame.begin(), frame.end());
      }
      chunk(key, made);
    }
    places.expect_end();
  }
}

}  // namespace teracell
