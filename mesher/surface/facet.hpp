// What a reader takes from a surface file: its facets, and facts about the file.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mesher/surface/cad_facts.hpp"
#include "mesher/surface/matrix.hpp"
#include "mesher/surface/units.hpp"
#include "store/grid/grid.hpp"

namespace teracell::mesher {

struct Facet {
  std::array<Vec3, 3> vertex;
};

// Half of the length of the facet's normal, with one rounding per operation, so that it is the same everywhere.
inline double area(const std::array<Vec3, 3>& p) {
  Vec3 a, b;
  for (int d = 0; d < 3; ++d) a[d] = p[1][d] - p[0][d], b[d] = p[2][d] - p[0][d];
  const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
  return std::sqrt((x * x + y * y) + z * z) / 2;
}
inline double area(const Facet& facet) { return area(facet.vertex); }

// What reading a surface file found, besides its facets.
struct SurfaceFile {
  std::string format;               // "STL (binary)", "STL (ASCII)", "OBJ", "PLY (ASCII)", "PLY (binary, little endian)"...
  uint64_t bytes = 0;               // of the file on disk
  std::string hash;                 // XXH3-128 of those bytes, 32 hex digits
  uint64_t facets = 0;              // passed to the sink
  bool float32 = true;              // the file declares the vertices passed to the sink as float32
  bool regular = true;              // the file can be read again: it is no pipe and no device
  std::string unit;                 // that the file states: m, cm, mm, um, nm, in or ft; empty when it states none
  Factor factor;                    // by which coordinates and translations were multiplied
  std::string units;                // that ReadOptions asked for
  std::shared_ptr<const CadFacts> cad;  // of a STEP file
  std::vector<CadPart> cad_parts;       // those passed to the sink
  // Names of STL solids, or of OBJ groups and objects, in the file's order, not only those that match; up to some megabytes.
  std::vector<std::string> parts;
  // Names of the patches that facets passed to the sink belong to, in the order of their first facets; "" where none is named.
  std::vector<std::string> patches;
  std::vector<std::string> warnings;  // what was skipped or tolerated: one sentence per kind, without the file's name
};

// Parts of a file that a body takes, and where it puts them.
struct TakenParts {
  std::string glob;
  Matrix matrix;
};

// Receives facets in the file's order, at most some thousands per call. The span is valid only during the call.
using FacetSink = std::function<void(std::span<const Facet>)>;

// Within these limits the exact predicates neither overflow nor underflow.
inline bool is_coordinate(double v) {
  const double size = std::abs(v);
  return v == 0 || (size >= 1e-75 && size <= 1e75);
}
// Returns v, with -0 as +0. Throws InputError, which begins with `where`, unless v is a coordinate.
double checked_coordinate(double v, const std::string& where);

// Throws the InputError for a file without facets, with its warnings.
[[noreturn]] void refuse_empty(const std::string& name, const SurfaceFile& file);

// Text from a file as messages show it: quoted, printable, at most a few dozen characters.
std::string shown(std::string_view text);

}  // namespace teracell::mesher
