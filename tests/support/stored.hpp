// Small .tcell files with chosen cells and chosen chunk sizes, in memory and on disk, and their levels by brute force.
#pragma once
#include <filesystem>
#include <functional>

#include "store/read/reader.hpp"
#include "store/write/writer.hpp"
#include "tests/support/blocks.hpp"
#include "tests/support/cube_grid.hpp"
#include "tests/support/descriptors.hpp"

namespace teracell::testing {

// A file in memory. Threads may share it.
class MemorySource : public ByteSource {
 public:
  explicit MemorySource(Bytes bytes, std::string name = "memory.tcell") : bytes_(std::move(bytes)), name_(std::move(name)) {}
  uint64_t size() const override { return bytes_.size(); }
  const std::string& name() const override { return name_; }
  void read(uint64_t offset, std::span<uint8_t> out) const override;

 private:
  const Bytes bytes_;
  const std::string name_;
};

GridReader reader_of(const Bytes& file);

// `labels` materials, a label each, that rank in reverse: the last is the strongest, the background the weakest.
Metadata metadata_of(const Grid& grid, int ray_axis, uint32_t labels);
// Chunks of 4 x 4 rays and 4 cells, pages of 2 x 2: a small grid has many of all.
Metadata with_tiny_chunks(Metadata meta);

// Writes one label a cell, C order [z][y][x], as the mesher writes a grid: all levels, chunks in the order of the tree. Calls `between`
// again and again on the way, for the frames of other channels.
void store_cells(
    const std::filesystem::path& path, const Metadata& meta, const std::vector<Label>& cells,
    const std::function<void(GridWriter&)>& between = [](GridWriter&) {});
// The file that store_cells() makes, in memory, and its reader.
Bytes stored_cells(const Metadata& meta, const std::vector<Label>& cells);
GridReader reader_of(const Metadata& meta, const std::vector<Label>& cells);
// Blobs of labels with cells of noise between them.
std::vector<Label> random_cells(std::mt19937_64& random, const Index3& n, uint32_t labels);

// The sets of a level from the labels of level 0, C order.
std::vector<Mask> level_by_hand(const Grid& grid, const std::vector<Label>& cells, int level);
// The sets of a level as the reader gives them, C order.
std::vector<Mask> level_as_read(const GridReader& reader, int level);

Bytes file_bytes(const std::filesystem::path& path);
// Makes or replaces a file.
void write_bytes(const std::filesystem::path& path, std::span<const uint8_t> bytes);
// Changes a byte of a file.
void damage(const std::filesystem::path& path, uint64_t at);

}  // namespace teracell::testing
