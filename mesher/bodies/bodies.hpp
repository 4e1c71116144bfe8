// The bodies of a scene: their surfaces are read, then closed, and each shell is given its fill rule.
#pragma once
#include <functional>
#include <memory>

#include "mesher/bodies/exact_surfaces.hpp"
#include "mesher/closing/closing.hpp"
#include "mesher/closing/surface_counts.hpp"
#include "mesher/compose/compose.hpp"
#include "mesher/planes/flat_faces.hpp"
#include "mesher/surface/read_facets.hpp"
#include "mesher/tiles/facet_store.hpp"
#include "mesher/tiles/piece_log.hpp"
#include "store/base/background.hpp"
#include "store/base/spill.hpp"

namespace teracell::mesher {

// Until patches are numbered (patches.hpp), a facet has the number of its patch in its file, and what closes a body has one of these.
inline constexpr uint32_t kCapPatch = kAddedFacet, kSidePatch = kAddedFacet | 1;

// Facets of a body in Bodies::log, as blocks of a FacetWelder (welded_records.hpp), in single precision if their file is.
struct LoggedFacets {
  PieceLog::Piece piece;
  uint32_t patch;
};

struct BodyFacets {
  SurfaceFile file;
  std::vector<double> areas;  // of file.patches, as the grid sees them
  uint64_t first = 0;  // when in memory: its facets are [first, first + file.facets) of Bodies::facets
  Vec3 lo, hi;         // the box of its vertices, as the grid sees them
  BoundaryProof boundary;
  bool repeats = false;                 // its tree does (part_tree.hpp)
  std::optional<SurfaceCounts> counts;  // then, if its shapes tell them (part_counts.hpp)
  std::vector<LoggedFacets> logged;     // all its facets in their order, or none: then they must be read again unless they are in memory
  SurfaceCounts facet_counts;           // if they were to be counted and all facets are in memory: without shells
  bool opposites = false;  // two facets of a sample have the same vertices and opposite orientations
  ClosedBody closed;       // by close_bodies()
  std::shared_ptr<const CadOptions> cad;  // of exact surfaces: how they became facets
  FlatFaces flat;                         // where planes are made
};

struct Bodies {
  bool in_memory = true;
  std::unique_ptr<FileFacets> facets = std::make_unique<FileFacets>();  // null once they were handed on to be tiled
  std::unique_ptr<PieceLog> log;  // null: no facets lie there
  std::vector<BodyFacets> bodies;
  Vec3 lo, hi;  // the box of all vertices, as the grid sees them
  Vec3 area{};  // of the facets' projections along x, y, z
  std::unique_ptr<KeptTrees> kept = std::make_unique<KeptTrees>();  // for bodies that take parts of the same files; for one thread

  // The shells of each body in memory. They decide no cell: they are counted beside the work, from the files' coordinates.
  std::shared_ptr<std::vector<uint64_t>> shells = std::make_shared<std::vector<uint64_t>>();
  std::unique_ptr<Background> helper;  // last: its jobs use the others
  std::vector<SurfaceCounts> wait_for_counts();  // one per body. REQUIRES: in_memory, and they were to be counted

  uint64_t facet_count() const;  // without the facets that close holes
  bool float32() const;          // every vertex was declared as float32
};

// Reads every mesh, on one thread or more. Facets are kept in memory as long as they fit into `budget`; if they don't, those that come in blocks are
// logged, where there is room and they are to be used `again`, and others must be read again then. `count`: whether to count what the surfaces in
// memory are made of. `progress` is
// called every few thousand facets with the bodies read so far, as a share of 1. The box is that of exact surfaces where they have one.
Bodies read_bodies(const Scene& scene, const ExactSurfaces& exact, int threads, const Budget& budget, bool count, bool again,
                   const std::function<void(double)>& progress);

// The flat faces of all bodies, for axes whose planes are made, as far as facets that are flat but for rounding were told while the bodies were
// read, when the extent of all was not known yet: they are looked at once more where that made a difference.
void complete_flat_faces(const Scene& scene, const Budget& budget, Bodies& bodies);

// Closes every solid (closing.hpp). The facets that this adds are appended to those in memory, except for walls.
void close_bodies(const Scene& scene, const Grid& grid, const Budget& budget, Bodies& bodies, const std::function<void(double)>& progress);

// Calls f with the facets of a body as its file has them: from memory, or from the file. REQUIRES: they were not handed on.
void for_each_facet(const SceneBody& body, const BodyFacets& found, const Bodies& bodies, const Budget& budget,
                    const std::function<void(const Facet&)>& f);
// Calls f with all facets, those that close surfaces included, as the grid sees them. REQUIRES: they were not handed on.
void for_each_placed(const Scene& scene, const Bodies& bodies, const Budget& budget, const std::function<void(const Facet&, uint32_t layer)>& f);
// Hands the facets of a piece of the log to the sink. For any thread.
void read_logged(const Bodies& bodies, const BodyFacets& found, const LoggedFacets& logged, const FacetSink& sink);
// Reads a body's file once more, in the units in which it was read. Throws InputError when the file has changed.
void read_again(const SceneBody& body, const BodyFacets& found, const FacetSink& sink, ReadOptions options);

}  // namespace teracell::mesher
