#include "tools/export/zarr/chunks.hpp"

#include <algorithm>

#include "store/read/query.hpp"
#include "tools/export/arrays/dense.hpp"

namespace teracell::exports::zarr {
namespace {

template <class T>
class Maker : public ChunkMaker {
 public:
  explicit Maker(const Hierarchy& h) : h_(h), number_(h.e.number()) {}

  std::vector<Frame> make(const Column& column) override {
    const Layout& a = *column.array;
    const Box cells = cells_of(a, column.chunks);
    Box in_level;
    for (int d = 0; d < 3; ++d) in_level.lo[d] = a.box.lo[d] + cells.lo[d], in_level.hi[d] = a.box.lo[d] + cells.hi[d];
    const std::optional<uint32_t> uniform = uniform_value(h_.e.reader, a.level, in_level, number_);
    if (uniform == h_.fill) return {};
    const Index3 size = size_of(cells), chunks = size_of(column.chunks);
    const bool same = uniform && volume(size) == volume(chunks) * volume(a.chunk_cells);  // all chunks are, bit by bit
    Bytes frame;
    if (same) {
      chunk_.assign(static_cast<size_t>(volume(a.chunk_cells)), static_cast<T>(*uniform));
      frame = encoded();
    } else {
      column_.resize(static_cast<size_t>(volume(size)));
      read_box<T>(h_.e.reader, a.level, in_level, number_, 0, column_.data(), {1, size[0], size[0] * size[1]});
    }
    std::vector<Frame> out;
    for (int64_t i = 0; i < volume(chunks); ++i) {
      Index3 c = from_c_order(i, chunks);
      for (int d = 0; d < 3; ++d) c[d] += column.chunks.lo[d];
      if (same) out.push_back({c, frame});
      else if (cut(a, c, cells, size)) out.push_back({c, encoded()});
    }
    return out;
  }

 private:
  // The cells that chunks have, without those beyond the array.
  static Box cells_of(const Layout& a, const Box& chunks) {
    Box out;
    for (int d = 0; d < 3; ++d) {
      out.lo[d] = chunks.lo[d] * a.chunk_cells[d];
      out.hi[d] = std::min(a.cells[d], chunks.hi[d] * a.chunk_cells[d]);
    }
    return out;
  }

  // Takes a chunk out of the column. Returns whether it has anything but the fill value.
  bool cut(const Layout& a, const Index3& c, const Box& cells, const Index3& size) {
    const Box part = cells_of(a, {c, {c[0] + 1, c[1] + 1, c[2] + 1}});
    chunk_.assign(static_cast<size_t>(volume(a.chunk_cells)), static_cast<T>(h_.fill));
    for (int64_t z = part.lo[2]; z < part.hi[2]; ++z)
      for (int64_t y = part.lo[1]; y < part.hi[1]; ++y) {
        const T* const row = column_.data() + ((z - cells.lo[2]) * size[1] + y - cells.lo[1]) * size[0] + part.lo[0] - cells.lo[0];
        std::copy_n(row, part.hi[0] - part.lo[0], chunk_.data() + ((z - part.lo[2]) * a.chunk_cells[1] + y - part.lo[1]) * a.chunk_cells[0]);
      }
    return std::ranges::any_of(chunk_, [&](T value) { return value != h_.fill; });
  }

  Bytes encoded() { return zstd_.encode({reinterpret_cast<const uint8_t*>(chunk_.data()), chunk_.size() * sizeof(T)}, kZstdLevel); }

  const Hierarchy& h_;
  const SetValue number_;
  ZstdEncoder zstd_;
  std::vector<T> column_, chunk_;
};

}  // namespace

std::optional<Column> Columns::next() {
  if (array_ == h_.arrays.size()) return std::nullopt;
  const Layout& a = h_.arrays[array_];
  Column out{&a, from_c_order(shard_, a.shards), {}};
  const Box shard = a.chunks_of_shard(out.shard);
  const int along = h_.e.reader.meta().ray_axis;
  Index3 step{1, 1, 1}, columns;
  step[along] = std::max<int64_t>(1, most_bytes_ / static_cast<int64_t>(h_.bytes_per_cell) / volume(a.chunk_cells));
  for (int d = 0; d < 3; ++d) columns[d] = (shard.hi[d] - shard.lo[d] - 1) / step[d] + 1;
  const Index3 at = from_c_order(column_, columns);
  for (int d = 0; d < 3; ++d) {
    out.chunks.lo[d] = shard.lo[d] + at[d] * step[d];
    out.chunks.hi[d] = std::min(shard.hi[d], out.chunks.lo[d] + step[d]);
  }
  if (++column_ == volume(columns)) column_ = 0, ++shard_;
  if (shard_ == volume(a.shards)) shard_ = 0, ++array_;
  return out;
}

std::unique_ptr<ChunkMaker> chunk_maker(const Hierarchy& h) {
  return with_number(h.bytes_per_cell, [&]<class T>(T) -> std::unique_ptr<ChunkMaker> { return std::make_unique<Maker<T>>(h); });
}

}  // namespace teracell::exports::zarr
