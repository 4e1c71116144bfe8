// What a .tcell file says about itself (FORMAT.md, "Metadata"), and how the chunks and pages of a level follow from it.
#pragma once
#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "store/grid/grid.hpp"

namespace teracell::inline store {

// What a file may say (FORMAT.md, "Bounds"), in bytes of UTF-8: any name or unit; the names of all materials together, since
// some answers hold them all. And how many values its metadata may have as JSON, since they are read into a tree.
inline constexpr size_t kMostName = 256, kMostStem = 240;  // a name made from a file's name leaves room for a number
inline constexpr size_t kMostMaterialNames = size_t{1} << 22, kMostMetadataValues = size_t{1} << 20;
inline constexpr size_t kMostPatches = size_t{1} << 16, kMostPatchNames = size_t{1} << 22;  // bytes, with the names of their bodies

struct MaterialInfo {
  std::string name;
  std::string color;  // "#rrggbb" or "#rrggbbaa"
  uint32_t rank = 0;  // 0 is the strongest, no two are equal; the background (material 0) has the largest
  friend bool operator==(const MaterialInfo&, const MaterialInfo&) = default;
};

// What a label stands for.
struct LabelInfo {
  uint32_t material = 0;
  std::string body;      // empty unless labels keep bodies apart
  bool overlap = false;  // of the body's cells that lie in other bodies as well; the label before it is that of its other cells
  friend bool operator==(const LabelInfo&, const LabelInfo&) = default;
};

// How many cells a label has, and where they are.
struct LabelAmount {
  unsigned __int128 cells = 0;
  Box box;  // empty when there is no cell
  void add(unsigned __int128 more, const Box& where);  // both have cells
  friend bool operator==(const LabelAmount&, const LabelAmount&) = default;
};

// A part of the boundary: of the surfaces, or a side of the domain.
struct PatchInfo {
  std::string name;  // no two are equal
  std::string body;  // empty for a side of the domain
  double area = 0;   // in square units
  friend bool operator==(const PatchInfo&, const PatchInfo&) = default;
};
inline constexpr uint32_t kNoPatch = ~uint32_t{0};

// A stored level of the labels.
struct LevelInfo {
  int level = 0;
  uint64_t directory = 0;  // offset of its directory's frame
  uint64_t chunks = 0;     // those stored as frames; the others are uniform
  uint64_t bytes = 0;      // of these frames
  uint64_t changes = 0;    // of set, along all rays
  void add(uint64_t more_chunks, uint64_t more_bytes, uint64_t more_changes) { chunks += more_chunks, bytes += more_bytes, changes += more_changes; }
  friend bool operator==(const LevelInfo&, const LevelInfo&) = default;
};
// The levels that a file which is written now has: level 1 would take about as many bytes as level 0, so it is derived when it is read.
// All levels above it take a tenth.
inline int next_stored(int level) { return level == 0 ? 2 : level + 1; }
inline size_t stored_index(int level) { return level == 0 ? 0 : static_cast<size_t>(level) - 1; }  // among them

// Data of the cells: their labels, or something else such as volume fractions. store/format/channel_kinds.hpp lists the kinds
// that this program knows. Of any other channel only the cover is used, which is enough to verify it and to copy it.
struct Channel {
  std::string name;
  std::string coding;             // empty if the file does not tell
  bool required = false;          // a reader that does not know the channel must refuse the file
  std::vector<LevelInfo> levels;  // the labels: the stored levels, ascending, 0 first
  uint64_t cover = 0;             // the others: offset of the directory of all frames of the channel
  uint64_t frames = 0;            // entries of the cover
  std::string about{};            // what its coding has to know, as a JSON object; empty if there is nothing
  uint64_t bytes = 0;             // of all its frames; 0 if the file does not tell
  friend bool operator==(const Channel&, const Channel&) = default;
};

inline constexpr char kLabels[] = "labels", kRuns[] = "runs";  // the name and the coding of the channel that every file has

struct Metadata {
  std::string units = "m";
  Grid grid;
  int ray_axis = 2;
  std::vector<MaterialInfo> materials;
  std::vector<LabelInfo> labels;
  std::vector<LabelAmount> amounts;  // of the labels; empty if the file does not tell
  std::vector<PatchInfo> patches;  // the sides xmin, xmax, ymin ... first; empty if the file does not tell
  uint32_t chunk_rays = 64;      // a chunk has chunk_rays x chunk_rays rays ...
  uint32_t chunk_cells = 65536;  // ... of chunk_cells cells
  uint32_t page_chunks = 16;     // a page has page_chunks x page_chunks chunks
  uint64_t crossings = 0;
  std::string labels_hash;  // store/format/labels_hash.hpp; empty if the file does not tell
  std::vector<Channel> channels = {{kLabels, kRuns, true, {}, 0, 0, {}}};  // the labels first

  std::vector<LevelInfo>& levels() { return channels.front().levels; }
  const std::vector<LevelInfo>& levels() const { return channels.front().levels; }  // those of the labels that are stored
  std::span<const Channel> others() const { return std::span(channels).subspan(1); }  // all channels but the labels
  RayFrame frame() const { return RayFrame::along(ray_axis); }
  friend bool operator==(const Metadata&, const Metadata&) = default;
};
// What a label is where it does not matter whether cells lie in other bodies as well.
inline uint32_t without_overlap(const Metadata& meta, uint32_t label) { return meta.labels[label].overlap ? label - 1 : label; }
// Whether labels stand for bodies, and not only for materials.
bool keeps_bodies(const Metadata& meta);
// Whether the metadata may also say how many cells each label has: its JSON has a bound.
bool has_room_for_amounts(const Metadata& meta);
// Whether the amounts lie in the grid and add up to its cells.
bool amounts_fit(const Metadata& meta);
// What in the metadata is longer than a file may say, as a sentence for people; empty if nothing is.
std::string beyond_bounds(const Metadata& meta);

// The place of a chunk in its grid: chunks are counted along u and v, and as segments along the rays.
struct ChunkKey {
  int level;
  uint32_t cu, cv, segment;
  friend bool operator==(const ChunkKey&, const ChunkKey&) = default;
};
struct ChunkKeyHash {
  uint64_t grid = 0;  // where keys of several grids are kept together
  size_t operator()(const ChunkKey& key) const {
    uint64_t h = grid;
    for (const uint64_t x : {static_cast<uint64_t>(key.level), uint64_t{key.cu}, uint64_t{key.cv}, uint64_t{key.segment}})
      h = (h ^ x) * 0x9E3779B97F4A7C15, h ^= h >> 29;
    return h;
  }
};
std::string chunk_name(const ChunkKey& key);  // for messages

// The chunks and pages of one level.
struct LevelShape {
  int level;
  uint32_t nu, nv, nw;  // cells of the level along the frame
  uint32_t chunk_rays, chunk_cells, page_chunks;
  uint32_t chunks_u, chunks_v, segments;
  uint32_t pages_u, pages_v;

  LevelShape(const Metadata& meta, int level);
  uint64_t pages() const { return uint64_t{pages_u} * pages_v * segments; }
  // Chunks of a page along u and v.
  uint32_t page_width(uint64_t page) const;
  uint32_t page_height(uint64_t page) const;
  size_t page_size(uint64_t page) const { return size_t{page_width(page)} * page_height(page); }
  // The page of a chunk, its slot (its number among the chunks of the page in raster order, u fastest), and back.
  uint64_t page_of(const ChunkKey& key) const { return (uint64_t{key.segment} * pages_v + key.cv / page_chunks) * pages_u + key.cu / page_chunks; }
  uint32_t slot_of(const ChunkKey& key, uint64_t page) const { return (key.cv % page_chunks) * page_width(page) + key.cu % page_chunks; }
  ChunkKey key_of(uint64_t page, uint32_t slot) const;
  // Rays and cells of a chunk.
  uint32_t rays_u(uint32_t cu) const { return std::min(chunk_rays, nu - cu * chunk_rays); }
  uint32_t rays_v(uint32_t cv) const { return std::min(chunk_rays, nv - cv * chunk_rays); }
  uint32_t length(uint32_t segment) const { return std::min(chunk_cells, nw - segment * chunk_cells); }
};

}  // namespace teracell::store
