// Which cells hang together through faces, found from layers of runs. A first pass calls add(), which learns which
// runs are joined. Each later pass calls keep(), which gives the runs the same labels once more and removes all regions but the largest.
//
// A label begins where a run touches none that was seen before. What is kept is 8 bytes per label and two layers, so surfaces of
// solids cost next to nothing, while random noise costs a byte or so per cell.
#pragma once
#include "tools/export/layer.hpp"

namespace teracell::exports::foam {

class Regions {
 public:
  void add(const Layer& layer);
  // All layers have been added. Of regions with equally many cells, the one that begins first is kept.
  void finish();
  // To be called before the first layer of each pass.
  void restart();
  // Takes the cells of other regions out of the mesh. REQUIRES: the layers come in the order in which they were added.
  void keep(Layer& layer);
  int64_t cells_kept() const { return -tree_[kept_]; }

 private:
  struct Piece {
    int32_t begin, end;
    uint32_t label;
  };
  struct Pieces {
    std::vector<Piece> all;
    std::vector<size_t> rows = {0};
  };
  static constexpr uint32_t kNone = ~uint32_t{0};

  void go_through(const Layer& layer, bool learn);
  void touch(std::span<const Piece> row, size_t& at, const CellRun& run, uint32_t& label, bool learn);
  void join(uint32_t& label, uint32_t other, bool learn);
  uint32_t root(uint32_t label);

  std::vector<int64_t> tree_;  // of labels: the parent, or the negative number of cells of a root
  Pieces before_, here_;       // the cells of the mesh in the last two layers
  uint32_t labels_ = 0, kept_ = kNone;
};

}  // namespace teracell::exports::foam
