// A refined mesh in OpenFOAM's files: counted, then written. Cells are numbered in Morton order; parts are consecutive cells.
#pragma once
#include "store/channels/link_reader.hpp"
#include "tools/export/openfoam/mesh_writer.hpp"
#include "tools/export/refined/leaf_points.hpp"

namespace teracell::exports::foam {

class RefinedMesh {
 public:
  // Counts and numbers the cells. Keeps references. Without links, walls are told apart by material.
  RefinedMesh(const Export& e, const RefinedGrid& refined, const std::vector<bool>& in_mesh, const LinkReader* links,
              const std::function<void(double share)>& progress);

  int64_t cells() const { return grid_.cells(); }
  // Numbers the points and counts the faces of parts, which begin at these cells.
  MeshCounts count(const PartBegins& begins, const std::function<void(double share)>& progress);
  // REQUIRES: what count() returned.
  void write(const MeshCounts& counts, const MeshNames& names, const MeshOutput& output, const std::function<void(double share)>& progress) const;

 private:
  class Walls;
  class Block;

  const Export& e_;
  const LinkReader* const links_;
  const MeshOfLeaves mesh_;
  LeafGrid grid_;
  PartBegins begins_;
  std::optional<LeafPoints> points_;
};

}  // namespace teracell::exports::foam
