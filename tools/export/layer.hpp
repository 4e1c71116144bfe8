// The cells of a box as runs along x, one layer of z after another. Nothing here grows with the number of cells.
#pragma once
#include <span>

#include "tools/export/place.hpp"

namespace teracell::exports {

// Beside a material, what a run can be: the outside of the box beyond its side xmin, xmax, ymin, ymax, zmin or zmax.
inline constexpr uint32_t kSides = 65536;

// A run of cells along x that are alike. Coordinates count from the box's lower corner.
struct CellRun {
  int32_t begin, end;
  uint32_t what;        // a material, or a side from kSides on
  uint32_t part = 0;    // the part of the mesh that has these cells
  int64_t first = -1;   // number of the first cell among those of all parts; negative: these are not cells of the mesh
  bool in_mesh() const { return first >= 0; }
  int64_t number(int64_t x) const { return first + (x - begin); }
};

// All rows of a layer. Each row is covered by its runs.
struct Layer {
  std::vector<CellRun> runs;
  std::vector<size_t> rows = {0};  // where each row begins, and the end
  std::span<const CellRun> row(int64_t y) const { return std::span(runs).subspan(rows[y], rows[y + 1] - rows[y]); }
  void clear() { runs.clear(), rows.assign(1, 0); }
};

// The same export for reading layers. LayerReader calls `progress` for each part of a layer, because a layer may take long. It does
// not know what share of all is done, so it tells 0; the share that `e` is told never falls.
Export for_layers(const Export& e);

// Reads layers in ascending order. Runs that are to be cells of the mesh get the number 0.
class LayerReader {
 public:
  // `in_mesh` says for each material whether its cells belong to the mesh. Both are kept by reference.
  LayerReader(const Export& e, const std::vector<bool>& in_mesh);
  void read(int64_t z, Layer& out);

 private:
  void read_part(const Box& part);
  void append_row(const uint16_t* cells, int64_t x, int64_t count, Layer& out) const;

  const Export& e_;
  const std::vector<bool>& in_mesh_;
  const Index3 size_;
  const SetValue material_;
  int64_t columns_, rows_, layers_;  // of what is read at once
  int64_t from_ = 0, to_ = 0;        // the layers in slab_, where whole layers fit
  std::vector<uint16_t> slab_;
};

}  // namespace teracell::exports
