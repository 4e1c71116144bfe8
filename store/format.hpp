// The structures of a .tcell file <-> bytes (FORMAT.md). Pure: no I/O.
//
//   header | chunk and page frames ... | directories | metadata | report | footer
//
// An index of 10^15 cells has millions of chunks. They are grouped in pages of 16 x 16 chunks, found through a
// directory of fixed-size entries: opening reads the footer and the metadata, a tile a directory block and a page.
// Rejected: one flat index (a gigabyte to open), a B-tree (the key space is dense, a computed place is enough).
#pragma once
#include <memory>
#include <optional>
#include <string>

#include "store/bytes.hpp"
#include "store/grid.hpp"
#include "store/label.hpp"

namespace teracell {

inline constexpr uint16_t kFormatMajor = 1, kFormatMinor = 0;

uint64_t checksum(std::span<const uint8_t> bytes);  // XXH3, 64 bits, seed 0
std::string compressor_version();                   // another one may compress to other bytes

// ---- metadata ---------------------------------------------------------------------------------------------------

struct MaterialInfo {
  std::string name;
  std::string color;  // "#rrggbb" or "#rrggbbaa"
  uint32_t rank = 0;  // 0 is the strongest, no two are equal; the background (material 0) has the largest
  friend bool operator==(const MaterialInfo&, const MaterialInfo&) = default;
};

// What a label stands for.
struct LabelInfo {
  uint32_t material = 0;
  std::string body;  // empty unless labels keep bodies apart
  friend bool operator==(const LabelInfo&, const LabelInfo&) = default;
};

struct LevelInfo {
  int level = 0;
  uint64_t directory = 0;  // offset of its directory frame
  uint64_t chunks = 0;     // stored as frames: the others are uniform
  uint64_t bytes = 0;      // of those frames
  uint64_t changes = 0;    // of label, along all rays
  friend bool operator==(const LevelInfo&, const LevelInfo&) = default;
};

// A channel that this reader doesn't know. Its cover is a directory of all its frames: enough to verify and to copy them.
struct OtherChannel {
  std::string name;
  uint64_t cover = 0;  // offset of the directory's frame
  uint64_t frames = 0;
  friend bool operator==(const OtherChannel&, const OtherChannel&) = default;
};

struct Metadata {
  std::string units = "m";
  Grid grid;
  int ray_axis = 2;
  std::vector<MaterialInfo> materials;
  std::vector<LabelInfo> labels;
  uint32_t chunk_rays = 64;      // a chunk has chunk_rays x chunk_rays rays ...
  uint32_t chunk_cells = 65536;  // ... of chunk_cells cells
  uint32_t page_chunks = 16;     // a page has page_chunks x page_chunks chunks
  uint64_t crossings = 0;
  std::vector<LevelInfo> levels;  // the stored ones, ascending, 0 first
  std::vector<OtherChannel> others;  // all channels but the labels; none is required

  Frame frame() const { return Frame::along(ray_axis); }
  friend bool operator==(const Metadata&, const Metadata&) = default;
};

// The chunks and pages of one level.
struct LevelShape {
  uint32_t nu, nv, nw;             // cells of the level along the frame
  uint32_t chunk_rays, chunk_cells, page_chunks;
  uint32_t chunks_u, chunks_v, segments;  // segments: chunks along the rays
  uint32_t pages_u, pages_v;

  LevelShape(const Metadata& meta, int level);
  uint64_t pages() const { return uint64_t{pages_u} * pages_v * segments; }
  uint64_t page_of(uint32_t cu, uint32_t cv, uint32_t segment) const {
    return (uint64_t{segment} * pages_v + cv / page_chunks) * pages_u + cu / page_chunks;
  }
  // Chunks of a page, and where a chunk stands in its page (raster order, u fastest).
  uint32_t page_width(uint64_t page) const;
  uint32_t page_height(uint64_t page) const;
  uint32_t slot_of(uint32_t cu, uint32_t cv, uint64_t page) const {
    return (cv % page_chunks) * page_width(page) + cu % page_chunks;
  }
  // Rays and cells of a chunk.
  uint32_t rays_u(uint32_t cu) const { return std::min(chunk_rays, nu - cu * chunk_rays); }
  uint32_t rays_v(uint32_t cv) const { return std::min(chunk_rays, nv - cv * chunk_rays); }
  uint32_t length(uint32_t segment) const { return std::min(chunk_cells, nw - segment * chunk_cells); }
};

Bytes encode_metadata(const Metadata& meta);                         // a zstd frame of JSON
Metadata decode_metadata(std::span<const uint8_t> frame);
Bytes encode_text(const std::string& text);                          // the report
std::string decode_text(std::span<const uint8_t> frame, const std::string& what);

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
  uint32_t size = 0;           // of the frame; 0: uniform, nothing stored
  uint64_t checksum = 0;       // of the frame
  std::vector<Label> uniform;  // the set, when size is 0
  std::vector<LabelStats> stats;  // level 0, when size is not 0
  friend bool operator==(const ChunkEntry&, const ChunkEntry&) = default;
};

Bytes encode_page(const std::vector<ChunkEntry>& entries, bool with_stats);  // a zstd frame
// Throws FormatError unless the frame holds `chunks` entries with labels below `labels`.
std::vector<ChunkEntry> decode_page(std::span<const uint8_t> frame, size_t chunks, bool with_stats, uint32_t labels);

struct DirectoryEntry {
  uint64_t offset = 0;
  uint64_t size = 0;
  uint64_t checksum = 0;
};

// A directory, of a level's pages or of a channel's frames, is a skippable frame of blocks: 170 entries (the last block: what
// is left) and a checksum.
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
uint16_t check_header(std::span<const uint8_t> bytes);  // the file's minor version; the major one is ours

struct Footer {
  uint64_t file_bytes = 0;
  DirectoryEntry metadata, report;  // where they are
  std::array<uint8_t, 16> hash{};   // of the content: FORMAT.md, "Content hash"
};
Bytes encode_footer(const Footer& footer);
Footer decode_footer(std::span<const uint8_t> bytes);

// checksum() of bytes that come in pieces.
class RunningChecksum {
 public:
  RunningChecksum();
  ~RunningChecksum();
  RunningChecksum(const RunningChecksum&) = delete;
  void add(std::span<const uint8_t> bytes);
  uint64_t value() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// The footer's hash: fed the frames of the levels' directories, of the other channels' covers, of metadata and report.
class ContentHash {
 public:
  ContentHash();
  ~ContentHash();
  ContentHash(const ContentHash&) = delete;
  void add(std::span<const uint8_t> bytes);
  std::array<uint8_t, 16> digest() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};
std::string hex(const std::array<uint8_t, 16>& hash);

}  // namespace teracell
