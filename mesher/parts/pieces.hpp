// A grid in pieces, which any number of processes make, one after another: each piece is a part (store/write/part.hpp) in a file of its own beside
// the output. How the grid is cut does not depend on the processes, so others can go on with what killed ones have left.
#pragma once
#include "mesher/parts/piece_queue.hpp"
#include "mesher/pipeline.hpp"
#include "mesher/run/casting.hpp"
#include "mesher/run/tiled_facets.hpp"
#include "store/write/part.hpp"

namespace teracell::mesher {

class Pieces {
 public:
  // `first`: this process reports what is found of the surfaces as a whole. Reads and closes the surfaces.
  Pieces(const Scene& scene, const std::filesystem::path& output, const MeshOptions& options, bool first, const Progress& progress,
         const std::atomic<bool>& stop);

  uint32_t size() const { return static_cast<uint32_t>(pieces_.size()); }
  const std::string& run() const { return run_id_; }  // the same for all processes that make pieces of this grid
  bool in_memory() const { return run_.bodies.in_memory; }  // all facets, so a home costs little however large it is
  uint64_t cost(uint32_t piece) const { return pieces_[piece].cost; }  // CostMap::Piece
  const Metadata& meta() const { return run_.plan.meta; }
  std::filesystem::path path(uint32_t piece) const;
  // Opens a piece that was made. Throws FormatError or IoError unless it is a whole one of this run.
  std::unique_ptr<PartReader> open(uint32_t piece) const;
  bool is_made(uint32_t piece) const;  // whether the file is there with the bytes that it was made with
  // Takes the facets of the home that an order names. make() does it where that was not done.
  void settle(const PieceQueue::Order& order);
  void make(const PieceQueue::Order& order);
  // To be called when nothing is to be made any more.
  void finish_counting();
  // The report of the whole grid. REQUIRES: `first`, and counting is finished.
  MeshReport report(const CastTotals& totals);
  void commit_caps() { run_.commit_caps(); }
  // Throws InputError if a whole piece of this output is there that another run has made: one that shall go on with it would lose it.
  void expect_own_files() const;
  // Removes files of pieces of this output, whoever made them, unless keep() wants the piece.
  void remove_files(const std::function<bool(uint32_t piece)>& keep) const;

 private:
  struct PieceFile {
    std::filesystem::path path;
    uint32_t piece, of;
    bool whole;
  };
  std::vector<PieceFile> files() const;  // of pieces of this output, whoever made them
  void settle(const TreeRange& home);
  std::optional<TileGroup> next_in(const TreeRange& range);

  const std::filesystem::path output_;
  PreparedRun run_;
  std::vector<CostMap::Piece> pieces_;
  std::string run_id_;
  TiledFacets facets_;
  TreeRange home_{1, 0};      // of the tiling
  uint64_t reached_ = 0;      // by the tiling, which goes forward only
  Tiling* tiling_ = nullptr;
  bool counting_ = false;     // the tiling counts facets
  std::optional<TileGroup> waiting_;  // the next group of the tiling, if it was taken already
  std::optional<Casting> casting_;
};

}  // namespace teracell::mesher
