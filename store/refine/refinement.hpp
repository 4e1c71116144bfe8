// How a grid is refined: the coarsest level, how many layers of cells lie around what is wanted fine, and what that is.
#pragma once
#include <string_view>
#include <vector>

#include "store/grid/metadata.hpp"

namespace teracell::inline store {

inline constexpr int kCoarsest = 16, kMostLayers = 100;
inline constexpr int kNoLevel = 127;  // wants nothing

// Interfaces are pairs of cells that share a face and differ in label. Both cells want the least level that anything says of them.
struct Refinement {
  int coarsest = 0;    // M
  int layers = 2;      // N
  int interfaces = 0;  // of the interfaces of which nothing else is said
  std::vector<int> of_materials;  // by material: of interfaces with one of its cells; empty or kNoLevel: nothing is said
  std::vector<int> of_patches;    // by patch: of interfaces on it
  std::vector<int> inside;        // by material: of all its cells
  struct Region {
    Box box;  // of level-0 cells
    int level;
  };
  std::vector<Region> boxes;  // of all their cells

  bool knows_patches() const { return !of_patches.empty(); }
};

// The selectors interface=L, patch:NAME=L, material:NAME=L, inside:NAME=L, box:X0,Y0,Z0,X1,Y1,Z1=L, separated by commas. A name
// may stand in double quotes, and must where it has a comma, an equal sign or a quote. The finest counts of what is said twice. Throws UsageError,
// which begins with "coarsest", "layers" or `want`, for what is not such a text, for names that the grid doesn't have, and for patches of a grid
// without links.
Refinement parse_refinement(const Metadata& meta, int coarsest, int layers, std::string_view wants, std::string_view want = "want");
// The same with "M,N" or "M", in messages `refine`.
Refinement parse_refinement(const Metadata& meta, std::string_view levels, std::string_view wants, std::string_view refine, std::string_view want);

}  // namespace teracell::store
