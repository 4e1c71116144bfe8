// Blocks of cells as arrays of material ids: what the array protocols call chunks. A coarse cell is the strongest material
// of its set, the background 0.
#pragma once
#include <optional>
#include <span>
#include <string>

#include "server/deflate.hpp"
#include "server/service.hpp"
#include "store/query.hpp"

namespace teracell {

// The ids in `box`, x fastest, z slowest, as put_labels has them. Cells outside the level are 0.
std::string labels_in(const GridReader& reader, int level, const Box& box);

// Zarr cuts every level in cubes of this many cells, the last ones padded: one is a part of one stored chunk, by default.
inline constexpr int64_t kZarrCells = 64;
// The cube with this key, "z", "y", "x"; nothing when the level has no such cube.
std::optional<Box> zarr_cube(const Metadata& meta, int level, std::span<const std::string> key);

// How a cube of Zarr is made.
Service::Recipe cube_recipe(const ServedGrid& grid, int level, const Box& cube, Wrapping wrapping);

}  // namespace teracell
