// What mixed cells are made of, read from a grid.
#pragma once
#include <functional>

#include "store/fractions.hpp"
#include "store/lru_cache.hpp"
#include "store/reader.hpp"

namespace teracell {

// Reads the fractions of a grid. Threads may share it. Throws IoError or FormatError, like its reader.
class FractionReader {
 public:
  // Keeps a reference to the reader, and up to `bytes` of chunks. Throws UsageError if the grid has no fractions.
  explicit FractionReader(const GridReader& reader, size_t bytes = size_t{32} << 20);

  const Subdivision& samples() const { return samples_; }
  // The mixed cells of a chunk of level 0.
  std::shared_ptr<const MixedCells> chunk(const ChunkKey& key) const;

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
  // The same of the mean of `values`, of which there is one for each material, weighted with the shares of the materials.
  template <class T>
  void read_means(const Box& box, std::span<const double> values, T outside, T* data, const Index3& stride, int threads = 1) const;

 private:
  const GridReader& reader_;
  const Channel& channel_;
  const Subdivision samples_;
  mutable LruCache<ChunkKey, MixedCells, ChunkKeyHash> chunks_;
};

}  // namespace teracell
