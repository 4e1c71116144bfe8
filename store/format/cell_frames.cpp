#include "store/format/cell_frames.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "store/base/zstd_frame.hpp"

namespace teracell::inline store {
namespace {

constexpr int kIndexZstdLevel = 3;
constexpr BodyBound kIndexBound{uint64_t{1} << 20, uint64_t{1} << 16};

Bytes compressed(const Bytes& body) { return ZstdEncoder().encode(body, kIndexZstdLevel, kIndexBound); }

Bytes decompressed(std::span<const uint8_t> frame, const std::string& what) {
  thread_local ZstdDecoder decoder;
  Bytes body;
  decoder.decode(frame, kIndexBound, what, body);
  return body;
}

}  // namespace

Bytes encode_cell_page(const CellPage& page, uint64_t number) {
  Bytes body;
  for (const uint64_t frame : page) put_varint(body, frame == kNoFrame ? 0 : number - frame);
  return compressed(body);
}

CellPage decode_cell_page(std::span<const uint8_t> frame, size_t chunks, uint64_t number) {
  const Bytes body = decompressed(frame, "page of a channel");
  ByteReader in(body, "page of a channel", "12.2");
  CellPage page(chunks);
  for (uint64_t& chunk : page) {
    const uint64_t back = in.varint(0, number, "distance of a frame");
    chunk = back == 0 ? kNoFrame : number - back;
  }
  in.expect_end();
  return page;
}

Bytes encode_cell_list(std::span<const uint64_t> pages) {
  Bytes body;
  for (const uint64_t page : pages) put_varint(body, page == kNoFrame ? 0 : page + 1);
  return compressed(body);
}

std::vector<uint64_t> decode_cell_list(std::span<const uint8_t> frame, size_t pages, uint64_t frames) {
  const Bytes body = decompressed(frame, "list of pages of a channel");
  ByteReader in(body, "list of pages of a channel", "12.3");
  std::vector<uint64_t> list(pages);
  for (uint64_t& page : list) {
    const uint64_t number = in.varint(0, frames, "number of a page's frame");
    page = number == 0 ? kNoFrame : number - 1;
  }
  in.expect_end();
  return list;
}

void check_cell_frames(const Metadata& meta, const Channel& channel, const std::function<Bytes(uint64_t)>& frame,
                       const std::function<void(const ChunkKey&, const Bytes*)>& check) {
  const LevelShape s(meta, 0);
  const uint64_t lists = cell_lists(s.pages());
  if (channel.frames < lists) throw FormatError(fmt::format("channel '{}' lacks the lists of its pages (FORMAT.md 12.3)", channel.name));
  std::vector<bool> named(channel.frames);
  const auto name_once = [&](uint64_t number) {
    if (number >= named.size() || named[number])
      throw FormatError(fmt::format("channel '{}' frame {}: it is named twice, or is not there (FORMAT.md 12.4)", channel.name, number));
    named[number] = true;
  };
  for (uint64_t i = 0; i < lists; ++i) name_once(channel.frames - lists + i);
  for (uint64_t first = 0; first < s.pages(); first += kPagesPerList) {
    const auto list =
        decode_cell_list(frame(channel.frames - lists + first / kPagesPerList), std::min(kPagesPerList, s.pages() - first), channel.frames);
    for (uint64_t page = first; page < first + list.size(); ++page) {
      const uint64_t number = list[page - first];
      CellPage chunks(s.page_size(page), kNoFrame);
      if (number != kNoFrame) name_once(number), chunks = decode_cell_page(frame(number), s.page_size(page), number);
      for (uint32_t slot = 0; slot < chunks.size(); ++slot) {
        const ChunkKey key = s.key_of(page, slot);
        const bool has_frame = chunks[slot] != kNoFrame;
        if (has_frame) name_once(chunks[slot]);
        try {
          const Bytes bytes = has_frame ? frame(chunks[slot]) : Bytes();
          check(key, has_frame ? &bytes : nullptr);
        } catch (const FormatError& e) {
          const std::string which = has_frame ? fmt::format("frame {}", chunks[slot]) : "has no frame";
          throw FormatError(fmt::format("channel '{}' {}: {}: {}", channel.name, which, chunk_name(key), e.what()));
        }
      }
    }
  }
  if (const auto found = static_cast<uint64_t>(std::ranges::count(named, true)); found != channel.frames)
    throw FormatError(fmt::format("channel '{}' has {} frames, but its pages name {} (FORMAT.md 12.4)", channel.name, channel.frames, found));
}

std::optional<Bytes> CellFrames::put(const ChunkKey& key, uint64_t number, uint64_t next) {
  const uint64_t page = shape_.page_of(key);
  const auto [it, fresh] = open_.try_emplace(page);
  Open& open = it->second;
  if (fresh) open = {CellPage(shape_.page_size(page), kNotPut), shape_.page_size(page)};
  uint64_t& frame = open.chunks[shape_.slot_of(key, page)];
  if (frame != kNotPut || pages_[page] != kNotPut) throw FormatError(fmt::format("{}: a channel has it twice (FORMAT.md 12.1)", chunk_name(key)));
  frame = number;
  if (--open.missing > 0) return std::nullopt;
  const CellPage chunks = std::move(open.chunks);
  open_.erase(it);
  ++complete_;
  const bool empty = std::ranges::all_of(chunks, [](uint64_t f) { return f == kNoFrame; });
  pages_[page] = empty ? kNoFrame : next;
  if (empty) return Bytes();
  return encode_cell_page(chunks, next);
}

void CellFrames::put_page(uint64_t page, uint64_t number) {
  if (pages_[page] != kNotPut || open_.contains(page))
    throw FormatError(fmt::format("page {} of a channel: it is there twice (FORMAT.md 12.2)", page));
  pages_[page] = number;
  ++complete_;
}

std::vector<Bytes> CellFrames::lists() const {
  if (complete_ != pages_.size()) throw FormatError(fmt::format("a channel lacks chunks in {} pages (FORMAT.md 12.2)", pages_.size() - complete_));
  std::vector<Bytes> out;
  for (size_t first = 0; first < pages_.size(); first += kPagesPerList)
    out.push_back(encode_cell_list(std::span(pages_).subspan(first, std::min<size_t>(kPagesPerList, pages_.size() - first))));
  return out;
}

void CellFrames::save(Bytes& state) const {
  put_varint(state, complete_);
  for (const uint64_t frame : pages_) put_varint(state, frame - kNotPut);
  put_varint(state, open_.size());
  for (const auto& [page, open] : open_) {
    put_varint(state, page);
    put_varint(state, open.missing);
    for (const uint64_t frame : open.chunks) put_varint(state, frame - kNotPut);
  }
}

void CellFrames::restore(ByteReader& state) {
  complete_ = state.varint(0, pages_.size(), "complete pages");
  for (uint64_t& frame : pages_) frame = state.varint() + kNotPut;
  for (uint64_t left = state.varint(0, pages_.size(), "open pages"); left > 0; --left) {
    const uint64_t page = state.varint(0, pages_.size() - 1, "page");
    Open open{CellPage(shape_.page_size(page)), 0};
    open.missing = state.varint(1, open.chunks.size(), "missing chunks");
    for (uint64_t& frame : open.chunks) frame = state.varint() + kNotPut;
    open_[page] = std::move(open);
  }
}

}  // namespace teracell::store
