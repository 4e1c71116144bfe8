#include "store/whole/pack.hpp"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "store/base/in_order.hpp"
#include "store/format/cell_sums.hpp"
#include "store/format/checked_read.hpp"
#include "store/format/metadata_json.hpp"
#include "store/write/writer.hpp"

namespace teracell::inline store {
namespace {

// Calls f(u, v) for 0 <= u < nu, 0 <= v < nv in Morton order.
template <class F>
void for_each_in_morton_order(uint32_t nu, uint32_t nv, F&& f) {
  const uint32_t side = std::bit_ceil(std::max(nu, nv));
  const auto visit = [&](const auto& self, uint32_t u, uint32_t v, uint32_t size) -> void {
    if (u >= nu || v >= nv) return;
    if (size == 1) return f(u, v);
    const uint32_t half = size / 2;
    self(self, u, v, half), self(self, u + half, v, half), self(self, u, v + half, half), self(self, u + half, v + half, half);
  };
  visit(visit, 0, 0, side);
}

class Packer {
 public:
  Packer(const GridReader& reader, const std::filesystem::path& path, const PackOptions& options, const std::function<void(double)>& progress)
      : reader_(reader), meta_(reader.meta()), options_(options), progress_(progress), file_(path) {
    std::erase_if(meta_.levels(), [](const LevelInfo& l) { return l.level == 1; });
  }

  void run() {
    file_.append(encode_header());
    std::vector<std::vector<DirectoryEntry>> covers, directories;
    for (const Channel& c : reader_.meta().others()) covers.push_back(copy_frames(c));
    std::vector<std::vector<uint64_t>> begins;  // of the first chunk of each page, by level
    for (const LevelInfo& l : meta_.levels()) begins.push_back(copy_chunks(l.level));
    std::vector<DirectoryEntry> of_level_1;
    LevelInfo level_1{1, 0, 0, 0, 0};
    if (options_.with_level_1 && meta_.grid.levels() > 1) of_level_1 = make_level_1(level_1);
    for (size_t i = 0; i < begins.size(); ++i) directories.push_back(write_pages(meta_.levels()[i].level, begins[i]));
    if (!of_level_1.empty()) {
      meta_.levels().insert(meta_.levels().begin() + 1, level_1);
      directories.insert(directories.begin() + 1, std::move(of_level_1));
    }
    ContentHash hash;
    const auto append_hashed = [&](const Bytes& frame) {
      hash.add(frame);
      return append(frame);
    };
    for (size_t i = 0; i < directories.size(); ++i) meta_.levels()[i].directory = append_hashed(encode_directory(directories[i])).offset;
    for (size_t i = 0; i < covers.size(); ++i) meta_.channels[i + 1].cover = append_hashed(encode_directory(covers[i])).offset;
    Footer footer;
    footer.metadata = append_hashed(encode_metadata(meta_));
    footer.report = append_hashed(read(reader_.footer().report, "report"));
    footer.hash = hash.digest();
    footer.file_bytes = file_.size() + kFooterBytes;
    file_.append(encode_footer(footer));
    file_.commit();
  }

 private:
  DirectoryEntry append(std::span<const uint8_t> frame) {
    const DirectoryEntry place{file_.size(), frame.size(), checksum(frame)};
    file_.append(frame);
    return place;
  }

  const Bytes& read(const DirectoryEntry& place, const std::string& what) {
    read_checked(reader_.source(), place, what, bytes_);
    return bytes_;
  }

  // What is copied has at most as many bytes as the file, unless frames overlap.
  void count(uint64_t bytes) {
    copied_ += bytes;
    if (copied_ > reader_.file_bytes()) throw FormatError("its chunks have more bytes than the file: frames overlap");
    progress_(static_cast<double>(copied_) / static_cast<double>(reader_.file_bytes()));
  }

  std::vector<DirectoryEntry> copy_frames(const Channel& c) {
    std::vector<DirectoryEntry> cover;
    for (uint64_t i = 0; i < c.frames; ++i) {
      const std::string what = fmt::format("channel '{}' frame {}", c.name, i);
      const DirectoryEntry from = reader_.frame_place(c, i);
      check_inside(reader_.source(), from, what);
      count(from.size);
      const DirectoryEntry to{file_.size(), from.size, from.checksum};
      RunningChecksum sum;
      read_in_pieces(reader_.source(), from.offset, from.size, [&](auto bytes) {
        sum.add(bytes);
        file_.append(bytes);
      });
      check_sum(from, what, sum.value());
      cover.push_back(to);
    }
    return cover;
  }

  template <class F>
  static void for_each_page(const LevelShape& s, F&& f) {
    for (uint32_t segment = 0; segment < s.segments; ++segment)
      for_each_in_morton_order(s.pages_u, s.pages_v, [&](uint32_t pu, uint32_t pv) { f((uint64_t{segment} * s.pages_v + pv) * s.pages_u + pu); });
  }

  // Calls f(slot) for the chunks of a page, in the order in which they lie in the file.
  template <class F>
  static void for_each_slot(const LevelShape& s, uint64_t page, F&& f) {
    for_each_in_morton_order(s.page_width(page), s.page_height(page), [&](uint32_t u, uint32_t v) { f(v * s.page_width(page) + u); });
  }

  // Returns where the chunks of each page begin.
  std::vector<uint64_t> copy_chunks(int level) {
    const LevelShape s = reader_.shape(level);
    std::vector<uint64_t> begins(s.pages());
    for_each_page(s, [&](uint64_t page) {
      begins[page] = file_.size();
      const auto entries = reader_.page(level, page);
      std::vector<ByteRange> soon;
      for (const ChunkEntry& e : *entries)
        if (e.size != 0) soon.push_back({e.offset, e.size});
      reader_.source().prefetch(soon);
      for_each_slot(s, page, [&](uint32_t slot) {
        const ChunkEntry& e = (*entries)[slot];
        if (e.size == 0) return;
        count(e.size);
        file_.append(read({e.offset, e.size, e.checksum}, chunk_name(s.key_of(page, slot))));
      });
    });
    return begins;
  }

  // Nobody has to derive level 1, then, from four times as many chunks. It is made anew in any case, so a packed file packs to itself.
  // Each page stands behind its chunks: there is no memory for all entries until the other pages are written.
  std::vector<DirectoryEntry> make_level_1(LevelInfo& info) {
    struct Made {
      uint64_t page;
      std::vector<EncodedChunk> chunks;  // by slot
    };
    const LevelShape s(meta_, 1);
    std::vector<uint64_t> pages;
    for_each_page(s, [&](uint64_t page) { pages.push_back(page); });
    std::vector<DirectoryEntry> directory(s.pages());
    std::vector<ChunkEncoder> encoders(static_cast<size_t>(options_.threads));
    auto next = pages.begin();
    in_order(
        options_.threads, [&]() { return next == pages.end() ? std::nullopt : std::optional(*next++); },
        [&](uint64_t page, int thread) {
          Made made{page, std::vector<EncodedChunk>(s.page_size(page))};
          Chunk chunk;
          for (uint32_t slot = 0; slot < made.chunks.size(); ++slot) {
            reader_.derive(s.key_of(page, slot), chunk);
            made.chunks[slot] = encode_chunk(encoders[static_cast<size_t>(thread)], chunk.rays, chunk.sets, false);
          }
          return made;
        },
        [&](Made made) {
          std::vector<ChunkEntry> entries(made.chunks.size());
          for_each_slot(s, made.page, [&](uint32_t slot) {
            const EncodedChunk& chunk = made.chunks[slot];
            entries[slot] = chunk.entry;
            entries[slot].offset = file_.size();
            file_.append(chunk.frame);
            if (!chunk.frame.empty()) info.add(1, chunk.frame.size(), chunk.changes);
          });
          directory[made.page] = append(encode_page(entries, false, file_.size()));
          progress_(static_cast<double>(copied_) / static_cast<double>(reader_.file_bytes()));
        });
    return directory;
  }

  // Of a file of before 3.1 they also tell how many cells each label has.
  std::vector<DirectoryEntry> write_pages(int level, const std::vector<uint64_t>& begins) {
    const LevelShape s = reader_.shape(level);
    const bool adds_amounts = level == 0 && meta_.amounts.empty() && has_room_for_amounts(meta_);
    CellSums sums;
    std::vector<DirectoryEntry> directory(s.pages());
    for_each_page(s, [&](uint64_t page) {
      std::vector<ChunkEntry> entries = *reader_.page(level, page);
      if (adds_amounts)
        for (uint32_t slot = 0; slot < entries.size(); ++slot) sums.add_amounts(s, meta_.frame(), s.key_of(page, slot), entries[slot]);
      uint64_t offset = begins[page];
      for_each_slot(s, page, [&](uint32_t slot) {
        ChunkEntry& e = entries[slot];
        if (e.size == 0) return;
        e.offset = offset;
        offset += e.size;
      });
      directory[page] = append(encode_page(entries, level == 0, file_.size()));
      progress_(static_cast<double>(copied_) / static_cast<double>(reader_.file_bytes()));
    });
    if (adds_amounts) {
      meta_.amounts = std::move(sums.amounts);
      meta_.amounts.resize(meta_.labels.size());
      if (!amounts_fit(meta_)) throw FormatError("the statistics of its chunks don't add up to the cells of the grid (FORMAT.md 10.3)");
    }
    return directory;
  }

  const GridReader& reader_;
  Metadata meta_;
  const PackOptions options_;
  const std::function<void(double)>& progress_;
  OutputFile file_;
  uint64_t copied_ = 0;
  Bytes bytes_;
};

}  // namespace

void pack(const GridReader& reader, const std::filesystem::path& path, const PackOptions& options, const std::function<void(double)>& progress) {
  naming(reader.name(), [&] { Packer(reader, path, options, progress).run(); });
}

}  // namespace teracell::store
