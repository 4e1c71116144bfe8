// Writes what closes a scene's bodies as surface files: stitches, caps and walls. Surface and these files together are closed and
// have the same cells.
#pragma once
#include <memory>

#include "mesher/bodies/bodies.hpp"
#include "store/base/output_file.hpp"

namespace teracell::mesher {

// The names of the files, one per body: `path` when the scene has one body, "stem-body.ext" when it has several, with a number
// where two would be the same. Throws UsageError unless `path` ends in .stl or .ply.
std::vector<std::filesystem::path> caps_names(const Scene& scene, const std::filesystem::path& path);

// Writes binary STL, or binary PLY in doubles. Each file holds what closes a body that was open, in the coordinates of the body's
// file; for a body with extruded loops it holds all of the body, in the grid's coordinates. Nothing stands under the names
// until the files are committed. Throws UsageError for .stl when the vertices are doubles.
std::vector<std::unique_ptr<OutputFile>> write_caps(const Scene& scene, const Bodies& bodies, const std::filesystem::path& path,
                                                    const Budget& budget);

}  // namespace teracell::mesher
