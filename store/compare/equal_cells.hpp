// Whether two grids have the same cells: each plane between them lies at the same place, to the last bit. Sample points may differ.
#pragma once
#include "store/read/reader.hpp"

namespace teracell::inline store {

// Throws InputError that names the first difference: the unit, or the axis and the line.
void expect_equal_cells(const GridReader& a, const GridReader& b);

}  // namespace teracell::store
