// What surface files and assemblies hold, without a grid: their parts with sizes, volumes, and whether they are closed.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mesher/surface/facet.hpp"
#include "mesher/surface/read_options.hpp"
#include "store/base/spill.hpp"

namespace teracell::mesher {

// Parts of one shape, which are equal but for where they stand: of another scale they are another kind.
struct PartKind {
  std::string path;                      // of the first of them
  std::string product, color, material;  // color "#rrggbb" or "#rrggbbaa"; empty when the file states none
  uint64_t instances = 1;
  uint64_t facets = 0;       // of one of them, and so the rest
  bool closed = false;       // every edge is matched by its reverse, so the volume means something
  uint64_t open_edges = 0;   // directed edges without their reverse; 0 when closed
  Vec3 lo{}, hi{};           // of the first of them
  double volume = 0, area = 0;
  std::optional<double> kernel_volume, sender_volume;  // of exact surfaces: by the CAD kernel, and as the file says
};

// A part in the tree.
struct PartPlace {
  std::string path;
  size_t kind;  // in FileSurvey::kinds
};

struct FileSurvey {
  SurfaceFile file;  // its unit is that of all lengths here, if it states one
  bool tree = false;
  std::vector<PartKind> kinds;    // in the order of their first instances
  std::vector<PartPlace> places;  // of a tree, all parts in its order
  Vec3 lo{}, hi{};                // of all parts
};

// Reads the file once, and parts that are open a second time, to count their open edges. Throws as read_facets() does.
FileSurvey survey(const std::filesystem::path& path, const Budget& budget, const CadOptions& cad = {});

}  // namespace teracell::mesher
