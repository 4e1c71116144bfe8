// A stream of facets out of a surface file: STL (binary, ASCII), OBJ, PLY (ASCII, binary both ways), each may be
// gzip-compressed. The format is told by content, never by name.
//
// Vertices are doubles that hold exactly what the file declares: ASCII STL and PLY `float` are rounded straight to
// float32, OBJ and PLY `double` to float64; -0 is +0. A coordinate that is not finite, beyond 1e75, or nonzero below
// 1e-75 is refused: within those limits the exact predicates neither overflow nor underflow.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "mesher/spill.hpp"
#include "store/grid.hpp"

namespace teracell {

class Background;

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

// Streams the facets of `path` into `sink`: those of the parts whose name matches the glob `part`, or all when it is
// empty. Polygons are fans from their first vertex. Memory is constant, but that OBJ and PLY keep their vertices: those
// beyond an eighth of the budget on disk, in its folder.
// A part of an OBJ is each of the groups (`g`) or the object (`o`) a facet is in; of an ASCII STL, the solid; what has no
// name has the name "". `*`, `?` and `[...]` as in fnmatch(3), case-sensitive.
// Throws InputError (file, line or byte offset, expected, found) or IoError. No facet at all is an InputError, and so is
// a `part` that nothing matches. A file of another kind is named as what it is. Facets before the fault have been given to the sink when it throws. What the sink throws
// passes through.
// `helper` may do part of the parsing; it may have other jobs.
SurfaceFile read_facets(const std::filesystem::path& path, const std::string& part, const FacetSink& sink, const Budget& budget = {}, Background* helper = nullptr);

// Throws InputError with `where` in front unless v may be a vertex coordinate; -0 becomes +0.
double checked_coordinate(double v, const std::string& where);

}  // namespace teracell
