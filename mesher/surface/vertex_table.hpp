// The vertices of a surface file by number, for the readers of formats whose facets name vertices (OBJ, PLY).
//
// Vertices lie in pieces, and a piece has one place in memory where it may be: its number modulo the number of places.
// While there are fewer pieces than places, all stay; then a piece goes to a temporary file when another one needs its
// place, and comes back when it is asked for. Facets mostly name vertices near those that the facet before named, so
// they rarely meet elsewhere. Small pieces make the worst case, vertices named at random, bearable: 1 to 2 µs each.
//
// Grows piece by piece as vertices come: never on the word of a header. Not to be shared by threads.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "mesher/surface/spill.hpp"
#include "store/grid.hpp"

namespace teracell {

class VertexTable {
 public:
  // Takes up to an eighth of the budget, or kLeastBytes. Throws IoError when the folder is needed and of no use.
  static constexpr uint64_t kLeastBytes = uint64_t{1} << 22;
  explicit VertexTable(const Budget& budget);

  uint64_t size() const { return size_; }
  void push_back(const Vec3& v) {
    if (size_ % kPiece == 0) begin_piece();
    Piece& piece = piece_of(size_);
    piece.changed = true;
    piece.vertices[size_++ % kPiece] = v;
  }
  // Valid until the next call. REQUIRES: i < size().
  const Vec3& operator[](uint64_t i) { return piece_of(i).vertices[i % kPiece]; }

 private:
  static constexpr uint64_t kPiece = 256;
  struct Piece {
    uint64_t number;
    uint64_t checksum;  // of the vertices, while it is on disk
    bool changed = false;  // since it was on disk
    std::array<Vec3, kPiece> vertices;
  };
  Piece& piece_of(uint64_t i) {
    Piece& piece = *places_[i / kPiece & last_place_];
    if (piece.number != i / kPiece) [[unlikely]] load(i / kPiece, piece);
    return piece;
  }
  void begin_piece();
  void load(uint64_t number, Piece& place);
  void make_room(Piece& place);

  const std::filesystem::path folder_;
  const uint64_t last_place_;  // their number, a power of two, less one
  std::vector<std::unique_ptr<Piece>> places_;
  std::optional<SpillFile> file_;
  uint64_t size_ = 0;
};

}  // namespace teracell
