// The caps of a scene's bodies as surface files: surface and caps together are closed and have the same cells.
#pragma once
#include <memory>

#include "mesher/bodies.hpp"
#include "store/file.hpp"

namespace teracell {

// Binary STL, or binary PLY in doubles for a path that ends in .ply. One file a body that has caps: `path` when the
// scene has one body, "stem-name.ext" when it has several. Nothing stands under these names until the files are
// committed. UsageError: another ending, or .stl for vertices that are doubles.
std::vector<std::unique_ptr<OutputFile>> write_caps(const Scene& scene, const Bodies& bodies, const std::filesystem::path& path);

}  // namespace teracell
