// The files of a polyMesh folder, laid out from counts. Lists are binary with labels of 32 bits and scalars of 64.
#pragma once
#include <optional>

#include "tools/export/openfoam/counts.hpp"
#include "tools/export/openfoam/streams.hpp"

namespace teracell::exports::foam {

// What 32-bit labels of OpenFOAM can hold: the largest number and longest list, and the faces of a mesh, whose lists of points are four times as
// long.
inline constexpr int64_t kMostLabel = (int64_t{1} << 31) - 1, kMostFaces = kMostLabel / 4;

struct NamedPatch {
  std::string name;
  std::string type;  // of OpenFOAM
};

// What a part of the mesh is called, and which patches and zones it has. All parts have the same, be they empty.
struct MeshNames {
  std::map<uint32_t, NamedPatch> patches;     // by what lies beyond
  std::map<uint32_t, std::string> zones;     // by material; empty: no zones
  std::optional<double> refined_from;        // of a refined mesh of cubes: the edge of the coarsest; 0 where cells aren't cubes
  bool addressing = false;                   // whether parts tell their numbers in the whole mesh, for reconstructPar
};

// Streams to the lists of one part of the mesh. Points, cells and faces of a group are put in their order.
class MeshFiles {
 public:
  struct Group {
    Group(Streams& streams, const Place& faces_at, const Place& owner_at) : faces(streams, faces_at), owner(streams, owner_at) {}
    Stream faces, owner;
    std::optional<Stream> begins;   // where each face's corners begin, unless each face has four
    int64_t corners = 0;            // where those of the next face do
    std::optional<Stream> address;  // in the whole mesh
  };

  // Makes the folder and all that does not depend on single cells.
  MeshFiles(const std::filesystem::path& folder, uint32_t part, const PartCounts& counts, const MeshNames& names, Streams& streams);
  void close();

  Group& group(FaceGroup g) { return groups_.at(g); }
  Stream& zone(uint32_t material) { return zones_.at(material); }
  std::optional<Stream> points, neighbour, point_address, cell_address, cell_level, point_level;

 private:
  std::map<FaceGroup, Group> groups_;
  std::map<uint32_t, Stream> zones_;
};

}  // namespace teracell::exports::foam
