// Blocks of cells as arrays of material ids, which the array protocols call chunks. A coarse cell has the strongest material of its
// set; the background is 0.
#pragma once
#include <optional>
#include <span>
#include <string>

#include "server/service/deflate.hpp"
#include "server/service/service.hpp"
#include "store/read/query.hpp"

namespace teracell::server {

// The ids in `box`, x fastest, z slowest, written by put_labels(). Cells outside the level are 0.
std::string labels_in(const GridReader& reader, int level, const Box& box);

// Zarr divides every level into cubes with this many cells a side, padded at the edges. With the default sizes a cube lies in a
// single stored chunk.
inline constexpr int64_t kZarrCells = 64;
// The cube with the key "z", "y", "x", if the level has it.
std::optional<Box> zarr_cube(const Metadata& meta, int level, std::span<const std::string> key);

Service::Recipe cube_recipe(const ServedGrid& grid, int level, const Box& cube, Wrapping wrapping);

}  // namespace teracell::server
