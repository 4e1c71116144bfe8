// Reads a surface file as a stream of facets. Formats: STL (binary, ASCII), OBJ, PLY (ASCII, binary in either byte order), OFF, 3MF, glTF and STEP,
// each plain or compressed by gzip. The format is recognised from the content, never from the name.
//
// Vertices are doubles that hold exactly what the file declares: numbers of an ASCII STL and PLY `float` are rounded once, to
// float32; numbers of an OBJ and PLY `double` are rounded once, to float64. -0 becomes +0. A coordinate that is not finite,
// above 1e75, or nonzero and below 1e-75 is refused: within these limits the exact predicates neither overflow nor underflow.
#pragma once
#include <filesystem>
#include <list>
#include <memory>
#include <string>
#include <unordered_map>

#include "mesher/surface/facet.hpp"
#include "mesher/surface/part_tree.hpp"
#include "mesher/surface/read_options.hpp"
#include "store/grid/report.hpp"

namespace teracell::mesher {

class Input;
struct SurfaceReader;

// A file with a tree that was read: its parts are read again without the file.
struct KeptTree {
  // Reads a file with a tree. Returns false for one without, of which nothing is read. Throws as read_facets() does.
  bool open(Input& input, const ReadOptions& options);
  void open(Input& input, const SurfaceReader& reader, const ReadOptions& options);
  std::string name, units;
  std::optional<double> deflection;  // of exact surfaces that became facets, and the angle
  double angle = 0;
  std::shared_ptr<PartTree> tree;
  SurfaceFile file;  // without what depends on the parts that are taken
  // For those who take its parts:
  uint64_t taken = 0;                                  // facets
  std::unordered_map<uint32_t, SurfaceCounts> counts;  // of shapes
};

// The trees that were used last, so that a file of which bodies take parts is read once.
class KeptTrees {
 public:
  // Null: it isn't kept.
  KeptTree* find(const std::string& name, const ReadOptions& options);
  // Those that were not used for longest go, while all of them take more than `bytes`.
  KeptTree& add(KeptTree&& tree, uint64_t bytes);
  // The one that was used last; null: none is kept.
  KeptTree* latest() { return trees_.empty() ? nullptr : &trees_.front(); }
  void clear() { trees_.clear(); }

 private:
  std::list<KeptTree> trees_;  // the one that was used last first
};

// Passes the facets of `path` to `sink`: those of the parts whose names match the glob `part`, or all when it is empty. A
// polygon becomes a fan of facets around its first vertex. Memory use is constant, except that OBJ and PLY keep their
// vertices; vertices beyond an eighth of the budget are kept on disk, in the budget's folder.
//
// In an OBJ, a facet belongs to the parts named by its groups (`g`) and by its object (`o`); in an ASCII STL, to its solid.
// What has no name has the name "". The first group names the patch of a facet; without one it is the object, or the solid. The glob knows `*`, `?`
// and `[...]` as in fnmatch(3), and is case-sensitive.
//
// Throws IoError or InputError (file, line or byte offset, expected, found). A file without facets is an InputError, and so is
// a `part` that nothing matches. For a file of another format, the message names that format. Facets before the fault have
// been passed to the sink. What the sink throws passes through.
//
// The same bytes and part give the same facets in the same order each time. The sink is called on the calling thread.
SurfaceFile read_facets(const std::filesystem::path& path, const std::string& part, const FacetSink& sink, const ReadOptions& options = {});
// The same for a file that is already open, or for bytes in memory.
SurfaceFile read_facets(Input& input, const std::string& part, const FacetSink& sink, const ReadOptions& options = {});

// Whether a file holds exact surfaces, of which facets are made: then options.cad says how. False for what is no regular file.
bool has_exact_surfaces(const std::filesystem::path& path);
// The box of the exact surfaces that bodies take of such a file, in options.units: its lower and its upper corner. None where no part matches.
std::optional<std::array<Vec3, 2>> exact_box(const std::filesystem::path& path, const std::vector<TakenParts>& taken, const ReadOptions& options);

// The unit that a file states: m, cm, mm, um, nm, in or ft. Empty where it states none, or is no regular file. Throws as above.
std::string stated_unit(const std::filesystem::path& path);
// That of the first file which states one, else m: of a grid of surfaces without a scene. `unsaid`, if not null, gets the first file that
// states none where another one does.
std::string first_stated_unit(const std::vector<std::filesystem::path>& paths, std::filesystem::path* unsaid = nullptr);

}  // namespace teracell::mesher
