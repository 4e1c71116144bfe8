// What closes a scene's bodies, stitches, caps and walls, as surface files: surface and these together are closed and have
// the same cells.
#pragma once
#include <memory>

#include "mesher/bodies.hpp"
#include "store/file.hpp"

namespace teracell {

// The names of the files, one a body: `path` when the scene has one body, "stem-body.ext" when it has several, numbered
// where that is no name of its own. UsageError unless `path` ends in .stl or .ply.
std::vector<std::filesystem::path> caps_names(const Scene& scene, const std::filesystem::path& path);

// Binary STL, or binary PLY in doubles: what closes each body that was open, in its file's coordinates; with extruded loops
// all of the body, in the grid's. Nothing stands under the names until the files are committed. UsageError for .stl when
// the vertices are doubles.
std::vector<std::unique_ptr<OutputFile>> write_caps(const Scene& scene, const Bodies& bodies, const std::filesystem::path& path, const Budget& budget);

}  // namespace teracell
