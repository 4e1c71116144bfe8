// The XML around the cells in a file of VTK: .vti for uniform axes, .vtr for graded ones, with raw appended data.
#pragma once
#include <span>
#include <string>

#include "store/grid/metadata.hpp"

namespace teracell::inline store {

// All planes of a graded grid stand in the header, so this many, 8 MB, are the most along an axis. Throws UsageError when a box has more.
inline constexpr int64_t kMostVtkPlanes = int64_t{1} << 20;
void expect_few_planes(const Index3& cells);

struct VtkGrid {
  Index3 cells;
  Vec3 origin, step;                           // of uniform axes
  std::array<std::vector<double>, 3> planes;   // of a graded grid; empty: none
  std::span<const MaterialInfo> materials;     // whose names are written; empty: none
  std::vector<std::string> shares = {};        // names of more arrays, of floats
};

// The names of materials by id, as a field of the file.
std::string vtk_names(std::span<const MaterialInfo> materials);
// What stands before the cells, which have `bytes` bytes each, little endian, x fastest. Each array of floats follows as its length in bytes
// (vtk_count) and its numbers, in the same order.
std::string vtk_header(const VtkGrid& grid, size_t bytes);
std::string vtk_count(uint64_t bytes);
inline constexpr char kVtkFooter[] = "\n</AppendedData>\n</VTKFile>\n";

}  // namespace teracell::store
