// Cells as a dense array of numbers in C order [z][y][x], little endian: as many bytes per cell as the largest number needs, 1, 2 or 4.
#pragma once
#include <span>

#include "store/base/output_file.hpp"
#include "tools/export/format.hpp"

namespace teracell::exports {

// Bytes per cell of arrays in which no number is larger than `most`.
constexpr size_t bytes_per_cell(uint32_t most) { return most < 256 ? 1 : most < 65536 ? 2 : 4; }

// Returns f(0), whose argument has the type of such numbers.
template <class F>
auto with_number(size_t bytes_per_cell, F&& f) {
  if (bytes_per_cell == 1) return f(uint8_t{0});
  if (bytes_per_cell == 2) return f(uint16_t{0});
  return f(uint32_t{0});
}

// Appends the cells to `file`, one slab after another.
void append_dense_cells(const Export& e, OutputFile& file);

// The axes of an array, the one in which neighbours are farthest apart first.
using AxisOrder = std::array<int, 3>;
inline constexpr AxisOrder kXFastest = {2, 1, 0}, kZFastest = {0, 1, 2};

// Hands over the box in this order, one slab after another: its part, the strides of its axes in an array, and how many cells it has. An
// array with `bytes` for each of them has a bounded size.
void for_each_slab(const Export& e, const AxisOrder& order, size_t bytes,
                   const std::function<void(const Box& part, const Index3& stride, size_t cells)>& take);
// The same with the cells. T is uint8_t, uint16_t or uint32_t.
template <class T>
void for_each_slab(const Export& e, const AxisOrder& order, const std::function<void(std::span<const T>)>& take);

}  // namespace teracell::exports
