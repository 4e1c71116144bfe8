// A grid's file as the module sees it: the page has it (behind an address, on the user's disk, in itself), and what the page gives is kept in
// blocks. The module never waits. When bytes are missing, what is being made ends with Later; the page fetches what missing() lists, all
// of it at once, and asks again. Since readers prefetch what they are about to read, few rounds are needed.
//
// (Rejected: synchronous requests, of which only one is under way at a time; and a stack that is put aside while bytes are fetched (Asyncify),
// which makes the module half as large again.)
#pragma once
#include <set>
#include <unordered_map>

#include "store/base/file.hpp"
#include "store/base/wanted.hpp"

namespace teracell::server {

// The files, and the blocks of them that the page has given. Blocks leave in rest(), never while an answer waits for bytes: else it could begin
// anew for ever.
class PageFiles {
 public:
  static constexpr uint64_t kBlock = 16384;
  static constexpr uint64_t kKept = uint64_t{32} << 20;   // bytes that rest() keeps
  static constexpr uint64_t kMost = uint64_t{192} << 20;  // bytes that one answer may read

  struct File {
    std::string name;
    uint64_t size;
  };
  uint32_t add(std::string name, uint64_t size);
  const File& file(uint32_t number) const { return files_[number]; }

  // Fills `out`, or throws Later and lists what is missing.
  void read(uint32_t file, uint64_t offset, std::span<uint8_t> out);
  // Throws Later if any of these bytes are missing.
  void expect(uint32_t file, std::span<const ByteRange> ranges);

  struct Missing {
    uint32_t file;
    uint64_t offset, size;
  };
  // Stretches of whole blocks, in order. Empties the list.
  std::vector<Missing> take_missing();
  // `offset` is that of a block.
  void give(uint32_t file, uint64_t offset, std::span<const uint8_t> bytes);
  // No answer waits for bytes: blocks that were not used for long may go.
  void rest();

 private:
  struct Block {
    Bytes bytes;
    uint64_t used;  // how many rest() there had been
  };
  static uint64_t key(uint32_t file, uint64_t block) { return uint64_t{file} << 48 | block; }
  const Block* find(uint32_t file, uint64_t block);

  std::vector<File> files_;
  std::unordered_map<uint64_t, Block> blocks_;
  uint64_t bytes_ = 0, rests_ = 0;
  std::set<std::pair<uint32_t, uint64_t>> missing_;  // files and blocks
};

class PageFile : public ByteSource {
 public:
  PageFile(PageFiles& files, uint32_t number) : files_(files), number_(number) {}
  uint64_t size() const override { return files_.file(number_).size; }
  const std::string& name() const override { return files_.file(number_).name; }
  void read(uint64_t offset, std::span<uint8_t> out) const override { files_.read(number_, offset, out); }
  bool is_far() const override { return true; }
  void prefetch(std::span<const ByteRange> soon) const override { files_.expect(number_, soon); }

 private:
  PageFiles& files_;
  const uint32_t number_;
};

}  // namespace teracell::server
