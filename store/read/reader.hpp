// Opens a .tcell file, checks it and finds its chunks. Opening reads the header, the footer and the metadata. A chunk takes
// a block of a directory and a page (both are kept, up to 16 MiB) and its own bytes. All bytes are held against their
// checksums before they are used.
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "store/base/file.hpp"
#include "store/base/system/once.hpp"
#include "store/format/frame_claims.hpp"
#include "store/format/index_cache.hpp"
#include "store/grid/metadata.hpp"
#include "store/runs/run.hpp"

namespace teracell::inline store {

// A chunk where those of several readers are kept together.
struct ChunkPlace {
  uint64_t owner;
  ChunkKey chunk;
  friend bool operator==(const ChunkPlace&, const ChunkPlace&) = default;
};
struct ChunkPlaceHash {
  size_t operator()(const ChunkPlace& p) const { return ChunkKeyHash{p.owner}(p.chunk); }
};

// Keeps decoded chunks for one reader; what is behind it may serve many. Threads share it.
class ChunkKeeper {
 public:
  using Make = std::function<std::shared_ptr<const Chunk>()>;
  virtual ~ChunkKeeper() = default;
  // The chunk that is kept, or what make() returns.
  virtual std::shared_ptr<const Chunk> get(const ChunkKey& key, const Make& make) = 0;
  virtual bool has(const ChunkKey&) const { return false; }
};

// Threads may share a reader. Throws IoError or FormatError; a FormatError names the file and the place in it.
class GridReader {
 public:
  explicit GridReader(const std::filesystem::path& path);
  // Without a keeper, a chunk is decoded each time that it is asked for. Without an index cache, the reader has its own.
  explicit GridReader(std::unique_ptr<ByteSource> source, std::shared_ptr<ChunkKeeper> keeper = nullptr, std::shared_ptr<IndexCache> index = nullptr);

  const Metadata& meta() const { return meta_; }
  const std::string& name() const { return source_->name(); }
  uint64_t file_bytes() const { return source_->size(); }
  std::string version() const { return std::to_string(version_.first) + "." + std::to_string(version_.second); }  // of the file's format
  std::string hash() const;    // of the content, 32 hex digits
  // The same for all files with these chunks of level 0, this report and these names, wherever their frames lie. Asked for the first time, it reads
  // the index of level 0.
  std::string cells_hash() const;
  std::string report() const;  // JSON that check_json() has passed
  void append_report(std::string& text) const;
  // The first FormatError that reading has met since; empty: none so far.
  std::string damage() const;
  int levels() const { return meta_.grid.levels(); }
  bool stored(int level) const;
  LevelShape shape(int level) const { return LevelShape(meta_, level); }

  // ---- Chunks. REQUIRES: the chunk lies in its level.

  // What the index says of the chunk. REQUIRES: its level is stored.
  std::shared_ptr<const ChunkEntry> entry(const ChunkKey& key) const;
  // The set that fills the chunk, if it, or each chunk below that it is derived from, is stored as such. Reads no chunks.
  std::optional<std::vector<Label>> uniform(const ChunkKey& key) const;
  // Overwrites `out`. A chunk of a level that is not stored is derived from the next lower level.
  void read(const ChunkKey& key, Chunk& out) const;
  // The same, through the keeper. Without a keeper, `scratch` holds the chunk until it is used again.
  std::shared_ptr<const Chunk> chunk(const ChunkKey& key, std::shared_ptr<Chunk>& scratch) const;

  // Reads what another channel has for a chunk of level 0 (cell_frames.hpp). Returns false if it has nothing. Holds the frame against its
  // checksum only. REQUIRES: the channel is one of cells, and the chunk lies in level 0.
  bool read_cells(const Channel& channel, const ChunkKey& key, Bytes& frame) const;

  // Makes ready what the index says of the chunks that meet the box, and the chunks themselves, in as few round trips as possible,
  // if the source is far away: otherwise each read of a chunk would be one. Of a large box, a part. REQUIRES: the box lies in the level.
  void prefetch(int level, const Box& box, bool with_chunks = true) const;
  // The same for the frames that read_cells() reads of chunks of level 0.
  void prefetch_cells(const Channel& channel, const Box& box) const;

  // ---- The parts of the file, for a program that goes through all of them. FormatErrors don't name the file yet, except
  // those of chunks.

  const ByteSource& source() const { return *source_; }
  const Footer& footer() const { return footer_; }
  DirectoryEntry page_place(int level, uint64_t page) const;
  DirectoryEntry frame_place(const Channel& channel, uint64_t frame) const;  // by the channel's cover
  std::shared_ptr<const std::vector<ChunkEntry>> page(int level, uint64_t page) const;
  // The stored chunk that an entry describes.
  void read_stored(const ChunkKey& key, const ChunkEntry& entry, Chunk& out) const;
  // The chunk as the next lower level has it, even if it is stored. REQUIRES: the level is above 0.
  // `damage`: what can't be read has a set without members; otherwise it is an error.
  void derive(const ChunkKey& key, Chunk& out, bool damage = false) const;

 private:
  template <class F>
  auto reading(F&& f) const;
  const std::string& noted(const std::string& fault) const;
  const LevelInfo& info(int level) const;
  void check_directory(const std::string& whose, uint64_t offset, uint64_t entries) const;
  std::shared_ptr<const IndexPart> cells_part(const Channel& channel, uint64_t frame, uint64_t owner,
                                              const std::function<std::vector<uint64_t>(const Bytes&)>& decode, size_t size) const;
  int number_of(const Channel& channel) const;
  uint64_t cells_page(const Channel& channel, uint64_t page) const;
  uint64_t cells_frame(const Channel& channel, const ChunkKey& key) const;
  void prefetch_frames(const Channel& channel, const std::vector<uint64_t>& frames) const;
  DirectoryEntry directory_entry(uint64_t directory, uint64_t entries, uint64_t i) const;

  std::unique_ptr<ByteSource> source_;
  std::shared_ptr<ChunkKeeper> keeper_;
  std::shared_ptr<IndexCache> index_;
  const uint64_t number_;  // among the readers of index_
  mutable FrameClaims claims_;
  std::pair<uint16_t, uint16_t> version_;
  Footer footer_;
  Metadata meta_;
  mutable Once cells_hashed_;
  mutable std::string cells_hash_;
  mutable std::mutex damage_mutex_;
  mutable std::string damage_;
};

}  // namespace teracell::store
