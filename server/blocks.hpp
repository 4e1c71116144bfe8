// Blocks of cells as arrays of material ids: what the array protocols call chunks. A coarse cell is the strongest material
// of its set, the background 0.
#pragma once
#include <optional>
#include <span>
#include <string>

#include "server/service.hpp"
#include "store/slice.hpp"

namespace teracell {

// Whether an id takes two bytes.
inline bool wide_labels(const Metadata& meta) { return meta.materials.size() > 256; }

// The ids in `box`, x fastest, z slowest, little endian. Cells outside the level are 0.
std::string labels_in(const GridReader& reader, int level, const Box& box);

// Zarr cuts every level in cubes of this many cells, the last ones padded: one is a part of one stored chunk, by default.
inline constexpr int64_t kZarrCells = 64;
// The cube with this key, "z", "y", "x"; nothing when the level has no such cube.
std::optional<Box> zarr_cube(const Metadata& meta, int level, std::span<const std::string> key);

enum class Wrapping { kZlib, kGzip };
// At level 1: labels come in long runs, higher levels cost a multiple for a few per cent.
std::string deflated(std::string_view bytes, Wrapping wrapping);

// How a cube of Zarr is made.
Service::Recipe cube_recipe(const ServedGrid& grid, int level, const Box& cube, Wrapping wrapping);

}  // namespace teracell
