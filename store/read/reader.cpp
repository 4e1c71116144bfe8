#include "store/read/reader.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "store/base/wanted.hpp"
#include "store/format/cell_frames.hpp"
#include "store/format/checked_read.hpp"
#include "store/format/metadata_json.hpp"
#include "store/runs/chunk_codec.hpp"
#include "store/runs/chunk_parts.hpp"
#include "store/runs/pyramid.hpp"
#include "store/text/json_check.hpp"

namespace teracell::inline store {
namespace {

template <class T>
size_t memory_of(const std::vector<T>& v) {
  return v.capacity() == 0 ? 0 : v.capacity() * sizeof(T) + 16;  // 16: what malloc adds
}

size_t memory_of(const IndexPart& part) {
  size_t bytes = sizeof(IndexPart) + memory_of(part.block) + memory_of(part.page) + memory_of(part.cells);
  for (const ChunkEntry& e : part.page) bytes += memory_of(e.uniform) + memory_of(e.stats);
  return bytes;
}

// The up to 2 x 2 x 2 chunks of the level below that a chunk covers.
std::vector<ChunkKey> chunks_below(const ChunkKey& key, const LevelShape& below) {
  std::vector<ChunkKey> out;
  for (uint32_t v = 2 * key.cv; v < std::min(2 * key.cv + 2, below.chunks_v); ++v)
    for (uint32_t u = 2 * key.cu; u < std::min(2 * key.cu + 2, below.chunks_u); ++u)
      for (uint32_t s = 2 * key.segment; s < std::min(2 * key.segment + 2, below.segments); ++s) out.push_back({below.level, u, v, s});
  return out;
}

// "cells x 64 to 127, y 0 to 63, z 0 to 99": those of level 0 that chunks cover, `wide` of them along u and v.
std::string cells_of(const Metadata& meta, const ChunkKey& first, uint32_t wide = 1) {
  const int64_t rays = int64_t{meta.chunk_rays} << first.level, cells = int64_t{meta.chunk_cells} << first.level;
  const Box box = meta.frame().box({first.cu * rays, first.cv * rays, first.segment * cells},
                                   {(first.cu + wide) * rays, (first.cv + wide) * rays, (first.segment + 1) * cells});
  const Index3 n = meta.grid.cells();
  const auto range = [&](int d) { return fmt::format("{} {} to {}", axis_name(d), box.lo[d], std::min(box.hi[d], n[d]) - 1); };
  return fmt::format("cells {}, {}, {}", range(0), range(1), range(2));
}

}  // namespace

GridReader::GridReader(const std::filesystem::path& path) : GridReader(std::make_unique<InputFile>(path)) {}

GridReader::GridReader(std::unique_ptr<ByteSource> source, std::shared_ptr<ChunkKeeper> keeper, std::shared_ptr<IndexCache> index)
    : source_(std::move(source)),
      keeper_(std::move(keeper)),
      index_(index ? std::move(index) : std::make_shared<IndexCache>(16 << 20)),
      number_(index_->new_owner()) {
  naming(name(), [&] {
    const uint64_t size = source_->size();
    if (size < kHeaderBytes + kFooterBytes)
      throw FormatError(
          fmt::format("expected at least {} bytes, found {}: not a teracell file, or cut short (FORMAT.md 2.1)", kHeaderBytes + kFooterBytes, size));
    Bytes bytes(kHeaderBytes);
    source_->read(0, bytes);
    version_ = check_header(bytes);
    bytes.resize(kFooterBytes);
    source_->read(size - kFooterBytes, bytes);
    footer_ = decode_footer(bytes);
    if (footer_.file_bytes != size)
      throw FormatError(fmt::format("expected {} bytes, found {}: bytes are missing or were added (FORMAT.md 6.1)", footer_.file_bytes, size));
    read_checked(*source_, footer_.metadata, "metadata", bytes);
    meta_ = decode_metadata(bytes);
    std::vector<ByteRange> directories;
    for (const LevelInfo& l : meta_.levels()) directories.push_back({l.directory, 8});
    for (const Channel& c : meta_.others()) directories.push_back({c.cover, 8});
    source_->prefetch(directories);
    for (const LevelInfo& l : meta_.levels()) {
      const LevelShape s = shape(l.level);
      // Two factors at a time: with a hostile grid the product of three could overflow.
      const bool countable = uint64_t{s.pages_u} * s.pages_v <= size / s.segments;
      check_directory(fmt::format("level {}", l.level), l.directory, countable ? s.pages() : ~uint64_t{0});
    }
    for (const Channel& c : meta_.others()) check_directory(fmt::format("channel '{}'", c.name), c.cover, c.frames);
  });
}

// Calls f(). A FormatError names the file, and is noted.
template <class F>
auto GridReader::reading(F&& f) const try {
  return naming(name(), std::forward<F>(f));
} catch (const FormatError& e) {
  noted(e.what());
  throw;
}

const std::string& GridReader::noted(const std::string& fault) const {
  std::lock_guard lock(damage_mutex_);
  if (damage_.empty()) damage_ = fault;
  return fault;
}

std::string GridReader::damage() const {
  std::lock_guard lock(damage_mutex_);
  return damage_;
}

std::string GridReader::hash() const { return hex(footer_.hash); }

std::string GridReader::report() const {
  std::string text;
  append_report(text);
  return text;
}

void GridReader::append_report(std::string& text) const {
  reading([&] {
    const size_t before = text.size();
    {
      Bytes frame;
      read_checked(*source_, footer_.report, "report", frame);
      append_decoded(frame, "report", text);
    }
    check_json(std::string_view(text).substr(before), "report");
  });
}

const LevelInfo& GridReader::info(int level) const { return *std::ranges::find(meta_.levels(), level, &LevelInfo::level); }

bool GridReader::stored(int level) const { return std::ranges::find(meta_.levels(), level, &LevelInfo::level) != meta_.levels().end(); }

void GridReader::check_directory(const std::string& whose, uint64_t offset, uint64_t entries) const {
  const uint64_t size = source_->size();
  if (entries > size / kDirectoryEntry || directory_bytes(entries) > size || offset > size - directory_bytes(entries))
    throw FormatError(fmt::format("{}: its directory of {} entries at byte {} does not fit into the file (FORMAT.md 9.1)", whose, entries, offset));
  Bytes bytes(8);
  source_->read(offset, bytes);
  check_directory_frame(bytes, entries);
}

DirectoryEntry GridReader::directory_entry(uint64_t directory, uint64_t entries, uint64_t i) const {
  if (i >= entries) throw FormatError(fmt::format("its index names frame {} of a directory of {} (FORMAT.md 9.2)", i, entries));
  const BlockPlace block = directory_block(i / kBlockEntries, entries);
  const uint64_t offset = directory + block.offset;
  const IndexPlace place{number_, false, offset};
  auto found = index_->find(place);
  if (!found || found->block.size() != block.entries) {  // in a hostile file, directories may overlap
    Bytes bytes(block.bytes());
    source_->read(offset, bytes);
    found = std::make_shared<const IndexPart>(IndexPart{decode_directory_block(bytes), {}, {}});
    index_->add(place, found, memory_of(*found));
  }
  return found->block[i % kBlockEntries];
}

DirectoryEntry GridReader::page_place(int level, uint64_t page) const { return directory_entry(info(level).directory, shape(level).pages(), page); }

DirectoryEntry GridReader::frame_place(const Channel& channel, uint64_t frame) const { return directory_entry(channel.cover, channel.frames, frame); }

// Among those who own frames (FrameClaims): below 0, since levels are not.
int GridReader::number_of(const Channel& channel) const {
  return -static_cast<int>(std::ranges::find(meta_.channels, channel.name, &Channel::name) - meta_.channels.begin());
}

// A page or a list, with the `size` numbers that `decode` finds in the frame. `owner`: the page, or a list counted behind all pages.
std::shared_ptr<const IndexPart> GridReader::cells_part(const Channel& channel, uint64_t frame, uint64_t owner,
                                                        const std::function<std::vector<uint64_t>(const Bytes&)>& decode, size_t size) const {
  const int number = number_of(channel);
  const IndexPlace at{number_, false, uint64_t{1} << 63 | static_cast<uint64_t>(-number) << 56 | owner};  // no offset in a file
  auto part = index_->find(at);
  if (part && part->cells.size() == size) return part;
  const DirectoryEntry place = frame_place(channel, frame);
  Bytes bytes;
  read_checked(*source_, place, fmt::format("channel '{}' frame {}", channel.name, frame), bytes);
  claims_.expect_own({number, true, owner}, place);
  part = std::make_shared<const IndexPart>(IndexPart{{}, {}, decode(bytes)});
  index_->add(at, part, memory_of(*part));
  return part;
}

// The frame of a page, or kNoFrame.
uint64_t GridReader::cells_page(const Channel& channel, uint64_t page) const {
  const uint64_t pages = shape(0).pages(), lists = cell_lists(pages), first = page / kPagesPerList * kPagesPerList;
  if (channel.frames < lists) throw FormatError(fmt::format("channel '{}' lacks the lists of its pages (FORMAT.md 12.3)", channel.name));
  const size_t listed = std::min(kPagesPerList, pages - first);
  const auto decode = [&](const Bytes& bytes) { return decode_cell_list(bytes, listed, channel.frames); };
  const uint64_t list = page / kPagesPerList;
  return cells_part(channel, channel.frames - lists + list, pages + list, decode, listed)->cells[page - first];
}

// The frame of a chunk, or kNoFrame.
uint64_t GridReader::cells_frame(const Channel& channel, const ChunkKey& key) const {
  const LevelShape s = shape(0);
  const uint64_t page = s.page_of(key), frame = cells_page(channel, page);
  if (frame == kNoFrame) return kNoFrame;
  const size_t chunks = s.page_size(page);
  return cells_part(
             channel, frame, page, [&](const Bytes& bytes) { return decode_cell_page(bytes, chunks, frame); }, chunks)
      ->cells[s.slot_of(key, page)];
}

bool GridReader::read_cells(const Channel& channel, const ChunkKey& key, Bytes& frame) const {
  Wanted::stop_if_not();
  return reading([&] {
    const uint64_t number = cells_frame(channel, key);
    if (number == kNoFrame) return false;
    const DirectoryEntry place = frame_place(channel, number);
    read_checked(*source_, place, fmt::format("channel '{}' frame {}", channel.name, number), frame);
    const LevelShape s = shape(0);
    const uint64_t page = s.page_of(key);
    claims_.expect_own({number_of(channel), false, page << 12 | s.slot_of(key, page)}, place);
    return true;
  });
}

std::shared_ptr<const std::vector<ChunkEntry>> GridReader::page(int level, uint64_t page) const {
  Wanted::stop_if_not();
  const IndexPlace place{number_, true, page * 32 + static_cast<uint64_t>(level)};
  std::shared_ptr<const IndexPart> part = index_->find(place);
  if (!part) {
    Bytes bytes;
    const DirectoryEntry place_in_file = page_place(level, page);
    const LevelShape s = shape(level);
    const ChunkKey first = s.key_of(page, 0);
    const std::string what = fmt::format("level {} index page {}, {}", level, page, cells_of(meta_, first, s.page_chunks));
    read_checked(*source_, place_in_file, what, bytes);
    claims_.expect_own({level, true, page}, place_in_file);
    part = std::make_shared<const IndexPart>(
        IndexPart{{}, decode_page(bytes, s.page_size(page), level == 0, static_cast<uint32_t>(meta_.labels.size()), place_in_file.offset), {}});
    index_->add(place, part, memory_of(*part));
  }
  return {part, &part->page};
}

std::shared_ptr<const ChunkEntry> GridReader::entry(const ChunkKey& key) const {
  return reading([&] {
    const LevelShape s = shape(key.level);
    const uint64_t p = s.page_of(key);
    const auto found = page(key.level, p);
    return std::shared_ptr<const ChunkEntry>(found, &(*found)[s.slot_of(key, p)]);  // keeps the page alive
  });
}

std::optional<std::vector<Label>> GridReader::uniform(const ChunkKey& key) const {
  if (stored(key.level)) {
    const auto e = entry(key);
    return e->size == 0 ? std::optional(e->uniform) : std::nullopt;
  }
  std::optional<std::vector<Label>> all;
  for (const ChunkKey& below : chunks_below(key, shape(key.level - 1))) {
    auto set = uniform(below);
    if (!set || (all && *all != *set)) return std::nullopt;
    all = std::move(set);
  }
  return all;
}

void GridReader::prefetch(int level, const Box& box, bool with_chunks) const {
  constexpr size_t kMostPages = 64, kMostChunks = 4096;
  if (!source_->is_far() || box.empty()) return;
  if (!stored(level)) {
    Box below = box;
    const Index3 cells = meta_.grid.cells(level - 1);
    for (int d = 0; d < 3; ++d) below.lo[d] *= 2, below.hi[d] = std::min(2 * below.hi[d], cells[d]);
    return prefetch(level - 1, below, with_chunks);
  }
  const LevelShape s = shape(level);
  const RayBox b(box, meta_.frame());
  std::vector<ChunkKey> keys;
  std::vector<uint64_t> pages;
  for_each_part(s, b, [&](const ChunkPart& p) {
    if (keeper_ && keeper_->has(p.key)) return true;
    const uint64_t page = s.page_of(p.key);
    const bool known = !pages.empty() && pages.back() == page;
    if (keys.size() == kMostChunks || (!known && pages.size() == kMostPages)) return false;
    if (!known) pages.push_back(page);
    keys.push_back(p.key);
    return true;
  });
  reading([&] {
    std::vector<ByteRange> places;
    for (const uint64_t page : pages) {
      const BlockPlace block = directory_block(page / kBlockEntries, s.pages());
      places.push_back({info(level).directory + block.offset, block.bytes()});
    }
    source_->prefetch(places);
    places.clear();
    for (const uint64_t page : pages) {
      if (index_->find({number_, true, page * 32 + static_cast<uint64_t>(level)})) continue;
      const DirectoryEntry place = page_place(level, page);
      places.push_back({place.offset, place.size});
    }
    source_->prefetch(places);
    if (!with_chunks) return;
    places.clear();
    for (const ChunkKey& key : keys)
      if (const auto e = entry(key); e->size != 0) places.push_back({e->offset, e->size});
    source_->prefetch(places);
  });
}

// Their blocks of the cover, and then the frames.
void GridReader::prefetch_frames(const Channel& channel, const std::vector<uint64_t>& frames) const {
  std::vector<ByteRange> places;
  for (const uint64_t frame : frames) {
    if (frame >= channel.frames) continue;
    const BlockPlace block = directory_block(frame / kBlockEntries, channel.frames);
    if (places.empty() || places.back().offset != channel.cover + block.offset) places.push_back({channel.cover + block.offset, block.bytes()});
  }
  source_->prefetch(places);
  places.clear();
  for (const uint64_t frame : frames) {
    if (frame >= channel.frames) continue;
    const DirectoryEntry place = frame_place(channel, frame);
    places.push_back({place.offset, place.size});
  }
  source_->prefetch(places);
}

void GridReader::prefetch_cells(const Channel& channel, const Box& box) const {
  constexpr size_t kMostChunks = 4096;
  if (!source_->is_far() || box.empty()) return;
  const LevelShape s = shape(0);
  std::vector<ChunkKey> keys;
  for_each_part(s, RayBox(box, meta_.frame()), [&](const ChunkPart& p) {
    keys.push_back(p.key);
    return keys.size() < kMostChunks;
  });
  const auto frames_of = [&](auto&& frame_of) {
    std::vector<uint64_t> frames;
    for (const ChunkKey& key : keys)
      if (const uint64_t frame = frame_of(key); frame != kNoFrame && (frames.empty() || frames.back() != frame)) frames.push_back(frame);
    return frames;
  };
  reading([&] {
    const uint64_t lists = cell_lists(s.pages());
    prefetch_frames(channel, frames_of([&](const ChunkKey& key) { return channel.frames - lists + s.page_of(key) / kPagesPerList; }));
    prefetch_frames(channel, frames_of([&](const ChunkKey& key) { return cells_page(channel, s.page_of(key)); }));
    prefetch_frames(channel, frames_of([&](const ChunkKey& key) { return cells_frame(channel, key); }));
  });
}

void GridReader::read_stored(const ChunkKey& key, const ChunkEntry& e, Chunk& out) const {
  const LevelShape s = shape(key.level);
  const auto labels = static_cast<uint32_t>(meta_.labels.size());
  const uint32_t nu = s.rays_u(key.cu), nv = s.rays_v(key.cv), length = s.length(key.segment);
  if (e.size == 0) {
    out.sets = SetTable(labels);
    out.rays.fill(nu, nv, length, out.sets.intern(e.uniform));
    return;
  }
  // Scratch memory of each thread: a reader is shared, a decoder can't be.
  thread_local ChunkDecoder decoder;
  thread_local Bytes frame;
  try {
    const DirectoryEntry place{e.offset, e.size, e.checksum};
    read_checked(*source_, place, "its frame", frame);
    const uint64_t page = s.page_of(key);
    claims_.expect_own({key.level, false, page << 12 | s.slot_of(key, page)}, place);
    decoder.decode(frame, nu, nv, length, labels, out);
    if (key.level == 0 && out.sets.ids() != labels) throw FormatError("a cell of level 0 has one label, found a set of several (FORMAT.md 4.1)");
  } catch (const FormatError& error) {
    throw FormatError(noted(fmt::format("{}: {}, {}: {}", name(), chunk_name(key), cells_of(meta_, key), error.what())));
  }
}

void GridReader::read(const ChunkKey& key, Chunk& out) const {
  if (stored(key.level)) read_stored(key, *entry(key), out);
  else derive(key, out);
}

std::shared_ptr<const Chunk> GridReader::chunk(const ChunkKey& key, std::shared_ptr<Chunk>& scratch) const {
  const auto decoded = [&](std::shared_ptr<Chunk>& into) {
    if (!into) into = std::make_shared<Chunk>();
    read(key, *into);
    return into;
  };
  Wanted::stop_if_not();
  if (!keeper_) return decoded(scratch);
  return keeper_->get(key, [&]() -> std::shared_ptr<const Chunk> {
    std::shared_ptr<Chunk> fresh;
    return decoded(fresh);
  });
}

// Each chunk below is coarsened before they are joined: joining them first moves four times as many rays.
void GridReader::derive(const ChunkKey& key, Chunk& out, bool damage) const {
  const LevelShape below = shape(key.level - 1);
  std::vector<Chunk> parts;
  std::vector<Piece> pieces;
  parts.reserve(8);
  Chunk fine;
  for (const ChunkKey& k : chunks_below(key, below)) {
    try {
      read(k, fine);
    } catch (const FormatError&) {
      if (!damage) throw;
      fine.sets = SetTable(static_cast<uint32_t>(meta_.labels.size()));
      fine.rays.fill(below.rays_u(k.cu), below.rays_v(k.cv), below.length(k.segment), fine.sets.intern({}));
    }
    parts.push_back(coarsen(fine, 1));
    pieces.push_back({k.cu % 2 * below.chunk_rays / 2, k.cv % 2 * below.chunk_rays / 2, k.segment % 2 * below.chunk_cells / 2, &parts.back()});
  }
  out = join(pieces, static_cast<uint32_t>(meta_.labels.size()));
}

}  // namespace teracell::store
