// Which patch of the boundary each facet belongs to, and how large the patches are.
#pragma once
#include "mesher/bodies/bodies.hpp"
#include "store/grid/metadata.hpp"

namespace teracell::mesher {

// The patches of a grid (metadata.hpp): the sides of the domain, then for each body those of its file in the order of their first facets, that
// of what closes it, and that of its extruded walls. Names that several bodies have are preceded by that of the body. What a file has no room
// for is not told apart: it belongs to the body's own patch; or, if there are too many bodies even for that, there are the sides alone.
class Patches {
 public:
  // REQUIRES: the bodies are closed, and their facets were not handed on.
  Patches(const Scene& scene, const Bodies& bodies, const Grid& grid);

  const std::vector<PatchInfo>& all() const { return all_; }
  bool whole() const { return whole_; }  // whether all patches are told apart
  // What SceneFacet holds for a facet: the number in all() of its patch, or one beyond all(), and kAddedFacet. `patch` as it was read.
  uint32_t of(uint32_t body, uint32_t patch) const;

 private:
  struct OfBody {
    std::vector<uint32_t> of_file;
    uint32_t cap = kNoPatch, side = kNoPatch;
  };
  std::vector<PatchInfo> all_;
  bool whole_ = true;
  std::vector<OfBody> bodies_;
};

}  // namespace teracell::mesher
