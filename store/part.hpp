// A part of a grid: the chunks that lie in a stretch of the tree (pyramid.hpp), in the order in which the file of the whole grid has
// them, and the children of chunks that lie in several parts. `merge` puts parts together. FORMAT.md, "Parts", has the bytes.
//
//   head | blocks of chunks ... | what the run found | footer
//
// Rejected: a .tcell file for each part. Its pages and directories would be made for nothing, since they say where chunks lie in it.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>

#include "store/chunk_sink.hpp"
#include "store/file.hpp"
#include "store/pyramid.hpp"

namespace teracell {

struct PartHead {
  std::string run;  // what the bytes of the whole grid depend on, as JSON: parts belong together if it is the same
  uint32_t number = 0, of = 1;
  TreeRange range;
  Metadata meta;  // of the whole grid, without what is known when it is complete
};

// What is written next, until there is enough for a block.
struct PartBlock {
  Bytes places;  // levels and places of chunks, in order, with numbers of changes; children with their frames
  std::vector<ChunkEntry> fine, coarse;  // of level 0, and of the levels above; offsets count from the first frame of the block
  Bytes frames;
  uint64_t records = 0;
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
  // `found` is for the one who merges. When it returns the file is durable.
  void finish(std::span<const uint8_t> found);
  uint64_t bytes() const override { return file_.size(); }
  uint64_t chunks() const override { return chunks_; }
  void save(Bytes& state) override;

 private:
  void append(uint8_t kind, std::span<const uint8_t> body);
  void flush();
  PartHead head_;
  OutputFile file_;
  ContentHash hash_;  // of all bytes so far
  PartBlock block_;
  uint64_t chunks_ = 0;
  ChunkEncoder encoder_;
};

// Checks what it reads. Throws FormatError.
class PartReader {
 public:
  explicit PartReader(const std::filesystem::path& path);
  const std::string& name() const { return file_.name(); }
  const PartHead& head() const { return head_; }
  uint64_t bytes() const { return file_.size(); }
  using TakeChunk = std::function<void(const ChunkKey&, const EncodedChunk&)>;
  using TakeChild = std::function<void(int level, uint32_t cu, uint32_t cv, Chunk&&)>;
  // Calls one of them for each record, in order, and returns what the run found.
  Bytes read(const TakeChunk& chunk, const TakeChild& child) const;

 private:
  struct Block {
    uint8_t kind;
    Bytes body;
  };
  Block block_at(uint64_t& offset) const;
  InputFile file_;
  PartHead head_;
  uint64_t first_block_ = 0;
};

bool is_part(const std::filesystem::path& path);  // whether a file begins as parts do

}  // namespace teracell
