// How many cells, points and faces each part of the mesh has. With them every place in its files is known before the first is written.
#pragma once
#include <map>

#include "tools/export/openfoam/sweep.hpp"

namespace teracell::exports::foam {

// Faces of a part that lie together in its list, in this order: those between two of its cells; those of a patch, by what lies beyond;
// those shared with another part. Both parts list shared faces in the order of the lower part's cells.
using FaceGroup = int64_t;
inline constexpr FaceGroup kInner = -1, kShared = FaceGroup{1} << 20;
constexpr FaceGroup shared_with(uint32_t part) { return kShared + part; }

struct PartCounts {
  int64_t cells = 0, points = 0;
  std::map<FaceGroup, int64_t> faces;
  std::map<FaceGroup, int64_t> corners;  // of all faces of a group; empty: each face has four
  std::map<uint32_t, int64_t> zones;     // cells of each material
  int64_t all_faces() const;
  int64_t corners_of(FaceGroup group) const;
  int64_t all_corners() const;
};

struct MeshCounts {
  std::vector<PartCounts> parts;
  // Of the mesh as a whole. A face that two parts share is one of the inner faces.
  int64_t cells = 0, points = 0, inner = 0;
  std::map<uint32_t, int64_t> patches;
  int64_t all_faces() const;
};

MeshCounts count(const Division& division, const std::function<void(int64_t layers)>& progress);

}  // namespace teracell::exports::foam
