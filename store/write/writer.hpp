// Writes a .tcell file: chunks, and frames of other channels, as they come; pages when their last chunk is there; the rest at the end.
// Memory: the open pages, and 24 bytes of directory per page and per frame of another channel.
#pragma once
#include <filesystem>

#include "store/format/cell_frames.hpp"
#include "store/format/cell_sums.hpp"
#include "store/format/open_pages.hpp"
#include "store/write/chunk_sink.hpp"
#include "store/write/grid_bytes.hpp"

namespace teracell::inline store {

// Not thread-safe. The file's bytes depend on the order of put().
class GridWriter : public ChunkSink {
 public:
  // Expects the chunks of level 0 and of all levels from 2 on, whatever `meta` says of levels, and at least one frame of every other
  // channel of `meta`, whatever it says of their covers.
  GridWriter(const std::filesystem::path& path, Metadata meta);
  // Goes on where save() of a writer for the same path and metadata left off; `state` is read as far as save() wrote it.
  // Throws FormatError when the partial file is not what it was then.
  GridWriter(const std::filesystem::path& path, Metadata meta, ByteReader& state);

  const Metadata& meta() const override { return meta_; }
  void put(const ChunkKey& key, const EncodedChunk& chunk) override;
  void put_child(int level, uint32_t cu, uint32_t cv, const Chunk& coarsened) override;  // never: the file has all
  void put_cells(size_t channel, const ChunkKey& key, std::span<const uint8_t> frame) override;
  // ---- What was made elsewhere, for merging. The bytes come first, then what they are. REQUIRES: no save().
  void put_bytes(std::span<const uint8_t> bytes) { bytes_.file().append(bytes); }
  // The same where another process writes these bytes, before finish() (FileRoom in output_file.hpp).
  void skip(uint64_t bytes) { bytes_.file().skip(bytes); }
  // The chunk whose frame, if it has one, the last bytes are.
  void put_entry(const ChunkKey& key, ChunkEntry entry, uint64_t changes);
  // A page that is complete: its frame, of which the last bytes are, and what its chunks add up to.
  void put_page(const LevelInfo& chunks, uint64_t page, uint64_t size, uint64_t checksum);
  // The same for another channel: the frame of a chunk, if `size` is not 0; of a chunk whose page is complete; and of that page.
  void put_cells_entry(size_t channel, const ChunkKey& key, uint64_t size, uint64_t checksum);
  void put_frame_entry(size_t channel, uint64_t size, uint64_t checksum);
  void put_cells_page(size_t channel, uint64_t page, uint64_t size, uint64_t checksum);

  // Appends the next frame of meta().channels[channel], which its cover names. Frames may come between chunks. REQUIRES: the channel is
  // not that of the labels; `frame` is one zstd frame or one skippable frame.
  void put_frame(size_t channel, std::span<const uint8_t> frame);
  // Writes index, covers, metadata and report, and gives the file its name. When it returns the file is durable.
  // REQUIRES: every chunk of every stored level was put once.
  // `sums` are those of all cells; null if they are not known.
  void finish(const std::string& report, uint64_t crossings, const CellSums* sums = nullptr);
  uint64_t bytes() const override { return bytes_.size(); }
  uint64_t chunks() const override;
  void save(Bytes& state) override;

 private:
  struct Level {
    LevelInfo info;
    OpenPages open;
    std::vector<DirectoryEntry> directory;
  };
  GridWriter(const std::filesystem::path& path, Metadata meta, uint64_t keep);
  void put_place(Level& l, uint64_t page, const DirectoryEntry& place);
  CellFrames& cells(size_t channel);
  void place_cells(size_t channel, const ChunkKey& key, bool has_frame);
  void add_to_cover(size_t channel, const DirectoryEntry& place);

  Metadata meta_;
  std::vector<std::vector<DirectoryEntry>> covers_;  // so far, of all channels; that of the labels stays empty
  std::vector<std::optional<CellFrames>> cells_;     // of channels that have frames for chunks
  GridBytes bytes_;
  std::vector<Level> levels_;  // by stored_index()
};

}  // namespace teracell::store
