#include "store/writer.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <xxhash.h>

namespace teracell {

// Cells and box of every label. Rays of equal pattern are summed run by run before a label is looked at.
std::vector<LabelStats> stats_of(const RayBlock& b) {
  std::map<Label, LabelStats> all;
  const auto add = [&](Label label, uint64_t cells, std::array<uint32_t, 3> lo, std::array<uint32_t, 3> hi) {
    const auto [it, fresh] = all.try_emplace(label, LabelStats{label, 0, lo, hi});
    it->second.cells += cells;
    for (int d = 0; d < 3; ++d) {
      it->second.lo[d] = std::min(it->second.lo[d], lo[d]);
      it->second.hi[d] = std::max(it->second.hi[d], hi[d]);
    }
  };
  std::vector<uint64_t> sum;
  std::vector<uint32_t> least, most;
  for (uint32_t v = 0; v < b.nv; ++v) {
    for (uint32_t u = 0; u < b.nu;) {  // a stretch of one pattern
      const uint32_t first = v * b.nu + u, pattern = b.pattern[first], n = b.patterns.changes(pattern);
      uint32_t end = u;
      sum.assign(n, 0), least.assign(n, ~0u), most.assign(n, 0);
      for (; end < b.nu && b.pattern[v * b.nu + end] == pattern; ++end) {
        const uint32_t* at = b.at.data() + b.begin[v * b.nu + end];
        for (uint32_t i = 0; i < n; ++i) {
          sum[i] += at[i];
          least[i] = std::min(least[i], at[i]);
          most[i] = std::max(most[i], at[i]);
        }
      }
      const auto sets = b.patterns.sets(pattern);
      for (uint32_t i = 0; i <= n; ++i) {
        const uint64_t until = i < n ? sum[i] : uint64_t{b.length} * (end - u), from = i > 0 ? sum[i - 1] : 0;
        add(sets[i], until - from, {u, v, i > 0 ? least[i - 1] : 0}, {end, v + 1, i < n ? most[i] : b.length});
      }
      u = end;
    }
  }
  std::vector<LabelStats> out;
  for (const auto& [label, stats] : all) out.push_back(stats);
  return out;
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
  XXH3_state_t* hash = XXH3_createState();
  XXH3_128bits_reset(hash);
  const auto append_hashed = [&](const Bytes& frame) {
    XXH3_128bits_update(hash, frame.data(), frame.size());
    return append(frame);
  };
  meta_.levels.clear();
  meta_.crossings = crossings;
  for (Level& l : levels_) {
    if (directory_bytes(l.directory.size()) > ~uint32_t{0}) throw Error(fmt::format("level {} has too many chunks for its directory", l.info.level));
    l.info.directory = append_hashed(encode_directory(l.directory)).offset;
    meta_.levels.push_back(l.info);
  }
  Footer footer;
  footer.metadata = append_hashed(encode_metadata(meta_));
  footer.report = append_hashed(encode_text(report));
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(hash));
  XXH3_freeState(hash);
  std::copy(canonical.digest, canonical.digest + 16, footer.hash.begin());
  footer.file_bytes = file_.size() + kFooterBytes;
  file_.append(encode_footer(footer));
  file_.commit();
}

}  // namespace teracell
