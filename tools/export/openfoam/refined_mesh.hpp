// A refined mesh in OpenFOAM's files: counted, then written. Cells are numbered in Morton order; parts are consecutive cells.
#pragma once
#include "store/channels/link_reader.hpp"
#include "tools/export/openfoam/mesh_writer.hpp"
#include "tools/export/refined/leaf_points.hpp"

namespace teracell::exports::foam {

class RefinedMesh {
 public:
  // Counts and numbers the cells. Keeps references. Without links, walls are told apart by material. `drop`: only the largest region stays.
  RefinedMesh(const Export& e, const RefinedGrid& refined, const std::vector<bool>& in_mesh, const LinkReader* links, bool drop,
              const std::function<void(double share)>& progress);

  int64_t cells() const { return grid_.cells(); }
  // Numbers the points and counts the faces of parts, which begin at these cells.
  MeshCounts count(const PartBegins& begins, const std::function<void(double share)>& progress);
  // REQUIRES: what count() returned. Can be called once.
  void write(const MeshCounts& counts, const MeshNames& names, const MeshOutput& output, const std::function<void(double share)>& progress);

  // What a block has for one group of faces of a part, and for a part.
  struct GroupOut {
    FaceGroup group;
    std::vector<int32_t> corners, owner, neighbour;
    std::vector<uint8_t> sizes;  // corners of each face
  };
  struct PartOut {
    uint32_t part;
    std::vector<std::array<double, 3>> points;  // in the grid's units
    std::vector<int8_t> point_level, cell_level;
    std::vector<std::pair<uint32_t, std::vector<int32_t>>> zones;  // by material: cells
    std::vector<GroupOut> groups;
  };

 private:
  class Walls;
  class Block;
  std::vector<PartOut> make(const Index3& at, bool numbers) const;

  const Export& e_;
  const LinkReader* const links_;
  const int coarsest_;
  const MeshOfLeaves mesh_;
  LeafGrid grid_;
  PartBegins begins_;
  std::optional<LeafPoints> points_;
  std::map<Index3, std::vector<PartOut>> kept_;  // by block, of small meshes
};

}  // namespace teracell::exports::foam
