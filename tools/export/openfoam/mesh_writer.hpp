// Writes the cells, points and faces of a sweep into the files of their parts.
#pragma once
#include "tools/export/openfoam/mesh_files.hpp"

namespace teracell::exports::foam {

struct MeshOutput {
  std::function<std::filesystem::path(uint32_t part)> folder;  // of the part's polyMesh
  double scale;                                                // from the grid's units to metres
};

void write_mesh(const Division& division, const MeshCounts& counts, const MeshNames& names, const MeshOutput& output,
                const std::function<void(int64_t layers)>& progress);

}  // namespace teracell::exports::foam
