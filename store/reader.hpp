// Reads a .tcell file. Opening costs the header, the footer and the metadata; a chunk costs a directory block and a page
// (both kept, up to 16 MiB) and its own bytes. Every byte is held against its checksum before it is believed.
#pragma once
#include <filesystem>
#include <functional>
#include <memory>

#include "store/file.hpp"
#include "store/index_cache.hpp"
#include "store/run.hpp"

namespace teracell {

// The place of a chunk in its grid.
struct ChunkKey {
  int level;
  uint32_t cu, cv, segment;
  friend bool operator==(const ChunkKey&, const ChunkKey&) = default;
};

// Decoded chunks kept by somebody else, for one grid or many. Threads share it.
class ChunkKeeper {
 public:
  using Make = std::function<std::shared_ptr<const Chunk>()>;
  virtual ~ChunkKeeper() = default;
  // The chunk that is kept, or what make() returns.
  virtual std::shared_ptr<const Chunk> get(const ChunkKey& key, const Make& make) = 0;
};

// Threads may share a reader. Throws IoError or FormatError, the latter with the file's name and the place in it.
class GridReader {
 public:
  explicit GridReader(const std::filesystem::path& path);
  // Without a keeper a chunk is decoded each time that it is asked for; without an index cache the reader has one of its own.
  explicit GridReader(std::unique_ptr<ByteSource> source, std::shared_ptr<ChunkKeeper> keeper = nullptr, std::shared_ptr<IndexCache> index = nullptr);

  const Metadata& meta() const { return meta_; }
  const std::string& name() const { return source_->name(); }
  uint64_t file_bytes() const { return source_->size(); }
  std::string version() const { return std::to_string(kFormatMajor) + "." + std::to_string(minor_); }  // of the file's format
  std::string hash() const;    // of the content, 32 hex digits
  std::string report() const;  // JSON
  int levels() const { return meta_.grid.levels(); }
  bool stored(int level) const;
  LevelShape shape(int level) const { return LevelShape(meta_, level); }

  // REQUIRES: stored(level), the chunk lies in the level.
  std::shared_ptr<const ChunkEntry> entry(int level, uint32_t cu, uint32_t cv, uint32_t segment) const;
  // The set that fills the chunk, if it, or each chunk below that it is derived from, is stored as such. Costs no chunk bytes.
  std::optional<std::vector<Label>> uniform(int level, uint32_t cu, uint32_t cv, uint32_t segment) const;
  // Any level: those that are not stored are derived from the next lower one that is. `out` is overwritten.
  void read(int level, uint32_t cu, uint32_t cv, uint32_t segment, Chunk& out) const;
  // The same by way of the keeper. Without one `scratch` holds it, until it is used again.
  std::shared_ptr<const Chunk> chunk(int level, uint32_t cu, uint32_t cv, uint32_t segment, std::shared_ptr<Chunk>& scratch) const;

  // Checks every byte and every invariant of FORMAT.md; throws at the first that fails. `progress` gets shares of 1.
  void verify(int threads, const std::function<void(double)>& progress) const;

 private:
  class Coverage;
  static std::string chunk_name(int level, uint32_t cu, uint32_t cv, uint32_t segment);
  const LevelInfo& info(int level) const;
  void check_directory(const std::string& whose, uint64_t offset, uint64_t entries) const;
  DirectoryEntry directory_entry(uint64_t directory, uint64_t entries, uint64_t i) const;
  DirectoryEntry page_place(int level, uint64_t page) const;
  std::shared_ptr<const IndexPart> page(int level, uint64_t page) const;
  void read_stored(int level, uint32_t cu, uint32_t cv, uint32_t segment, const ChunkEntry& entry, Chunk& out) const;
  void derive(int level, uint32_t cu, uint32_t cv, uint32_t segment, Chunk& out) const;
  void verify_level(const LevelInfo& info, int threads, Coverage& coverage, const std::function<void()>& progress) const;
  void verify_cover(const OtherChannel& channel, Coverage& coverage, const std::function<void()>& progress) const;
  void check_content_hash() const;
  void check_inside(const DirectoryEntry& place, const std::string& what) const;
  static void check_sum(const DirectoryEntry& place, const std::string& what, uint64_t found);
  void read_checked(const DirectoryEntry& place, const std::string& what, Bytes& out) const;
  // Calls f with the bytes at `offset`, a mebibyte at a time.
  void read_in_pieces(uint64_t offset, uint64_t size, const std::function<void(std::span<const uint8_t>)>& f) const;

  std::unique_ptr<ByteSource> source_;
  std::shared_ptr<ChunkKeeper> keeper_;
  std::shared_ptr<IndexCache> index_;
  const uint64_t number_;  // among the readers of index_
  uint16_t minor_ = 0;
  Footer footer_;
  Metadata meta_;
};

}  // namespace teracell
