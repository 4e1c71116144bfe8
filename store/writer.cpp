#include "store/writer.hpp"

#include <fmt/format.h>

#include "store/stats.hpp"

namespace teracell {

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
