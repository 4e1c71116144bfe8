#include "tests/support/stored.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "store/read/query.hpp"
#include "store/write/pyramid_writer.hpp"

namespace teracell::testing {

void MemorySource::read(uint64_t offset, std::span<uint8_t> out) const {
  if (offset > bytes_.size() || out.size() > bytes_.size() - offset) throw IoError(name_ + ": end of file");
  if (!out.empty()) std::memcpy(out.data(), bytes_.data() + offset, out.size());
}

GridReader reader_of(const Bytes& file) { return GridReader(std::make_unique<MemorySource>(file)); }

Metadata metadata_of(const Grid& grid, int ray_axis, uint32_t labels) {
  Metadata meta;
  meta.grid = grid;
  meta.ray_axis = ray_axis;
  for (uint32_t m = 0; m < labels; ++m) {
    meta.materials.push_back({fmt::format("m{}", m), "#808080", labels - 1 - m});
    meta.labels.push_back({m, ""});
  }
  return meta;
}

Metadata with_tiny_chunks(Metadata meta) {
  meta.chunk_rays = 4;
  meta.chunk_cells = 4;
  meta.page_chunks = 2;
  return meta;
}

void store_cells(const std::filesystem::path& path, const Metadata& meta, const std::vector<Label>& cells,
                 const std::function<void(GridWriter&)>& between) {
  GridWriter writer(path, meta);
  PyramidWriter pyramid(writer);
  ChunkEncoder encoder;
  const LabelsAdder adder(meta);
  CellSums sums;
  const LevelShape shape(meta, 0);
  const RayFrame f = meta.frame();
  const Index3 n = meta.grid.cells();
  const auto labels = static_cast<uint32_t>(meta.labels.size());
  const auto chunk = [&](uint32_t cu, uint32_t cv) {
    std::vector<Mask> block;
    for (uint32_t v = 0; v < shape.rays_v(cv); ++v)
      for (uint32_t u = 0; u < shape.rays_u(cu); ++u)
        for (uint32_t w = 0; w < shape.nw; ++w) {
          Index3 cell;
          cell[f.u] = cu * shape.chunk_rays + u, cell[f.v] = cv * shape.chunk_rays + v, cell[f.w] = w;
          block.push_back(Mask{1} << cells[static_cast<size_t>((cell[2] * n[1] + cell[1]) * n[0] + cell[0])]);
        }
    return block_of_cells(shape.rays_u(cu), shape.rays_v(cv), shape.nw, labels, block);
  };
  const auto unit = [&](uint32_t cu, uint32_t cv) {  // 4 x 4 chunks, and the one of level 2 above them
    std::array<Chunk, kChildren> pieces;
    for (uint32_t i = 0; i < kChildren; ++i) {
      const uint32_t u = cu * kFanOut + i % kFanOut, v = cv * kFanOut + i / kFanOut;
      if (u >= shape.chunks_u || v >= shape.chunks_v) continue;
      const Chunk fine = chunk(u, v);
      const LevelChunk encoded = encode_level(encoder, meta, 0, u, v, fine);
      pyramid.put(encoded);
      sums.labels += adder.sum({0, u, v, 0}, fine.rays);
      for (uint32_t s = 0; s < encoded.segments.size(); ++s) sums.add_amounts(shape, f, {0, u, v, s}, encoded.segments[s].entry);
      between(writer);
      pieces[i] = coarsen(fine, 2);
    }
    if (meta.grid.levels() <= 2) return;
    const Chunk level2 = join_pieces(pieces.data(), kFanOut, kFanOut, meta.chunk_rays, labels);
    pyramid.put(encode_level(encoder, meta, 2, cu, cv, level2));
    if (const auto above = pyramid.node_above(2, cu, cv)) {
      above->add(cu, cv, coarsen(level2, 1), encoder);
      pyramid.put_above(above, cu, cv);
    }
  };
  const auto visit = [&](auto&& self, uint32_t cu, uint32_t cv, uint32_t width) -> void {
    if (cu * kFanOut >= shape.chunks_u || cv * kFanOut >= shape.chunks_v) return;
    if (width == 1) return unit(cu, cv);
    for (uint32_t i = 0; i < kChildren; ++i) self(self, cu + i % kFanOut * (width / kFanOut), cv + i / kFanOut * (width / kFanOut), width / kFanOut);
  };
  uint32_t width = 1;
  while (width * kFanOut < std::max(shape.chunks_u, shape.chunks_v)) width *= kFanOut;
  visit(visit, 0, 0, width);
  writer.finish(R"({"schema":1})", 1234, &sums);
}

Bytes stored_cells(const Metadata& meta, const std::vector<Label>& cells) {
  const auto path = std::filesystem::temp_directory_path() / fmt::format("teracell-cells-{}", getpid());
  store_cells(path, meta, cells);
  Bytes bytes = file_bytes(path);
  std::filesystem::remove(path);
  return bytes;
}

GridReader reader_of(const Metadata& meta, const std::vector<Label>& cells) { return reader_of(stored_cells(meta, cells)); }

std::vector<Label> random_cells(std::mt19937_64& random, const Index3& n, uint32_t labels) {
  std::vector<Label> cells(static_cast<size_t>(n[0] * n[1] * n[2]), 0);
  struct Ball {
    std::array<double, 3> at;
    double radius;
    Label label;
  };
  std::vector<Ball> balls;
  for (int i = 0; i < 4; ++i) {
    Ball ball{{}, 0, static_cast<Label>(random() % labels)};
    for (int d = 0; d < 3; ++d) ball.at[d] = std::uniform_real_distribution<>(0, static_cast<double>(n[d]))(random);
    ball.radius = std::uniform_real_distribution<>(0.2, 0.6)(random) * static_cast<double>(std::min({n[0], n[1], n[2]}));
    balls.push_back(ball);
  }
  size_t i = 0;
  for (int64_t z = 0; z < n[2]; ++z)
    for (int64_t y = 0; y < n[1]; ++y)
      for (int64_t x = 0; x < n[0]; ++x, ++i) {
        for (const Ball& b : balls) {
          const double dx = static_cast<double>(x) - b.at[0], dy = static_cast<double>(y) - b.at[1], dz = static_cast<double>(z) - b.at[2];
          if (dx * dx + dy * dy + dz * dz < b.radius * b.radius) cells[i] = b.label;
        }
        if (random() % 64 == 0) cells[i] = static_cast<Label>(random() % labels);
      }
  return cells;
}

std::vector<Mask> level_by_hand(const Grid& grid, const std::vector<Label>& cells, int level) {
  const Index3 fine = grid.cells(), n = grid.cells(level);
  std::vector<Mask> out(static_cast<size_t>(n[0] * n[1] * n[2]), 0);
  size_t i = 0;
  for (int64_t z = 0; z < fine[2]; ++z)
    for (int64_t y = 0; y < fine[1]; ++y)
      for (int64_t x = 0; x < fine[0]; ++x)
        out[static_cast<size_t>(((z >> level) * n[1] + (y >> level)) * n[0] + (x >> level))] |= Mask{1} << cells[i++];
  return out;
}

std::vector<Mask> level_as_read(const GridReader& reader, int level) {
  const Index3 n = reader.meta().grid.cells(level);
  std::vector<uint32_t> cells(static_cast<size_t>(n[0] * n[1] * n[2]));
  const SetValue mask = [](const std::vector<Label>& set) { return static_cast<uint32_t>(mask_of(set)); };
  read_box<uint32_t>(reader, level, reader.meta().grid.box(level), mask, 0, cells.data(), {1, n[0], n[0] * n[1]});
  return {cells.begin(), cells.end()};
}

Bytes file_bytes(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_bytes(const std::filesystem::path& path, std::span<const uint8_t> bytes) {
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

void damage(const std::filesystem::path& path, uint64_t at) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekg(static_cast<std::streamoff>(at));
  const int was = file.get();
  file.seekp(static_cast<std::streamoff>(at));
  file.put(static_cast<char>(was ^ 0x40));
}

}  // namespace teracell::testing
