// What mixed cells are made of, read from a grid.
#pragma once
#include <functional>

#include "store/channels/fractions.hpp"
#include "store/read/cell_chunks.hpp"

namespace teracell::inline store {

using FractionCache = CellChunkCache<MixedCells>;

// Reads the fractions of a grid. Threads may share it. Throws IoError or FormatError, like its reader.
class FractionReader {
 public:
  // Keeps a reference to the reader. Without a cache, it has its own. Throws UsageError if the grid has no fractions.
  explicit FractionReader(const GridReader& reader, std::shared_ptr<FractionCache> cache = nullptr);

  const Subdivision& samples() const { return samples_; }
  // The mixed cells of a chunk of level 0.
  std::shared_ptr<const MixedCells> chunk(const ChunkKey& key) const { return chunks_.get(key); }

  // The sub-samples of each label in a mixed cell; empty if it is not mixed. REQUIRES: the cell lies in the grid.
  struct LabelCount {
    Label label;
    uint32_t sub_samples;
  };
  std::vector<LabelCount> cell(const Index3& cell) const;

  // Calls visit(first, length, labels, counts) for the mixed cells of a box: `length` cells from `first` on along the rays' axis that are alike.
  // Those of a ray come in order. REQUIRES: the box lies in the grid.
  using Visit = std::function<void(const Index3& first, int64_t length, std::span<const Label> labels, std::span<const uint32_t> counts)>;
  void for_each_mixed(const Box& box, const Visit& visit) const;

  // Writes the share of a material, from 0 to 1, in the cells of `box` to
  // data[(x - lo.x) * stride[0] + (y - lo.y) * stride[1] + (z - lo.z) * stride[2]]. The box may reach outside the grid: cells there get
  // `outside`. T is float or double; a float is the double, rounded once. REQUIRES: the material is one of the grid's.
  template <class T>
  void read_box(const Box& box, uint32_t material, T outside, T* data, const Index3& stride, int threads = 1) const;
  // The same of the mean of `values`, of which there is one for each material, weighted with the shares of the materials. Unlike a share, it
  // heeds the labels: a cell whose own material has no share in it, for example that of a sheet, has the value of its material. REQUIRES: the
  // box lies in the grid.
  void read_means(const Box& box, std::span<const double> values, double* data, const Index3& stride) const;

 private:
  enum class Strangers { kCounted, kOwn };  // what cells count as whose own material has no share in them
  template <class T>
  void read(const Box& box, std::span<const double> values, Strangers strangers, T outside, T* data, const Index3& stride, int threads) const;

  const GridReader& reader_;
  const CellChunks<MixedCells> chunks_;
  const Subdivision samples_;
};

}  // namespace teracell::store
