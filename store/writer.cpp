#include "store/writer.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace teracell {

// Rays of equal pattern are summed change by change before a label is looked at.
std::vector<LabelStats> stats_of(const RayBlock& b) {
  std::vector<LabelStats> all;
  const auto add = [&](Label label, uint64_t cells, std::array<uint32_t, 3> lo, std::array<uint32_t, 3> hi) {
    auto it = std::ranges::find(all, label, &LabelStats::label);
    if (it == all.end()) it = all.insert(it, LabelStats{label, 0, lo, hi});
    it->cells += cells;
    for (int d = 0; d < 3; ++d) {
      it->lo[d] = std::min(it->lo[d], lo[d]);
      it->hi[d] = std::max(it->hi[d], hi[d]);
    }
  };
  for (uint32_t v = 0; v < b.nv; ++v) {
    for (uint32_t u = 0; u < b.nu;) {  // a stretch of one pattern
      const uint32_t first = v * b.nu + u, pattern = b.pattern[first], n = b.patterns.changes(pattern);
      uint32_t end = u + 1;
      while (end < b.nu && b.pattern[v * b.nu + end] == pattern) ++end;
      const auto sets = b.patterns.sets(pattern);
      const uint32_t *at = b.at.data() + b.begin[first], *stop = at + size_t{n} * (end - u);
      uint64_t from_sum = 0;
      uint32_t from_least = 0;
      for (uint32_t i = 0; i < n; ++i) {
        uint64_t sum = 0;
        uint32_t least = ~0u, most = 0;
        for (const uint32_t* x = at + i; x < stop; x += n) {
          sum += *x;
          least = std::min(least, *x);
          most = std::max(most, *x);
        }
        add(sets[i], sum - from_sum, {u, v, from_least}, {end, v + 1, most});
        from_sum = sum;
        from_least = least;
      }
      add(sets[n], uint64_t{b.length} * (end - u) - from_sum, {u, v, from_least}, {end, v + 1, b.length});
      u = end;
    }
  }
  std::ranges::sort(all, {}, &LabelStats::label);
  return all;
}

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

GridWriter::GridWriter(const std::filesystem::path& path, Metadata meta) : meta_(std::move(meta)), file_(path) {
  for (int level = 0; level < meta_.grid.levels(); level += 2) {
    Level l{{level, 0, 0, 0, 0}, LevelShape(meta_, level), {}, {}};
    // The directory is one skippable frame; two factors at a time, the product of three could overflow.
    const LevelShape& s = l.shape;
    constexpr uint64_t kMaxPages = (~uint32_t{0} - 8) / (kDirectoryEntry + 1);
    if (uint64_t{s.pages_u} * s.pages_v > kMaxPages || s.pages() > kMaxPages)
      throw UsageError(fmt::format("{} x {} rays are more than a file can index: take fewer cells across {}, or rays along the longest axes", s.nu, s.nv,
                                   axis_name(meta_.ray_axis)));
    l.directory.resize(l.shape.pages());
    levels_.push_back(std::move(l));
  }
  file_.append(encode_header());
}

DirectoryEntry GridWriter::append(std::span<const uint8_t> frame) {
  const DirectoryEntry place{file_.size(), frame.size(), checksum(frame)};
  file_.append(frame);
  return place;
}

void GridWriter::put(int level, uint32_t cu, uint32_t cv, uint32_t segment, const EncodedChunk& chunk) {
  Level& l = levels_[level / 2];
  const uint64_t page = l.shape.page_of(cu, cv, segment);
  const auto [it, fresh] = l.open.try_emplace(page);
  OpenPage& open = it->second;
  if (fresh) {
    open.missing = size_t{l.shape.page_width(page)} * l.shape.page_height(page);
    open.entries.resize(open.missing);
  }
  ChunkEntry& entry = open.entries[l.shape.slot_of(cu, cv, page)];
  entry = chunk.entry;
  if (entry.size != 0) {
    entry.offset = file_.size();
    file_.append(chunk.frame);
    l.info.chunks += 1;
    l.info.bytes += entry.size;
    l.info.changes += chunk.changes;
  }
  if (--open.missing == 0) {
    l.directory[page] = append(encode_page(open.entries, level == 0));
    l.open.erase(it);
  }
}

void GridWriter::finish(const std::string& report, uint64_t crossings) {
  ContentHash hash;
  const auto append_hashed = [&](const Bytes& frame) {
    hash.add(frame);
    return append(frame);
  };
  for (const Level& l : levels_)
    if (!l.open.empty()) throw Error(fmt::format("level {} lacks chunks", l.info.level));
  meta_.levels.clear();
  meta_.crossings = crossings;
  for (Level& l : levels_) {
    l.info.directory = append_hashed(encode_directory(l.directory)).offset;
    meta_.levels.push_back(l.info);
  }
  Footer footer;
  footer.metadata = append_hashed(encode_metadata(meta_));
  footer.report = append_hashed(encode_text(report));
  footer.hash = hash.digest();
  footer.file_bytes = file_.size() + kFooterBytes;
  file_.append(encode_footer(footer));
  file_.commit();
}

}  // namespace teracell
