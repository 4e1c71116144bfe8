// What comes out of a surface file: facets, and what was found beside them.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "store/grid.hpp"

namespace teracell {

struct Facet {
  std::array<Vec3, 3> vertex;
};

// What reading a surface file found.
struct SurfaceFile {
  std::string format;               // "STL (binary)", "STL (ASCII)", "OBJ", "PLY (ASCII)", "PLY (binary, little endian)"...
  uint64_t bytes = 0;               // of the file as it lies on disk
  std::string hash;                 // XXH3-128 of those bytes, 32 hex digits
  uint64_t facets = 0;              // given to the sink
  bool float32 = true;              // every vertex given to the sink was declared as float32
  bool regular = true;              // a file that can be read again: no pipe, no device
  std::vector<std::string> parts;   // named STL solids, OBJ groups and objects, in the file's order; all, not only matches, up to some MB of names
  std::vector<std::string> warnings;  // what was skipped or put up with: a sentence for each kind of it, without the file's name
};

// Receives facets in the file's order, some thousands at a time. The span is valid during the call only.
using FacetSink = std::function<void(std::span<const Facet>)>;

// Within these limits the exact predicates neither overflow nor underflow.
inline bool is_coordinate(double v) {
  const double size = std::abs(v);
  return v == 0 || (size >= 1e-75 && size <= 1e75);
}
// Throws InputError with `where` in front unless v may be a vertex coordinate; -0 becomes +0.
double checked_coordinate(double v, const std::string& where);

}  // namespace teracell
