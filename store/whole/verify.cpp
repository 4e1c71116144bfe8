#include "store/whole/verify.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "store/base/in_order.hpp"
#include "store/format/cell_sums.hpp"
#include "store/format/checked_read.hpp"
#include "store/format/chunk_stats.hpp"
#include "store/text/text.hpp"

namespace teracell::inline store {
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

// The byte ranges that are accounted for. Files are written nearly in order, so few separate ranges are held. Only where
// rays are cut into segments it is one for each chunk, until its neighbours have come.
class Coverage {
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
  [[noreturn]] static void overlap(uint64_t offset) { throw FormatError(fmt::format("byte {} belongs to two things that the index names", offset)); }
  std::map<uint64_t, uint64_t> ranges_;  // start -> end
  uint64_t bytes_ = 0;
};

void check_content_hash(const GridReader& reader) {
  ContentHash hash;
  const auto add = [&](uint64_t offset, uint64_t size) { read_in_pieces(reader.source(), offset, size, [&](auto bytes) { hash.add(bytes); }); };
  const Footer& footer = reader.footer();
  for (const LevelInfo& l : reader.meta().levels()) add(l.directory, directory_bytes(reader.shape(l.level).pages()));
  for (const Channel& c : reader.meta().others()) add(c.cover, directory_bytes(c.frames));
  add(footer.metadata.offset, footer.metadata.size);
  add(footer.report.offset, footer.report.size);
  if (hash.digest() != footer.hash)
    throw FormatError(fmt::format("footer: expected content hash {}, found {}", hex(footer.hash), hex(hash.digest())));
}

void check_amounts(const Metadata& meta, const CellSums& found) {
  for (size_t l = 0; l < meta.amounts.size(); ++l) {
    const LabelAmount &told = meta.amounts[l], of_chunks = l < found.amounts.size() ? found.amounts[l] : LabelAmount();
    if (told == of_chunks) continue;
    const auto text = [](const LabelAmount& a) {
      return fmt::format("{} in the box [{}]", counted(a.cells, "cell"), fmt::join(a.box.corners(), ", "));
    };
    throw FormatError(fmt::format("label {}: the metadata says {}, found {} (FORMAT.md 7.12)", l, text(told), text(of_chunks)));
  }
}

struct ChunkSums {
  uint64_t changes = 0;
  LabelsSum labels;  // of level 0
};

// Throws unless the chunk is that of its entry and agrees with the level below it.
ChunkSums check_chunk(const GridReader& reader, const ChunkKey& key, const ChunkEntry& e, const LabelsAdder& adder) {
  Chunk chunk, expected;
  reader.read_stored(key, e, chunk);
  if (key.level > 0) {
    reader.derive(key, expected);
    if (!same_cells(chunk, expected)) throw FormatError(fmt::format("{}: its sets are not those of the level below", chunk_name(key)));
  } else if (e.size != 0 && e.stats != stats_of(chunk.rays)) {
    throw FormatError(fmt::format("{}: its statistics are not those of its cells", chunk_name(key)));
  }
  return {chunk.rays.at.size(), key.level == 0 ? adder.sum(key, chunk.rays) : LabelsSum()};
}

// Returns what the cells add up to, if it is level 0.
CellSums verify_level(const GridReader& reader, const LevelInfo& l, int threads, const LabelsAdder& adder, Coverage& coverage,
                      const std::function<void()>& tell_progress) {
  const LevelShape s = reader.shape(l.level);
  coverage.add(l.directory, directory_bytes(s.pages()));
  LevelInfo sum = {l.level, l.directory, 0, 0, 0};
  const RayFrame frame = reader.meta().frame();
  CellSums sums;
  for (uint64_t p = 0; p < s.pages(); ++p) {
    const DirectoryEntry place = reader.page_place(l.level, p);
    coverage.add(place.offset, place.size);
    const auto page = reader.page(l.level, p);
    uint32_t next_slot = 0;
    const auto next = [&]() -> std::optional<uint32_t> {
      if (next_slot == page->size()) return std::nullopt;
      return next_slot++;
    };
    const auto check = [&](uint32_t slot, int) { return std::pair{slot, check_chunk(reader, s.key_of(p, slot), (*page)[slot], adder)}; };
    in_order(threads, next, check, [&](std::pair<uint32_t, ChunkSums> done) {
      const ChunkEntry& e = (*page)[done.first];
      sums.labels += done.second.labels;
      if (l.level == 0) sums.add_amounts(s, frame, s.key_of(p, done.first), e);
      if (e.size == 0) return;
      coverage.add(e.offset, e.size);
      sum.chunks += 1;
      sum.bytes += e.size;
      sum.changes += done.second.changes;
    });
    tell_progress();
  }
  if (!(sum == l))
    throw FormatError(fmt::format("level {}: the metadata counts {} chunks, {} bytes, {} changes; found {}, {}, {}", l.level, l.chunks, l.bytes,
                                  l.changes, sum.chunks, sum.bytes, sum.changes));
  return sums;
}

// The frames of a channel other than the labels: first as bytes, however many, then as what the kind of the channel says.
void verify_frames(const GridReader& reader, const Channel& c, std::span<const ChannelKind> known, Coverage& coverage,
                   const std::function<void()>& tell_progress) {
  const auto name_of = [&](uint64_t i) { return fmt::format("channel '{}' frame {}", c.name, i); };
  coverage.add(c.cover, directory_bytes(c.frames));
  uint64_t bytes_of_all = 0;
  for (uint64_t i = 0; i < c.frames; ++i) {
    const std::string what = name_of(i);
    const DirectoryEntry place = reader.frame_place(c, i);
    check_inside(reader.source(), place, what);
    if (place.size == 0) throw FormatError(fmt::format("{}: a frame has bytes", what));
    coverage.add(place.offset, place.size);  // before it is read: otherwise frames that overlap could make this take very long
    RunningChecksum sum;
    read_in_pieces(reader.source(), place.offset, place.size, [&](auto bytes) { sum.add(bytes); });
    check_sum(place, what, sum.value());
    bytes_of_all += place.size;
    tell_progress();
  }
  if (c.bytes != 0 && c.bytes != bytes_of_all)
    throw FormatError(fmt::format("channel '{}': the metadata counts {} bytes of frames, found {}", c.name, c.bytes, bytes_of_all));
  const ChannelKind* kind = find_kind(known, c.name, c.coding);
  if (kind == nullptr || kind->check == nullptr) return;
  kind->check(reader, c, [&](uint64_t i) {
    Bytes bytes;
    read_checked(reader.source(), reader.frame_place(c, i), name_of(i), bytes);
    return bytes;
  });
}

}  // namespace

std::string verify(const GridReader& reader, int threads, const std::function<void(double)>& progress, std::span<const ChannelKind> known) {
  return naming(reader.name(), [&] {
    const uint64_t size = reader.file_bytes();
    const Footer& footer = reader.footer();
    Coverage coverage;
    coverage.add(0, kHeaderBytes);
    coverage.add(footer.metadata.offset, footer.metadata.size);
    coverage.add(footer.report.offset, footer.report.size);
    coverage.add(size - kFooterBytes, kFooterBytes);
    reader.report();  // with its JSON
    const auto tell_progress = [&] { progress(static_cast<double>(coverage.bytes()) / static_cast<double>(size)); };
    const LabelsAdder adder(reader.meta());
    CellSums sums;
    for (const LevelInfo& l : reader.meta().levels()) sums += verify_level(reader, l, threads, adder, coverage, tell_progress);
    for (const Channel& c : reader.meta().others()) verify_frames(reader, c, known, coverage, tell_progress);
    coverage.expect_whole(size);
    check_content_hash(reader);
    check_amounts(reader.meta(), sums);
    std::string hash = labels_hash(reader.meta(), sums.labels);
    if (const std::string& told = reader.meta().labels_hash; !told.empty() && told != hash)
      throw FormatError(fmt::format("the labels of all cells have the hash {}, the metadata says {} (FORMAT.md 7.11)", hash, told));
    return hash;
  });
}

namespace {

// Reads every chunk and page of a part, and the hash of its bytes.
class PartCheck : public PartTaker {
 public:
  explicit PartCheck(const PartReader& part) : part_(part) {}
  uint64_t run() {
    part_.replay(*this);
    part_.found();
    if (hash_.digest() != part_.hash()) throw FormatError(fmt::format("{}: damaged: expected other bytes, by their hash", part_.name()));
    return chunks_;
  }

  void bytes(uint64_t size) override {
    Bytes piece;
    for (uint64_t left = size; left > 0; left -= piece.size(), end_ += piece.size()) {
      piece.resize(std::min<uint64_t>(left, 1 << 20));
      part_.read(end_, piece);
      hash_.add(piece);
    }
  }
  void chunk(const ChunkKey& key, ChunkEntry&& entry, uint64_t) override {
    entry.offset = end_ - entry.size;
    check(key, entry);
  }
  void page(const LevelInfo& of, uint64_t page, uint64_t size, uint64_t expected) override {
    const LevelShape shape(meta_, of.level);
    const std::string what = fmt::format("level {} index page {}", of.level, page);
    const Bytes frame = read({end_ - size, size, expected}, what);
    LevelInfo found{of.level, 0, 0, 0, of.changes};
    const std::vector<ChunkEntry> entries = decode_page(frame, shape.page_size(page), of.level == 0, labels_, end_ - size);
    for (uint32_t slot = 0; slot < entries.size(); ++slot) {
      const ChunkEntry& e = entries[slot];
      check(shape.key_of(page, slot), e);
      if (e.size != 0) found.chunks += 1, found.bytes += e.size;
    }
    if (found != of) throw FormatError(fmt::format("{}: {}: expected {} chunks, found {}", part_.name(), what, of.chunks, found.chunks));
  }
  void cells(size_t channel, const ChunkKey&, uint64_t size, uint64_t checksum) override { frame(channel, size, checksum); }
  void frame(size_t channel, uint64_t size, uint64_t checksum) override {
    if (size != 0) read({end_ - size, size, checksum}, fmt::format("a frame of channel '{}'", meta_.channels[channel].name));
  }
  void cells_page(size_t channel, uint64_t, uint64_t size, uint64_t checksum) override { frame(channel, size, checksum); }
  void child(int, uint32_t, uint32_t, Chunk&&) override {}

 private:
  Bytes read(const DirectoryEntry& place, const std::string& what) const {
    if (place.offset > end_ || place.size > end_ - place.offset) throw FormatError(fmt::format("{}: {}: it lies outside", part_.name(), what));
    Bytes bytes(place.size);
    part_.read(place.offset, bytes);
    if (checksum(bytes) != place.checksum) throw FormatError(fmt::format("{}: {}: its checksum differs", part_.name(), what));
    return bytes;
  }
  void check(const ChunkKey& key, const ChunkEntry& e) {
    if (e.size == 0) return;
    const LevelShape shape(meta_, key.level);
    decoder_.decode(read({e.offset, e.size, e.checksum}, chunk_name(key)), shape.rays_u(key.cu), shape.rays_v(key.cv), shape.length(key.segment),
                    labels_, chunk_);
    ++chunks_;
  }

  const PartReader& part_;
  const Metadata& meta_ = part_.head().meta;
  const uint32_t labels_ = static_cast<uint32_t>(meta_.labels.size());
  ContentHash hash_;
  uint64_t end_ = 0;  // of the bytes that were told so far
  ChunkDecoder decoder_;
  Chunk chunk_;
  uint64_t chunks_ = 0;
};

}  // namespace

uint64_t verify(const PartReader& part) { return PartCheck(part).run(); }

}  // namespace teracell::store
