// Cells of one material as boxes: runs that lie side by side become rectangles, and rectangles that lie on each other become boxes. It is
// greedy, and makes no more boxes than there are runs.
#pragma once
#include "tools/export/layer.hpp"

namespace teracell::exports {

// Coordinates count from the corner of the box that is exported.
struct MaterialBox {
  uint32_t material;
  std::array<int32_t, 3> lo, hi;
};

class BoxMerger {
 public:
  explicit BoxMerger(size_t most) : most_(most) {}
  // Takes the runs of the mesh in layer `z`. Layers come in ascending order, without a gap. Throws UsageError when there are more boxes than
  // `most`.
  void add(const Layer& layer, int32_t z);
  // All boxes, by material. Nothing may be added any more.
  std::vector<MaterialBox> finish();

 private:
  const size_t most_;
  std::vector<MaterialBox> done_, growing_;  // those that end before the last layer, and those that reach its end
};

}  // namespace teracell::exports
