// A part of a grid: the bytes of the chunks that lie in a stretch of the tree (pyramid.hpp), and of the index pages that lie in it as a
// whole, as they follow each other in the file of the whole grid. Only what joins two parts is left to whoever puts them together:
// entries of pages and children of chunks that lie in several parts. FORMAT.md, "Parts", has the layout.
//
//   head | bytes of the grid ... | records: what these bytes are, and what joins parts | what the run found | footer
//
// Rejected: a .tcell file for each part, whose chunks and pages would all have to be read to make pages and a directory of the whole.
#pragma once
#include <filesystem>
#include <map>

#include "store/base/file.hpp"
#include "store/format/cell_frames.hpp"
#include "store/format/open_pages.hpp"
#include "store/runs/pyramid.hpp"
#include "store/write/chunk_sink.hpp"
#include "store/write/grid_bytes.hpp"

namespace teracell::inline store {

struct PartHead {
  std::string run;  // what the bytes of the whole grid depend on, as JSON: parts belong together if it is the same
  uint32_t number = 0, of = 1;
  TreeRange range;
  Metadata meta;  // of the whole grid, without what is known when it is complete
};

// Not thread-safe. The file's bytes depend on the order of put().
class PartWriter : public ChunkSink {
 public:
  PartWriter(const std::filesystem::path& path, PartHead head);
  // Goes on where save() of a writer for the same path and head left off.
  PartWriter(const std::filesystem::path& path, PartHead head, ByteReader& state);

  const Metadata& meta() const override { return head_.meta; }
  void put(const ChunkKey& key, const EncodedChunk& chunk) override;
  void put_child(int level, uint32_t cu, uint32_t cv, const Chunk& coarsened) override;
  void put_cells(size_t channel, const ChunkKey& key, std::span<const uint8_t> frame) override;
  // `found` is for the one who merges. When it returns the file is durable, if it shall be.
  void finish(std::span<const uint8_t> found, bool durable = true);
  uint64_t bytes() const override { return bytes_.size(); }
  uint64_t chunks() const override { return chunks_; }
  void save(Bytes& state) override;

 private:
  struct Level {
    OpenPages open;                          // of pages that lie in the part as a whole
    std::map<uint64_t, LevelInfo> contents;  // of their chunks so far
  };
  PartWriter(const std::filesystem::path& path, PartHead head, uint64_t keep);
  void begin_record(uint8_t kind);
  void put_frame_record(uint8_t kind, size_t channel, std::initializer_list<uint64_t> place, std::span<const uint8_t> frame);
  PartHead head_;
  Bytes encoded_head_;
  GridBytes bytes_;
  std::vector<Level> levels_;  // by stored_index()
  struct Cells {
    CellFrames frames;    // of pages that lie in the part as a whole
    uint64_t number = 0;  // of frames so far
  };
  std::vector<Cells> cells_;  // of all channels but the labels
  Bytes records_;
  uint64_t recorded_ = 0;  // where the bytes of the last record end
  uint64_t chunks_ = 0;
  ChunkEncoder encoder_;
};

// What the records of a part are told to, in order.
class PartTaker {
 public:
  virtual ~PartTaker() = default;
  virtual void bytes(uint64_t size) = 0;  // the next bytes of the grid
  // These are what the last of these bytes are: a chunk (if it has a frame), and an index page (put_page() in writer.hpp).
  virtual void chunk(const ChunkKey& key, ChunkEntry&& entry, uint64_t changes) = 0;
  virtual void page(const LevelInfo& chunks, uint64_t page, uint64_t size, uint64_t checksum) = 0;
  // put_cells_entry(), put_frame_entry() and put_cells_page() in writer.hpp.
  virtual void cells(size_t channel, const ChunkKey& key, uint64_t size, uint64_t checksum) = 0;
  virtual void frame(size_t channel, uint64_t size, uint64_t checksum) = 0;
  virtual void cells_page(size_t channel, uint64_t page, uint64_t size, uint64_t checksum) = 0;
  // put_child() in chunk_sink.hpp.
  virtual void child(int level, uint32_t cu, uint32_t cv, Chunk&& coarsened) = 0;
};

// Throws FormatError, like everything here that reads. Threads may share a reader.
class PartReader {
 public:
  explicit PartReader(const std::filesystem::path& path);
  const std::string& name() const { return file_.name(); }
  const PartHead& head() const { return head_; }
  uint64_t file_bytes() const { return file_.size(); }
  // The bytes of the grid, and their hash, which whoever reads them has to compare.
  uint64_t bytes() const { return bytes_; }
  void read(uint64_t offset, std::span<uint8_t> out) const { file_.read(first_ + offset, out); }
  const std::array<uint8_t, 16>& hash() const { return hash_; }
  Bytes found() const;
  void check_records() const { take(records_, "its records"); }
  // Goes through the records.
  void replay(PartTaker& taker) const;

 private:
  Bytes take(const DirectoryEntry& place, const char* what) const;
  void replay_unnamed(PartTaker& taker) const;  // with errors that need not name the file
  void replay_frame(ByteReader& in, uint8_t kind, uint64_t bytes, PartTaker& taker) const;
  InputFile file_;
  PartHead head_;
  uint64_t first_ = 0, bytes_ = 0;
  std::array<uint8_t, 16> hash_{};
  DirectoryEntry records_, found_;
};

bool is_part(const std::filesystem::path& path);  // whether a file begins as parts do

}  // namespace teracell::store
