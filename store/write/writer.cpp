#include "store/write/writer.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "store/format/chunk_stats.hpp"
#include "store/format/metadata_json.hpp"
#include "store/text/json_check.hpp"

namespace teracell::inline store {

namespace {

// A directory is one skippable frame, so there are less than 4 GiB of it.
constexpr uint64_t kMaxEntries = (~uint32_t{0} - 8) / (kDirectoryEntry + 1);

}  // namespace

EncodedChunk encode_chunk(ChunkEncoder& encoder, const RayBlock& rays, const SetTable& sets, bool with_stats) {
  EncodedChunk out;
  if (rays.uniform()) {
    out.entry.uniform = sets.members(rays.patterns.sets(0)[0]);
    return out;
  }
  out.frame = encoder.encode(rays, sets);
  out.entry.size = static_cast<uint32_t>(out.frame.size());
  out.entry.checksum = checksum(out.frame);
  out.changes = rays.at.size();
  if (with_stats) out.entry.stats = stats_of(rays);
  return out;
}

GridWriter::GridWriter(const std::filesystem::path& path, Metadata meta) : GridWriter(path, std::move(meta), 0) { bytes_.append(encode_header()); }

GridWriter::GridWriter(const std::filesystem::path& path, Metadata meta, uint64_t keep)
    : meta_(std::move(meta)), covers_(meta_.channels.size()), cells_(meta_.channels.size()), bytes_(path, keep) {
  if (const std::string beyond = beyond_bounds(meta_); !beyond.empty()) throw UsageError(beyond);
  for (int level = 0; level < meta_.grid.levels(); level = next_stored(level)) {
    Level l{{level, 0, 0, 0, 0}, OpenPages(meta_, level), {}};
    // Two factors at a time: the product of three could overflow.
    const LevelShape& s = l.open.shape();
    if (uint64_t{s.pages_u} * s.pages_v > kMaxEntries || s.pages() > kMaxEntries)
      throw UsageError(fmt::format("{} x {} rays are more than a file can index: take fewer cells across {}, or rays along the longest axes", s.nu,
                                   s.nv, axis_name(meta_.ray_axis)));
    l.directory.resize(s.pages());
    levels_.push_back(std::move(l));
  }
}

// The state: the size and the hash of the file; of each level, its counts, its directory so far and its open pages; of each channel
// but the labels, its cover so far, and which frames are those of chunks.
void GridWriter::save(Bytes& state) {
  bytes_.save(state);
  for (const Level& l : levels_) {
    for (const uint64_t n : {l.info.chunks, l.info.bytes, l.info.changes}) put_varint(state, n);
    for (const DirectoryEntry& e : l.directory)
      for (const uint64_t n : {e.offset, e.size, e.checksum}) put_varint(state, n);
    l.open.save(state);
  }
  for (size_t i = 1; i < covers_.size(); ++i) {
    put_varint(state, covers_[i].size());
    for (const DirectoryEntry& e : covers_[i])
      for (const uint64_t n : {e.offset, e.size, e.checksum}) put_varint(state, n);
    put_varint(state, cells_[i].has_value());
    if (cells_[i]) cells_[i]->save(state);
  }
}

GridWriter::GridWriter(const std::filesystem::path& path, Metadata meta, ByteReader& state)
    : GridWriter(path, std::move(meta), state.fixed<uint64_t>()) {
  bytes_.restore(state, 0);
  for (Level& l : levels_) {
    l.info.chunks = state.varint();
    l.info.bytes = state.varint();
    l.info.changes = state.varint();
    for (DirectoryEntry& e : l.directory) e = {state.varint(), state.varint(), state.varint()};
    l.open.restore(state);
  }
  for (size_t i = 1; i < covers_.size(); ++i) {
    covers_[i].resize(state.varint(0, state.remaining() / 3, "frames"));  // three numbers each
    for (DirectoryEntry& e : covers_[i]) e = {state.varint(), state.varint(), state.varint()};
    if (state.varint(0, 1, "whether there are frames of chunks") != 0) cells(i).restore(state);
  }
}

uint64_t GridWriter::chunks() const {
  uint64_t chunks = 0;
  for (const Level& l : levels_) chunks += l.info.chunks;
  return chunks;
}

void GridWriter::put(const ChunkKey& key, const EncodedChunk& chunk) {
  bytes_.append(chunk.frame);
  put_entry(key, chunk.entry, chunk.changes);
}

void GridWriter::put_entry(const ChunkKey& key, ChunkEntry entry, uint64_t changes) {
  Level& l = levels_[stored_index(key.level)];
  if (entry.size != 0) {
    entry.offset = bytes_.size() - entry.size;
    l.info.add(1, entry.size, changes);
  }
  if (const auto page = l.open.put(key, std::move(entry)))
    put_place(l, page->number, bytes_.append_frame(encode_page(page->entries, key.level == 0, bytes_.size())));
}

void GridWriter::put_page(const LevelInfo& chunks, uint64_t page, uint64_t size, uint64_t checksum) {
  Level& l = levels_[stored_index(chunks.level)];
  l.info.add(chunks.chunks, chunks.bytes, chunks.changes);
  put_place(l, page, {bytes_.size() - size, size, checksum});
}

void GridWriter::put_place(Level& l, uint64_t page, const DirectoryEntry& place) {
  if (l.directory[page].size != 0) throw FormatError(fmt::format("level {} index page {}: it is there twice", l.info.level, page));
  l.directory[page] = place;
}

void GridWriter::put_child(int, uint32_t, uint32_t, const Chunk&) { throw std::logic_error("a part of a chunk was put into a whole grid"); }

void GridWriter::add_to_cover(size_t channel, const DirectoryEntry& place) {
  auto& cover = covers_[channel];
  if (cover.size() == kMaxEntries) throw Error(fmt::format("channel '{}' has more frames than a file can index", meta_.channels[channel].name));
  cover.push_back(place);
}

void GridWriter::put_frame(size_t channel, std::span<const uint8_t> frame) { add_to_cover(channel, bytes_.append_frame(frame)); }

CellFrames& GridWriter::cells(size_t channel) {
  if (!cells_[channel]) cells_[channel].emplace(meta_);
  return *cells_[channel];
}

// The chunk's frame, if it has one, is the last of the cover.
void GridWriter::place_cells(size_t channel, const ChunkKey& key, bool has_frame) {
  const uint64_t next = covers_[channel].size();
  if (const auto page = cells(channel).put(key, has_frame ? next - 1 : kNoFrame, next); page && !page->empty()) put_frame(channel, *page);
}

void GridWriter::put_cells(size_t channel, const ChunkKey& key, std::span<const uint8_t> frame) {
  if (!frame.empty()) put_frame(channel, frame);
  place_cells(channel, key, !frame.empty());
}

void GridWriter::put_frame_entry(size_t channel, uint64_t size, uint64_t checksum) { add_to_cover(channel, {bytes_.size() - size, size, checksum}); }

void GridWriter::put_cells_entry(size_t channel, const ChunkKey& key, uint64_t size, uint64_t checksum) {
  if (size != 0) put_frame_entry(channel, size, checksum);
  place_cells(channel, key, size != 0);
}

void GridWriter::put_cells_page(size_t channel, uint64_t page, uint64_t size, uint64_t checksum) {
  cells(channel).put_page(page, size == 0 ? kNoFrame : covers_[channel].size());
  if (size != 0) put_frame_entry(channel, size, checksum);
}

void GridWriter::finish(const std::string& report, uint64_t crossings, const CellSums* sums) {
  ContentHash hash;
  const auto append_hashed = [&](const Bytes& frame) {
    hash.add(frame);
    return bytes_.append_frame(frame);
  };
  for (const Level& l : levels_)
    if (!l.open.empty() || std::ranges::any_of(l.directory, [](const DirectoryEntry& e) { return e.size == 0; }))
      throw FormatError(fmt::format("level {} lacks chunks", l.info.level));
  for (size_t i = 1; i < covers_.size(); ++i)
    if (cells_[i])
      for (const Bytes& list : cells_[i]->lists()) put_frame(i, list);
  for (size_t i = 1; i < covers_.size(); ++i)
    if (covers_[i].empty()) throw Error(fmt::format("channel '{}' has no frame", meta_.channels[i].name));
  meta_.levels().clear();
  meta_.crossings = crossings;
  meta_.labels_hash = sums ? labels_hash(meta_, sums->labels) : "";
  meta_.amounts.clear();
  if (sums && has_room_for_amounts(meta_)) {
    if (sums->amounts.size() > meta_.labels.size()) throw FormatError("cells of labels that are not there");
    meta_.amounts = sums->amounts;
    meta_.amounts.resize(meta_.labels.size());
  }
  for (Level& l : levels_) {
    l.info.directory = append_hashed(encode_directory(l.directory)).offset;
    meta_.levels().push_back(l.info);
  }
  for (size_t i = 1; i < covers_.size(); ++i) {
    meta_.channels[i].cover = append_hashed(encode_directory(covers_[i])).offset;
    meta_.channels[i].frames = covers_[i].size();
    meta_.channels[i].bytes = 0;
    for (const DirectoryEntry& frame : covers_[i]) meta_.channels[i].bytes += frame.size;
  }
  check_json(report, "report");
  Footer footer;
  const Bytes metadata = encode_metadata(meta_);
  std::vector<ChannelKind> kinds;
  for (const Channel& c : meta_.channels) kinds.push_back({c.name, c.coding, nullptr});
  decode_metadata(metadata, kinds);  // throws before there is a file that nobody can open
  footer.metadata = append_hashed(metadata);
  footer.report = append_hashed(encode_text(report));
  footer.hash = hash.digest();
  footer.file_bytes = bytes_.size() + kFooterBytes;
  bytes_.file().append(encode_footer(footer));
  bytes_.file().commit();
}

}  // namespace teracell::store
