// Reads the meshes of OpenFOAM that were exported. Anything that is not as OpenFOAM writes it fails the test.
#pragma once
#include "store/grid/grid.hpp"
#include "tests/support/test.hpp"

namespace teracell::testing::foam {

// The numbers of a file that has nothing but a list.
std::vector<int32_t> labels_of(const std::filesystem::path& file);

struct Patch {
  std::string name, type;
  int64_t faces, start;
  int other = -1;  // of a processor patch
};

// The files of a folder polyMesh.
struct PolyMesh {
  explicit PolyMesh(const std::filesystem::path& folder);
  const Patch& patch_of(size_t face) const;

  std::vector<Vec3> points;
  std::vector<std::vector<int32_t>> faces;  // their corners
  std::vector<int32_t> owner, neighbour;
  std::vector<Patch> patches;
  std::map<std::string, std::vector<int32_t>> zones;
};

}  // namespace teracell::testing::foam
