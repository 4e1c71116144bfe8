// Cells as a dense array of numbers in C order [z][y][x], little endian: as many bytes per cell as the largest number needs, 1, 2 or 4.
#pragma once
#include "store/file.hpp"
#include "tools/export/format.hpp"

namespace teracell {

// Bytes per cell of arrays in which no number is larger than `most`.
constexpr size_t bytes_per_cell(uint32_t most) { return most < 256 ? 1 : most < 65536 ? 2 : 4; }

// Appends the cells to `file`, one slab after another.
void append_dense_cells(const Export& e, OutputFile& file);

}  // namespace teracell
