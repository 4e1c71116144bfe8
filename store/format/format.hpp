// The structures of a .tcell file <-> bytes (FORMAT.md). Pure: no I/O.
//
//   header | chunk and page frames ... | directories | metadata | report | footer
//
// A grid of 10^15 cells has millions of chunks. The index groups them in pages of 16 x 16 chunks, which are found through
// a directory of entries of one size. To open a file takes the footer and the metadata; to find a chunk takes a block of a
// directory and a page. Rejected: one flat index (a gigabyte to open), a B-tree (the keys are dense, so a place can be
// computed).
#pragma once
#include <memory>
#include <string>

#include "store/base/bytes.hpp"
#include "store/grid/label.hpp"

namespace teracell::inline store {

inline constexpr uint32_t kSkippableMagic = 0x184D2A5E;  // zstd tools step over frames that start with it
inline constexpr uint16_t kFormatMajor = 3, kFormatMinor = 2, kOldestMajor = 2;  // what is written, and the oldest that is read

uint64_t checksum(std::span<const uint8_t> bytes);  // XXH3, 64 bits, seed 0
std::string compressor_version();                   // another version may compress to other bytes

// Texts of JSON: the metadata and the report. The bounds keep a small file from becoming a large answer. 100,000 bodies make
// 58 MB of report, which zstd makes 20 times smaller, and 180 times when all bodies are the same.
inline constexpr uint64_t kMostText = uint64_t{1} << 26, kMostTextOfAnyFrame = uint64_t{1} << 20;  // zstd_frame.hpp, BodyBound
inline constexpr uint64_t kMostPageOfAnyFrame = 1 << 16;
Bytes encode_text(const std::string& text);  // a zstd frame
std::string decode_text(std::span<const uint8_t> frame, const std::string& what);
void append_decoded(std::span<const uint8_t> frame, const std::string& what, std::string& text);

// ---- index ------------------------------------------------------------------------------------------------------

// The cells of one label in a chunk: how many, and the box that holds them, in the chunk's (u, v, w).
struct LabelStats {
  Label label = 0;
  uint64_t cells = 0;
  std::array<uint32_t, 3> lo{}, hi{};
  friend bool operator==(const LabelStats&, const LabelStats&) = default;
};

struct ChunkEntry {
  uint64_t offset = 0;
  uint32_t size = 0;              // of the frame; 0: the chunk is uniform and has no frame
  uint64_t checksum = 0;          // of the frame
  std::vector<Label> uniform;     // the set, when size is 0
  std::vector<LabelStats> stats;  // on level 0, when size is not 0
  friend bool operator==(const ChunkEntry&, const ChunkEntry&) = default;
};

// A zstd frame. `place` is its own offset: its bytes say how far before it the chunks lie, so that they stay the same where both are moved.
Bytes encode_page(const std::vector<ChunkEntry>& entries, bool with_stats, uint64_t place = 0);
// Throws FormatError unless the frame holds `chunks` entries with labels below `labels`.
std::vector<ChunkEntry> decode_page(std::span<const uint8_t> frame, size_t chunks, bool with_stats, uint32_t labels, uint64_t place = 0);

// An entry alone, without its offset.
void put_entry(Bytes& out, const ChunkEntry& entry, bool with_stats);
ChunkEntry take_entry(ByteReader& in, bool with_stats, uint32_t labels);

struct DirectoryEntry {
  uint64_t offset = 0;
  uint64_t size = 0;
  uint64_t checksum = 0;
};

// A directory, of the pages of a level or of the frames of a channel, is a skippable frame of blocks. A block has 170
// entries (the last block has those that are left) and a checksum.
inline constexpr uint64_t kDirectoryEntry = 24, kBlockEntries = 170, kBlockBytes = kBlockEntries * kDirectoryEntry + 8;
Bytes encode_directory(const std::vector<DirectoryEntry>& entries);
struct BlockPlace {
  uint64_t offset;   // from the start of the directory's frame
  uint64_t entries;  // in this block
  uint64_t bytes() const { return entries * kDirectoryEntry + 8; }
};
BlockPlace directory_block(uint64_t block, uint64_t entries);
uint64_t directory_bytes(uint64_t entries);  // of the whole frame
std::vector<DirectoryEntry> decode_directory_block(std::span<const uint8_t> block);
void check_directory_frame(std::span<const uint8_t> eight_bytes, uint64_t entries);

// ---- header and footer ------------------------------------------------------------------------------------------

inline constexpr uint64_t kHeaderBytes = 32, kFooterBytes = 128;
Bytes encode_header();
std::pair<uint16_t, uint16_t> check_header(std::span<const uint8_t> bytes);  // returns the major and the minor version

struct Footer {
  uint64_t file_bytes = 0;
  DirectoryEntry metadata, report;  // where they are
  std::array<uint8_t, 16> hash{};   // of the content: FORMAT.md 6.2
};
Bytes encode_footer(const Footer& footer);
Footer decode_footer(std::span<const uint8_t> bytes);

struct HashState;

// The checksum() of bytes that come in pieces.
class RunningChecksum {
 public:
  RunningChecksum();
  ~RunningChecksum();
  RunningChecksum(const RunningChecksum&) = delete;
  void add(std::span<const uint8_t> bytes);
  uint64_t value() const;

 private:
  std::unique_ptr<HashState> state_;
};

// The footer's hash. It is fed the frames of the levels' directories, of the other channels' covers, of the metadata and of
// the report, in this order.
class ContentHash {
 public:
  ContentHash();
  ~ContentHash();
  ContentHash(const ContentHash&) = delete;
  void add(std::span<const uint8_t> bytes);
  std::array<uint8_t, 16> digest() const;

 private:
  std::unique_ptr<HashState> state_;
};
std::string hex(const std::array<uint8_t, 16>& hash);

}  // namespace teracell::store
