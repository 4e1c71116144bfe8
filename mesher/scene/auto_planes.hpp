// What a scene says where the planes of an axis are made for it: {"auto": {...}}. mesher/SCENES.md documents the keys.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "store/text/json_node.hpp"

namespace teracell::mesher {

// Cells within the box of a body, or of the bodies of a material.
struct CellsWithin {
  std::optional<double> step;      // none is wider
  std::optional<int64_t> across;   // so many across it, at least
  friend bool operator==(const CellsWithin&, const CellsWithin&) = default;
};

struct AutoPlanes {
  enum class Snap { kFaces, kThirds, kNone };
  double finest = 0, coarsest = 0, growth = 1.3;  // lengths in the grid's units
  Snap snap = Snap::kFaces;
  std::map<std::string, CellsWithin> resolution;  // by the name of a body or a material
  std::vector<double> fixed;                      // planes of the axis
  std::vector<std::string> metals;                // names of bodies and materials: `snap: thirds` is about them
  int64_t pad = 4;                                // cells of `coarsest` around the bodies' box, where the axis has no domain
  friend bool operator==(const AutoPlanes&, const AutoPlanes&) = default;
};

// Those of all axes (`fixed` has lists by axis), and those of one (`fixed` is a list). Throw UsageError.
std::array<AutoPlanes, 3> parse_auto_of_grid(const JsonNode& node);
AutoPlanes parse_auto_of_axis(const JsonNode& node);

// Planes are fixed where the domain, from lo to hi, isn't.
[[noreturn]] void refuse_fixed(int axis, double lo, double hi, double at);

// The same as JSON of one axis, which has a domain of its own or not.
Json normalised(const AutoPlanes& planes, bool has_domain);

}  // namespace teracell::mesher
