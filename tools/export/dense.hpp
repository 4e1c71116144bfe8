// Cells as a dense array of material ids in C order [z][y][x]: one byte per cell, or two, little endian, when there are
// more than 256 materials.
#pragma once
#include "store/file.hpp"
#include "tools/export/format.hpp"

namespace teracell {

// Appends the cells to `file`, one slab after another.
void append_dense_cells(const Export& e, OutputFile& file);

}  // namespace teracell
