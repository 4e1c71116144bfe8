// A pass over the cells of the mesh in their order, x fastest: the points of each layer and the cells between them, with what lies
// beyond their six faces. Two layers of points and three of cells are in memory, as runs.
#pragma once
#include "store/channels/link_reader.hpp"
#include "tools/export/layer.hpp"
#include "tools/export/openfoam/regions.hpp"

namespace teracell::exports::foam {

// How the cells of the mesh are found and divided.
struct Division {
  const Export& e;
  std::vector<bool> in_mesh;        // by material
  Regions* regions = nullptr;       // if not null: only the cells that it keeps
  std::vector<int64_t> part_begin;  // numbers of the first cells of all parts, and the end
  const LinkReader* links = nullptr;  // if not null: walls are told apart by the patches of the surface
};

// What lies beyond a face at the rim of the mesh: a material or a side of the box (layer.hpp), or from here on a patch of the surface.
inline constexpr uint32_t kSurface = kSides + 6;

// Consecutive points along x that one part has. Coordinates count planes from the box's lower corner.
struct PointRun {
  uint32_t part;
  int32_t begin, end;  // both have a point
  int64_t first;       // number of the first one in its part
};

// The points of a plane across z. Rows are sorted by part, then along x.
struct PointPlane {
  std::vector<PointRun> runs;
  std::vector<size_t> rows = {0};
  // The number of the point (x, y) in a part. REQUIRES: the part has it.
  int64_t number(uint32_t part, int64_t x, int64_t y) const;
};

enum Direction { kXUp, kYUp, kZUp, kXDown, kYDown, kZDown };

// Cells of a run that have the same beyond them in y and z.
struct Segment {
  int64_t begin, end, y, z;
  const CellRun* run;
  const CellRun* beyond[6];  // by Direction; in x nullptr where the run goes on
  uint32_t what[6];          // that is, if it isn't cells of the mesh
  const PointPlane* planes;  // the lower and the upper one
};

class MeshVisitor {
 public:
  virtual ~MeshVisitor() = default;
  // `number` is that of the first point among the points of all parts.
  virtual void points(const PointRun& run, int64_t y, int64_t z, int64_t number) = 0;
  virtual void segment(const Segment& s) = 0;
};

// A sweep calls points() for a plane before segment() for the cells above and below it. `progress` is told the layers that are done.
void sweep(const Division& division, MeshVisitor& visitor, const std::function<void(int64_t layers)>& progress);

}  // namespace teracell::exports::foam
