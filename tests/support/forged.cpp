#include "tests/support/forged.hpp"

#include <algorithm>

#include <xxhash.h>

#include "store/base/zstd_frame.hpp"
#include "store/format/metadata_json.hpp"
#include "tests/support/stored.hpp"

namespace teracell::testing {
namespace {

class Forger {
 public:
  Forger(const Bytes& file, const Lies& lies) : file_(file), lies_(lies), reader_(reader_of(file)), meta_(reader_.meta()) {}

  Bytes forge() {
    out_ = signed_again(FilePart::kHeader, encode_header(), kHeaderBytes - 8);
    out_.resize(out_.size() + lies_.gap);
    for (LevelInfo& level : meta_.levels()) directories_.push_back(level_pages(level));
    std::vector<std::vector<DirectoryEntry>> covers;
    for (const ForgedChannel& channel : lies_.channels) {
      covers.emplace_back();
      for (const Bytes& frame : channel.frames) covers.back().push_back(append(frame));
    }
    Bytes hashed;
    const auto append_directory = [&](const std::vector<DirectoryEntry>& places) {
      const Bytes frame = directory(places);
      hashed.insert(hashed.end(), frame.begin(), frame.end());
      return append(frame).offset;
    };
    for (size_t i = 0; i < meta_.levels().size(); ++i) {
      if (lies_.directory) lies_.directory(meta_.levels()[i].level, directories_[i]);
      meta_.levels()[i].directory = append_directory(directories_[i]);
    }
    for (size_t i = 0; i < covers.size(); ++i) {
      const ForgedChannel& channel = lies_.channels[i];
      if (lies_.cover) lies_.cover(channel.name, covers[i]);
      meta_.channels.push_back({channel.name, channel.coding, false, {}, append_directory(covers[i]), covers[i].size(), channel.about});
    }
    const Grid grid = meta_.grid;
    if (lies_.metadata) lies_.metadata(meta_);
    if (!(meta_.grid == grid) || meta_.amounts.size() != meta_.labels.size()) meta_.amounts.clear();  // which would give such a lie away
    Footer footer;
    const auto text = [&](FilePart part, const Bytes& honest) {
      const Bytes frame = squeezed_again(part, honest);
      hashed.insert(hashed.end(), frame.begin(), frame.end());
      return append(frame);
    };
    footer.metadata = text(FilePart::kMetadata, encode_metadata(meta_));
    footer.report = text(FilePart::kReport, encode_text(reader_.report()));
    XXH128_canonical_t hash;
    XXH128_canonicalFromHash(&hash, XXH3_128bits(hashed.data(), hashed.size()));
    std::copy(hash.digest, hash.digest + 16, footer.hash.begin());
    footer.file_bytes = out_.size() + kFooterBytes;
    if (lies_.footer) lies_.footer(footer);
    append(signed_again(FilePart::kFooter, encode_footer(footer), kFooterBytes - 16));
    return out_;
  }

 private:
  DirectoryEntry append(const Bytes& bytes) {
    const DirectoryEntry place{out_.size(), bytes.size(), checksum(bytes)};
    out_.insert(out_.end(), bytes.begin(), bytes.end());
    return place;
  }

  // A structure whose checksum stands right behind its first `covered` bytes.
  Bytes signed_again(FilePart part, Bytes whole, size_t covered) const {
    Bytes front(whole.begin(), whole.begin() + static_cast<ptrdiff_t>(covered));
    if (lies_.bytes) lies_.bytes(part, front);
    front.resize(covered);
    put_fixed(front, checksum(front));
    front.insert(front.end(), whole.begin() + static_cast<ptrdiff_t>(covered) + 8, whole.end());
    return front;
  }

  Bytes squeezed_again(FilePart part, const Bytes& frame) const {
    if (!lies_.bytes) return frame;
    const std::string honest = decode_text(frame, "honest");
    Bytes body(honest.begin(), honest.end());
    lies_.bytes(part, body);
    const std::string forged(body.begin(), body.end());
    // As small as zstd makes it, whatever the format's bounds are.
    return forged == honest ? frame : ZstdEncoder().encode(body, 6);
  }

  // The level's chunks and pages, one page after another; where the pages are.
  std::vector<DirectoryEntry> level_pages(LevelInfo& info) {
    const LevelShape s(reader_.meta(), info.level);
    std::vector<DirectoryEntry> places;
    info.bytes = 0;
    for (uint64_t page = 0; page < s.pages(); ++page) {
      std::vector<ChunkEntry> entries;
      for (uint32_t slot = 0; slot < s.page_size(page); ++slot) {
        ChunkEntry e = *reader_.entry(s.key_of(page, slot));
        if (e.size != 0) {
          const auto first = file_.begin() + static_cast<ptrdiff_t>(e.offset);
          const DirectoryEntry place = append(squeezed_again(FilePart::kChunk, Bytes(first, first + e.size)));
          e.offset = place.offset, e.size = static_cast<uint32_t>(place.size), e.checksum = place.checksum;
          info.bytes += e.size;
        }
        entries.push_back(std::move(e));
      }
      if (lies_.page) lies_.page(info.level, entries);
      places.push_back(append(squeezed_again(FilePart::kPage, encode_page(entries, info.level == 0, out_.size()))));
    }
    return places;
  }

  Bytes directory(const std::vector<DirectoryEntry>& places) const {
    const Bytes honest = encode_directory(places);
    Bytes out(honest.begin(), honest.begin() + 8);
    for (uint64_t block = 0; block * kBlockEntries < places.size(); ++block) {
      const BlockPlace place = directory_block(block, places.size());
      const auto first = honest.begin() + static_cast<ptrdiff_t>(place.offset);
      const Bytes again = signed_again(FilePart::kDirectory, Bytes(first, first + static_cast<ptrdiff_t>(place.bytes())), place.bytes() - 8);
      out.insert(out.end(), again.begin(), again.end());
    }
    return out;
  }

  const Bytes& file_;
  const Lies& lies_;
  const GridReader reader_;
  Metadata meta_;
  std::vector<std::vector<DirectoryEntry>> directories_;
  Bytes out_;
};

}  // namespace

Bytes forge(const Bytes& file, const Lies& lies) { return Forger(file, lies).forge(); }

MixedFrame mixed_frame(std::span<const uint8_t> frame) {
  const std::span<const uint8_t> inner = frame.subspan(8);
  const size_t size = zstd_frame_size(inner);
  return {decode_text(inner.first(size), "mixed cells"), {inner.begin() + static_cast<ptrdiff_t>(size), inner.end()}};
}

Bytes forge(const MixedFrame& parts) {
  const Bytes body = encode_text(parts.body);
  Bytes out;
  put_fixed<uint32_t>(out, kSkippableMagic);
  put_fixed<uint32_t>(out, static_cast<uint32_t>(body.size() + parts.counts.size()));
  out.insert(out.end(), body.begin(), body.end());
  out.insert(out.end(), parts.counts.begin(), parts.counts.end());
  return out;
}

Bytes old_mixed_frame(const MixedCells& cells) {
  Bytes body, begins, lengths, sets, low, high;
  put_varint(body, cells.sets.size());
  for (uint32_t i = 0; i < cells.sets.size(); ++i) put_set(body, {cells.sets[i].begin(), cells.sets[i].end()});
  int64_t first = 0;
  for (uint32_t ray = 0; ray < cells.nu * cells.nv; ++ray) {
    std::vector<MixedCells::Run> runs;
    for (const MixedCells::Run& run : cells.of_ray(ray)) runs.push_back(run);
    put_varint(body, runs.size());
    for (size_t i = 0; i < runs.size(); ++i) {
      const int64_t step = i == 0 ? runs[i].from - first : runs[i].from - runs[i - 1].to;
      put_varint(begins, i > 0 ? static_cast<uint64_t>(step) : static_cast<uint64_t>(step < 0 ? -2 * step - 1 : 2 * step));
      put_varint(lengths, runs[i].to - runs[i].from - 1);
      if (cells.sets.size() > 1) put_varint(sets, runs[i].set);
      for (size_t k = 0; k + 1 < cells.labels(runs[i]).size(); ++k) {
        low.push_back(static_cast<uint8_t>(cells.counts_of(runs[i])[k] - 1));
        if (cells.total > 256) high.push_back(static_cast<uint8_t>((cells.counts_of(runs[i])[k] - 1) >> 8));
      }
    }
    if (!runs.empty()) first = runs[0].from;
  }
  for (const Bytes& part : {begins, lengths, sets, low, high}) body.insert(body.end(), part.begin(), part.end());
  return encode_text({body.begin(), body.end()});
}

}  // namespace teracell::testing
