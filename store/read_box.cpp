// Cells into an array. Where the rays lie along its rows, each run is a stretch of a row. Where they lie across the rows, writing
// ray by ray would miss the cache at every cell: so the changes of a chunk are sorted along the rays, and a sweep keeps the current
// layer of cells, applies what changes and copies it, row by row. (A box of 512^3 cells at a surface takes a fifteenth of the time.)
#include <algorithm>
#include <cstdlib>
#include <limits>
#include <unordered_map>

#include "store/chunk_parts.hpp"
#include "store/in_order.hpp"
#include "store/query.hpp"

namespace teracell {
namespace {

// The cells of a box in an array: data[i[0] * step[0] + i[1] * step[1] + i[2] * step[2]] for i below size.
template <class T>
struct Cells {
  T* data;
  Index3 size, step;

  // The axes by the distance of neighbours, the nearest first. An axis of one cell has none.
  std::array<int, 3> nearest_first() const {
    const auto distance = [&](int d) { return size[d] > 1 ? std::abs(step[d]) : std::numeric_limits<int64_t>::max(); };
    std::array<int, 3> axes{0, 1, 2};
    std::ranges::stable_sort(axes, {}, distance);
    return axes;
  }
};

template <class T>
void fill(const Cells<T>& cells, T value) {
  const auto [a, b, c] = cells.nearest_first();
  const int64_t step = cells.step[a], n = cells.size[a];
  for (int64_t k = 0; k < cells.size[c]; ++k)
    for (int64_t j = 0; j < cells.size[b]; ++j) {
      T* const row = cells.data + k * cells.step[c] + j * cells.step[b];
      if (step == 1) std::fill_n(row, n, value);
      else
        for (int64_t i = 0; i < n; ++i) row[i * step] = value;
    }
}

// The values of the runs of a chunk. Each set is asked for once.
template <class T>
class RunValues {
 public:
  RunValues(const Chunk& chunk, const SetValue& value) {
    std::unordered_map<SetId, T> known;
    const PatternTable& patterns = chunk.rays.patterns;
    for (uint32_t pattern = 0; pattern < patterns.size(); ++pattern) {
      begin_.push_back(values_.size());
      for (const SetId set : patterns.sets(pattern)) {
        const auto [it, fresh] = known.try_emplace(set);
        if (fresh) it->second = static_cast<T>(value(chunk.sets.members(set)));
        values_.push_back(it->second);
      }
    }
  }
  const T* of(uint32_t pattern) const { return values_.data() + begin_[pattern]; }

 private:
  std::vector<size_t> begin_;  // of each pattern in values_
  std::vector<T> values_;
};

// Calls f(u, v, from, to, pattern, run) for the runs of the part, counted from its corner; `run` counts those of the ray.
template <class F>
void for_each_run_within(const RayBlock& rays, const ChunkPart& p, F&& f) {
  for_each_ray(p, [&](uint32_t u, uint32_t v) {
    const uint32_t ray = v * rays.nu + u;
    const std::span<const uint32_t> changes = rays.changes(ray);
    size_t run = p.w0 == 0 ? 0 : static_cast<size_t>(std::ranges::upper_bound(changes, p.w0) - changes.begin());
    for (uint32_t from = p.w0; from < p.w1; ++run) {
      const uint32_t to = run < changes.size() ? std::min(changes[run], p.w1) : p.w1;
      f(u - p.u0, v - p.v0, from - p.w0, to - p.w0, rays.pattern[ray], run);
      from = to;
    }
  });
}

// Keeps its memory from chunk to chunk.
template <class T>
class PartReader {
 public:
  PartReader(const GridReader& reader, const SetValue& value) : reader_(reader), value_(value) {}

  // `cells` are those of the part, on the axes of the rays: u, v, w.
  void read(const ChunkPart& p, const Cells<T>& cells) {
    if (const auto set = reader_.uniform(p.key)) return fill(cells, static_cast<T>(value_(*set)));
    const auto chunk = reader_.chunk(p.key, scratch_);
    const RunValues<T> values(*chunk, value_);
    const auto axes = cells.nearest_first();
    if (axes[0] == 2) along_rows(chunk->rays, p, values, cells);
    else sweep(chunk->rays, p, values, cells, axes[0], 1 - axes[0]);
  }

 private:
  struct Change {
    uint32_t place;  // in the layer
    T value;
  };

  static void along_rows(const RayBlock& rays, const ChunkPart& p, const RunValues<T>& values, const Cells<T>& cells) {
    const auto [step_u, step_v, step_w] = cells.step;
    for_each_run_within(rays, p, [&](uint32_t u, uint32_t v, uint32_t from, uint32_t to, uint32_t pattern, size_t run) {
      T* const row = cells.data + u * step_u + v * step_v;
      const T value = values.of(pattern)[run];
      if (step_w == 1) std::fill(row + from, row + to, value);
      else
        for (uint32_t w = from; w < to; ++w) row[w * step_w] = value;
    });
  }

  void sweep(const RayBlock& rays, const ChunkPart& p, const RunValues<T>& values, const Cells<T>& cells, int near, int far) {
    const size_t width = static_cast<size_t>(cells.size[near]), layers = static_cast<size_t>(cells.size[2]);
    start_.assign(layers + 2, 0);  // of layer w: start_[w + 1], until they are sorted
    for_each_run_within(rays, p, [&](uint32_t, uint32_t, uint32_t from, uint32_t, uint32_t, size_t) { ++start_[from + 2]; });
    for (size_t w = 2; w < start_.size(); ++w) start_[w] += start_[w - 1];
    changes_.resize(start_.back());
    for_each_run_within(rays, p, [&](uint32_t u, uint32_t v, uint32_t from, uint32_t, uint32_t pattern, size_t run) {
      const size_t place = near == 0 ? v * width + u : u * width + v;
      changes_[start_[from + 1]++] = {static_cast<uint32_t>(place), values.of(pattern)[run]};
    });
    layer_.resize(width * static_cast<size_t>(cells.size[far]));
    for (size_t w = 0; w < layers; ++w) {
      for (size_t i = start_[w]; i < start_[w + 1]; ++i) layer_[changes_[i].place] = changes_[i].value;
      T* const out = cells.data + static_cast<int64_t>(w) * cells.step[2];
      if (cells.step[near] == 1 && width == 64) copy_rows<64>(out, width, cells.size[far], cells.step[far]);
      else if (cells.step[near] == 1) copy_rows<0>(out, width, cells.size[far], cells.step[far]);
      else
        for (int64_t row = 0; row < cells.size[far]; ++row)
          for (size_t i = 0; i < width; ++i)
            out[row * cells.step[far] + static_cast<int64_t>(i) * cells.step[near]] = layer_[static_cast<size_t>(row) * width + i];
    }
  }

  // Rows of whole chunks have a length that the compiler may know.
  template <size_t kWidth>
  void copy_rows(T* out, size_t width, int64_t rows, int64_t step) const {
    const T* row = layer_.data();
    for (int64_t i = 0; i < rows; ++i, row += width, out += step) std::copy_n(row, kWidth ? kWidth : width, out);
  }

  const GridReader& reader_;
  const SetValue& value_;
  std::shared_ptr<Chunk> scratch_;
  std::vector<size_t> start_;  // of the changes of each layer
  std::vector<Change> changes_;
  std::vector<T> layer_;
};

Box intersect(const Box& a, const Box& b) {
  Box out;
  for (int d = 0; d < 3; ++d) {
    out.lo[d] = std::max(a.lo[d], b.lo[d]);
    out.hi[d] = std::min(a.hi[d], b.hi[d]);
  }
  return out;
}

template <class T>
Cells<T> cells_of(const Box& part, const Box& box, T* data, const Index3& stride) {
  Cells<T> out{data, {}, stride};
  for (int d = 0; d < 3; ++d) {
    out.data += (part.lo[d] - box.lo[d]) * stride[d];
    out.size[d] = part.hi[d] - part.lo[d];
  }
  return out;
}

// Fills `box` without `inside`, which lies in it.
template <class T>
void fill_around(const Box& inside, const Box& box, T value, T* data, const Index3& stride) {
  Box left = box;
  for (int d = 2; d >= 0; --d) {
    Box below = left, above = left;
    below.hi[d] = left.lo[d] = inside.lo[d];
    above.lo[d] = left.hi[d] = inside.hi[d];
    for (const Box& part : {below, above})
      if (!part.empty()) fill(cells_of(part, box, data, stride), value);
  }
}

}  // namespace

template <class T>
void read_box(const GridReader& reader, int level, const Box& box, const SetValue& value, T outside, T* data, const Index3& stride, int threads) {
  reader.meta().grid.check_level(level);
  if (box.empty()) return;
  const Box inside = intersect(box, reader.meta().grid.box(level));
  if (inside.empty()) return fill(cells_of(box, box, data, stride), outside);
  fill_around(inside, box, outside, data, stride);

  const RayFrame f = reader.meta().frame();
  const LevelShape shape = reader.shape(level);
  const auto cells_in = [&](const ChunkPart& p) {
    const Index3 first = {p.first_u + p.u0 - box.lo[f.u], p.first_v + p.v0 - box.lo[f.v], p.first_w + p.w0 - box.lo[f.w]};
    const Index3 step = {stride[f.u], stride[f.v], stride[f.w]};
    return Cells<T>{data + first[0] * step[0] + first[1] * step[1] + first[2] * step[2], {p.u1 - p.u0, p.v1 - p.v0, p.w1 - p.w0}, step};
  };
  std::vector<PartReader<T>> readers;
  for (int i = 0; i < std::max(1, threads); ++i) readers.emplace_back(reader, value);
  if (threads <= 1) return for_each_part(shape, RayBox(inside, f), [&](const ChunkPart& p) { readers[0].read(p, cells_in(p)); });
  std::vector<ChunkPart> parts;
  for_each_part(shape, RayBox(inside, f), [&](const ChunkPart& p) { parts.push_back(p); });
  size_t next = 0;
  in_order(
      std::min<int>(threads, static_cast<int>(std::min<size_t>(parts.size(), 1024))),
      [&] { return next < parts.size() ? std::optional(next++) : std::nullopt; },
      [&](size_t i, int worker) { return readers[static_cast<size_t>(worker)].read(parts[i], cells_in(parts[i])), i; }, [](size_t) {}, 16);
}
template void read_box(const GridReader&, int, const Box&, const SetValue&, uint8_t, uint8_t*, const Index3&, int);
template void read_box(const GridReader&, int, const Box&, const SetValue&, uint16_t, uint16_t*, const Index3&, int);
template void read_box(const GridReader&, int, const Box&, const SetValue&, uint32_t, uint32_t*, const Index3&, int);

}  // namespace teracell
