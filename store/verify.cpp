// The whole of a file held against FORMAT.md: every byte is read, named once, and agrees with what says something of it.
#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "store/in_order.hpp"
#include "store/pyramid.hpp"
#include "store/reader.hpp"
#include "store/stats.hpp"

namespace teracell {
namespace {

// Patterns are numbered in the order of the rays on both sides; only ids of sets may differ.
bool same_cells(const Chunk& a, const Chunk& b) {
  if (a.rays.at != b.rays.at || a.rays.pattern != b.rays.pattern || a.rays.patterns.size() != b.rays.patterns.size()) return false;
  for (uint32_t p = 0; p < a.rays.patterns.size(); ++p)
    if (!std::ranges::equal(a.rays.patterns.sets(p), b.rays.patterns.sets(p),
                            [&](SetId x, SetId y) { return a.sets.members(x) == b.sets.members(y); }))
      return false;
  return true;
}

}  // namespace

// Byte ranges that were accounted for. Files are written nearly in order, so few separate ranges are held, except
// where chunks are segments of rays: then one for each chunk until its neighbours have come.
class GridReader::Coverage {
 public:
  void add(uint64_t offset, uint64_t size) {
    if (size == 0) return;
    bytes_ += size;
    auto after = ranges_.upper_bound(offset);
    if (after != ranges_.begin() && std::prev(after)->second > offset) overlap(offset);
    if (after != ranges_.end() && after->first < offset + size) overlap(offset);
    uint64_t end = offset + size;
    if (after != ranges_.end() && after->first == end) end = after->second, after = ranges_.erase(after);
    if (after != ranges_.begin() && std::prev(after)->second == offset) std::prev(after)->second = end;
    else ranges_[offset] = end;
  }
  uint64_t bytes() const { return bytes_; }
  void expect_whole(uint64_t size) const {
    const uint64_t gap = ranges_.begin()->first != 0 ? 0 : ranges_.begin()->second;
    if (ranges_.size() != 1 || gap != size) throw FormatError(fmt::format("byte {} belongs to nothing that the index names", gap));
  }

 private:
  [[noreturn]] static void overlap(uint64_t offset) {
    throw FormatError(fmt::format("byte {} belongs to two things that the index names", offset));
  }
  std::map<uint64_t, uint64_t> ranges_;  // start -> end
  uint64_t bytes_ = 0;
};

void GridReader::read_in_pieces(uint64_t offset, uint64_t size, const std::function<void(std::span<const uint8_t>)>& f) const {
  Bytes bytes;
  for (uint64_t done = 0; done < size; done += bytes.size()) {
    bytes.resize(std::min<uint64_t>(size - done, 1 << 20));
    source_->read(offset + done, bytes);
    f(bytes);
  }
}

void GridReader::check_content_hash() const {
  ContentHash hash;
  const auto add = [&](uint64_t offset, uint64_t size) { read_in_pieces(offset, size, [&](auto bytes) { hash.add(bytes); }); };
  for (const LevelInfo& l : meta_.levels) add(l.directory, directory_bytes(shape(l.level).pages()));
  for (const OtherChannel& c : meta_.others) add(c.cover, directory_bytes(c.frames));
  add(footer_.metadata.offset, footer_.metadata.size);
  add(footer_.report.offset, footer_.report.size);
  if (hash.digest() != footer_.hash)
    throw FormatError(fmt::format("footer: expected content hash {}, found {}", hex(footer_.hash), hex(hash.digest())));
}

void GridReader::verify_level(const LevelInfo& l, int threads, Coverage& coverage, const std::function<void()>& progress) const {
  const LevelShape s = shape(l.level);
  coverage.add(l.directory, directory_bytes(s.pages()));
  LevelInfo sum = {l.level, l.directory, 0, 0, 0};
  for (uint64_t p = 0; p < s.pages(); ++p) {
    const DirectoryEntry place = page_place(l.level, p);
    coverage.add(place.offset, place.size);
    const auto part = page(l.level, p);
    const std::vector<ChunkEntry>& entries = part->page;
    uint32_t next_slot = 0;
    const auto next = [&]() -> std::optional<uint32_t> {
      if (next_slot == entries.size()) return std::nullopt;
      return next_slot++;
    };
    const auto check = [&](uint32_t slot, int) -> std::pair<uint32_t, uint64_t> {
      const ChunkEntry& e = entries[slot];
      const uint32_t cu = static_cast<uint32_t>(p % s.pages_u) * s.page_chunks + slot % s.page_width(p);
      const uint32_t cv = static_cast<uint32_t>(p / s.pages_u % s.pages_v) * s.page_chunks + slot / s.page_width(p);
      const auto segment = static_cast<uint32_t>(p / s.pages_u / s.pages_v);
      Chunk chunk, expected;
      read_stored(l.level, cu, cv, segment, e, chunk);
      if (l.level > 0) {
        derive(l.level, cu, cv, segment, expected);
        if (!same_cells(chunk, expected))
          throw FormatError(fmt::format("{}: its sets are not those of the level below", chunk_name(l.level, cu, cv, segment)));
      } else if (e.size != 0 && e.stats != stats_of(chunk.rays)) {
        throw FormatError(fmt::format("{}: its statistics are not those of its cells", chunk_name(l.level, cu, cv, segment)));
      }
      return {slot, chunk.rays.at.size()};
    };
    in_order(threads, next, check, [&](std::pair<uint32_t, uint64_t> done) {
      const ChunkEntry& e = entries[done.first];
      if (e.size == 0) return;
      coverage.add(e.offset, e.size);
      sum.chunks += 1;
      sum.bytes += e.size;
      sum.changes += done.second;
    });
    progress();
  }
  if (!(sum == l))
    throw FormatError(fmt::format("level {}: the metadata counts {} chunks, {} bytes, {} changes; found {}, {}, {}", l.level, l.chunks, l.bytes,
                                  l.changes, sum.chunks, sum.bytes, sum.changes));
}

// What the frames mean is for those who know the channel: here they are bytes, however many.
void GridReader::verify_cover(const OtherChannel& c, Coverage& coverage, const std::function<void()>& progress) const {
  coverage.add(c.cover, directory_bytes(c.frames));
  for (uint64_t i = 0; i < c.frames; ++i) {
    const std::string what = fmt::format("channel '{}' frame {}", c.name, i);
    const DirectoryEntry place = directory_entry(c.cover, c.frames, i);
    check_inside(place, what);
    if (place.size == 0) throw FormatError(fmt::format("{}: a frame has bytes", what));
    coverage.add(place.offset, place.size);  // before it is read: frames on top of each other must not buy time
    RunningChecksum sum;
    read_in_pieces(place.offset, place.size, [&](auto bytes) { sum.add(bytes); });
    check_sum(place, what, sum.value());
    progress();
  }
}

void GridReader::verify(int threads, const std::function<void(double)>& progress) const {
  try {
    Coverage coverage;
    coverage.add(0, kHeaderBytes);
    coverage.add(footer_.metadata.offset, footer_.metadata.size);
    coverage.add(footer_.report.offset, footer_.report.size);
    coverage.add(source_->size() - kFooterBytes, kFooterBytes);
    report();
    const auto tell = [&] { progress(static_cast<double>(coverage.bytes()) / static_cast<double>(source_->size())); };
    for (const LevelInfo& l : meta_.levels) verify_level(l, threads, coverage, tell);
    for (const OtherChannel& c : meta_.others) verify_cover(c, coverage, tell);
    coverage.expect_whole(source_->size());
    check_content_hash();
  } catch (const FormatError& e) {
    const std::string message = e.what();
    throw FormatError(message.starts_with(name()) ? message : fmt::format("{}: {}", name(), message));
  }
}

}  // namespace teracell
