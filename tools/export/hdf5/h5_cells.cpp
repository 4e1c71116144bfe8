#include "tools/export/hdf5/h5_cells.hpp"

#include <algorithm>
#include <unordered_map>

#include <zlib.h>

#include "store/read/query.hpp"

namespace teracell::exports {
namespace {

constexpr int64_t kReadAtOnce = 64 << 20, kChunkBytes = 256 << 10;
constexpr size_t kMostKept = 64;

// Everything below is in the order of the dataset: the last axis varies fastest.

// The size of a chunk: about equally many cells along each axis that has them.
Index3 chunk_of(const Index3& n, int64_t most_cells) {
  Index3 c = {1, 1, 1};
  while (c[0] * c[1] * c[2] * 2 <= most_cells) {
    int shortest = -1;
    for (int d = 2; d >= 0; --d)
      if (c[d] < n[d] && (shortest < 0 || c[d] < c[shortest])) shortest = d;
    if (shortest < 0) break;
    c[shortest] *= 2;
  }
  for (int d = 0; d < 3; ++d) c[d] = std::min(c[d], n[d]);
  return c;
}

// The size of what is read at once, about so many cells: whole chunks, as long as possible along the axes that vary fastest.
Index3 slab_of(const Index3& n, const Index3& chunk, int64_t cells) {
  Index3 slab = chunk;
  for (int d = 2; d >= 0; --d) {
    const int64_t others = slab[0] * slab[1] * slab[2] / chunk[d];
    slab[d] = std::min(n[d], chunk[d] * std::max<int64_t>(1, cells / (others * chunk[d])));
    if (slab[d] < n[d]) break;
  }
  return slab;
}

// As the filters shuffle and deflate of HDF5 do: first the first bytes of all numbers, then the second ones. Deflate alone takes 30 times as
// much for a chunk of some double.
template <class T>
Bytes compressed(const std::vector<T>& cells) {
  Bytes shuffled(cells.size() * sizeof(T));
  const auto* bytes = reinterpret_cast<const uint8_t*>(cells.data());
  for (size_t b = 0; b < sizeof(T); ++b)
    for (size_t i = 0; i < cells.size(); ++i) shuffled[b * cells.size() + i] = bytes[i * sizeof(T) + b];
  Bytes out(compressBound(shuffled.size()));
  uLongf used = out.size();
  if (compress2(out.data(), &used, shuffled.data(), shuffled.size(), Z_BEST_SPEED) != Z_OK) throw std::bad_alloc();
  out.resize(used);
  return out;
}

// A part of a slab.
template <class V>
struct Piece {
  const V* values;
  Index3 size, stride;

  template <class F>
  void for_each_row(const F& f) const {
    for (int64_t i = 0; i < size[0]; ++i)
      for (int64_t j = 0; j < size[1]; ++j) f(i, j, std::span(values + i * stride[0] + j * stride[1], static_cast<size_t>(size[2])));
  }
  bool uniform() const {
    bool same = true;
    for_each_row([&](int64_t, int64_t, std::span<const V> row) {
      uint16_t differences = 0;
      for (const V value : row) differences |= value != *values;
      same = same && differences == 0;
    });
    return same;
  }
};

// Compresses chunks of number(value); those of one value only once.
template <class T, class V, class Number>
class ChunkMaker {
 public:
  ChunkMaker(const Index3& size, const Number& number) : size_(size), number_(number), cells_(static_cast<size_t>(size[0] * size[1] * size[2])) {}

  // The chunk with the cells of the piece; those beyond it are of no account. It is valid until the next call.
  const Bytes& make(const Piece<V>& piece) {
    if (!piece.uniform()) {
      piece.for_each_row([&](int64_t i, int64_t j, std::span<const V> row) {
        T* out = cells_.data() + (i * size_[1] + j) * size_[2];
        for (const V value : row) *out++ = number_(value);
      });
      return last_ = compressed(cells_);
    }
    if (uniform_.size() == kMostKept) uniform_.clear();
    const auto [it, added] = uniform_.try_emplace(*piece.values);
    if (added) {
      std::ranges::fill(cells_, number_(*piece.values));
      it->second = compressed(cells_);
    }
    return it->second;
  }

 private:
  const Index3 size_;
  const Number& number_;
  std::vector<T> cells_;
  Bytes last_;
  std::unordered_map<V, Bytes> uniform_;
};

std::array<hsize_t, 3> sizes(const Index3& n) { return {static_cast<hsize_t>(n[0]), static_cast<hsize_t>(n[1]), static_cast<hsize_t>(n[2])}; }

template <class T>
H5Handle create(H5File& file, const char* name, const Index3& n, const Index3& chunk) {
  const H5Handle space(file.checked(H5Screate_simple(3, sizes(n).data(), nullptr), "describe a dataset"), H5Sclose);
  const H5Handle how = file.without_times();
  file.checked(H5Pset_chunk(how, 3, sizes(chunk).data()), "choose the size of chunks");
  if (sizeof(T) > 1) file.checked(H5Pset_shuffle(how), "choose shuffle");
  file.checked(H5Pset_deflate(how, Z_BEST_SPEED), "choose deflate");
  return {file.checked(H5Dcreate2(file.id(), name, h5_type<T>(), space, H5P_DEFAULT, how, H5P_DEFAULT), "create a dataset"), H5Dclose};
}

// Writes number(value) of the values that read(box, data, strides of its axes) finds, slab by slab. They are of type V, the numbers of type T.
template <class T, class V, class Read, class Number>
H5Handle write_chunks(H5File& file, const Export& e, const char* name, const AxisOrder& axis, const Read& read, const Number& number) {
  Index3 n;
  for (int d = 0; d < 3; ++d) n[d] = e.box.hi[axis[d]] - e.box.lo[axis[d]];
  const Index3 chunk = chunk_of(n, kChunkBytes / static_cast<int64_t>(sizeof(T))),
               slab = slab_of(n, chunk, kReadAtOnce / static_cast<int64_t>(sizeof(V)));
  H5Handle dataset = create<T>(file, name, n, chunk);
  ChunkMaker<T, V, Number> maker(chunk, number);
  const double cells = static_cast<double>(n[0]) * static_cast<double>(n[1]) * static_cast<double>(n[2]);
  double done = 0;
  std::vector<V> values;

  const auto for_each_part = [](const Index3& whole, const Index3& step, const auto& f) {
    for (int64_t i = 0; i < whole[0]; i += step[0])
      for (int64_t j = 0; j < whole[1]; j += step[1])
        for (int64_t k = 0; k < whole[2]; k += step[2])
          f(Index3{i, j, k}, Index3{std::min(step[0], whole[0] - i), std::min(step[1], whole[1] - j), std::min(step[2], whole[2] - k)});
  };
  for_each_part(n, slab, [&](const Index3& at, const Index3& size) {
    e.progress(done / cells);
    const Index3 stride = {size[1] * size[2], size[2], 1};
    Box box;
    Index3 stride_of_axis;
    for (int d = 0; d < 3; ++d) {
      box.lo[axis[d]] = e.box.lo[axis[d]] + at[d];
      box.hi[axis[d]] = box.lo[axis[d]] + size[d];
      stride_of_axis[axis[d]] = stride[d];
    }
    values.resize(static_cast<size_t>(size[0] * size[1] * size[2]));
    read(box, values.data(), stride_of_axis);
    for_each_part(size, chunk, [&](const Index3& from, const Index3& part) {
      const Bytes& bytes = maker.make({values.data() + from[0] * stride[0] + from[1] * stride[1] + from[2], part, stride});
      const auto place = sizes({at[0] + from[0], at[1] + from[1], at[2] + from[2]});
      file.checked(H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, place.data(), bytes.size(), bytes.data()), "write a chunk");
    });
    done += static_cast<double>(values.size());
  });
  e.progress(1);
  return dataset;
}

}  // namespace

template <class T>
H5Handle write_cells(H5File& file, const Export& e, const char* name, const AxisOrder& axis, const std::vector<T>& values) {
  const SetValue material = strongest_material(e.reader.meta());
  return write_chunks<T, uint16_t>(
      file, e, name, axis,
      [&](const Box& box, uint16_t* data, const Index3& stride) { read_box<uint16_t>(e.reader, e.level, box, material, 0, data, stride); },
      [&](uint16_t id) { return values[id]; });
}

H5Handle write_shares(H5File& file, const Export& e, const char* name, const AxisOrder& axis, uint32_t material, const FractionReader& shares) {
  return write_chunks<float, float>(
      file, e, name, axis, [&](const Box& box, float* data, const Index3& stride) { shares.read_box(box, material, 0.0F, data, stride); },
      [](float share) { return share; });
}

H5Handle write_means(H5File& file, const Export& e, const char* name, const AxisOrder& axis, const std::vector<double>& values,
                     const FractionReader& shares) {
  return write_chunks<double, double>(
      file, e, name, axis, [&](const Box& box, double* data, const Index3& stride) { shares.read_means(box, values, data, stride); },
      [](double mean) { return mean; });
}

template H5Handle write_cells(H5File&, const Export&, const char*, const AxisOrder&, const std::vector<uint8_t>&);
template H5Handle write_cells(H5File&, const Export&, const char*, const AxisOrder&, const std::vector<uint16_t>&);
template H5Handle write_cells(H5File&, const Export&, const char*, const AxisOrder&, const std::vector<uint32_t>&);
template H5Handle write_cells(H5File&, const Export&, const char*, const AxisOrder&, const std::vector<int16_t>&);
template H5Handle write_cells(H5File&, const Export&, const char*, const AxisOrder&, const std::vector<double>&);

}  // namespace teracell::exports
