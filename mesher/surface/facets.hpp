// A stream of facets out of a surface file: STL (binary, ASCII), OBJ, PLY (ASCII, binary both ways), each may be
// gzip-compressed. The format is told by content, never by name.
//
// Vertices are doubles that hold exactly what the file declares: ASCII STL and PLY `float` are rounded straight to
// float32, OBJ and PLY `double` to float64; -0 is +0. A coordinate that is not finite, beyond 1e75, or nonzero below
// 1e-75 is refused: within those limits the exact predicates neither overflow nor underflow.
#pragma once
#include <filesystem>
#include <string>

#include "mesher/surface/facet.hpp"
#include "mesher/surface/spill.hpp"

namespace teracell {

class Background;
class Input;

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
// The same over a file already opened, or over bytes in memory.
SurfaceFile read_facets(Input& input, const std::string& part, const FacetSink& sink, const Budget& budget = {}, Background* helper = nullptr);

}  // namespace teracell
