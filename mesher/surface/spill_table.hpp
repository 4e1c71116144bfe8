// The vertices of a surface file by number, for formats whose facets refer to vertices, and the triangles of a file whose facets are needed
// more than once.
//
// Elements are kept in pieces. Each piece has one place in memory, a direct-mapped cache: its number modulo the number of
// places. While there are fewer pieces than places, all stay in memory. After that, a piece is written to a temporary file
// when another one needs its place, and is read back when it is needed. Facets mostly refer to vertices near those of the
// facet before, so this is rare. Pieces are small to make the worst case, vertices at random, bearable: 1 to 2 µs per vertex.
//
// The table grows piece by piece with its elements, not with the count in a header. Threads may share one that is in memory, to read from it.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "store/base/spill.hpp"
#include "store/grid/grid.hpp"

namespace teracell::mesher {

template <class T>
class SpillTable {
 public:
  // Takes at most an eighth of the budget, or kLeastBytes if that is more. Throws IoError when a temporary file is needed and the
  // folder can't hold it.
  static constexpr uint64_t kLeastBytes = uint64_t{1} << 22;
  explicit SpillTable(const Budget& budget);

  uint64_t size() const { return size_; }
  void push_back(const T& v) {
    if (size_ % kPiece == 0) begin_piece();
    Piece& piece = piece_of(size_);
    piece.changed = true;
    piece.elements[size_++ % kPiece] = v;
  }
  // Valid until the next call. REQUIRES: i < size().
  const T& operator[](uint64_t i) { return piece_of(i).elements[i % kPiece]; }
  // The same for several threads at once. REQUIRES: in_memory().
  const T& operator[](uint64_t i) const { return places_[i / kPiece]->elements[i % kPiece]; }
  bool in_memory() const { return size_ <= (last_place_ + 1) * kPiece; }
  uint64_t bytes_in_memory() const { return places_.size() * sizeof(Piece); }

 private:
  static constexpr uint64_t kPiece = 256;
  struct Piece {
    uint64_t number;
    uint64_t checksum;     // of the elements, while it is on disk
    bool changed = false;  // since it was written to disk
    std::array<T, kPiece> elements;
  };
  Piece& piece_of(uint64_t i) {
    Piece& piece = *places_[i / kPiece & last_place_];
    if (piece.number != i / kPiece) [[unlikely]]
      load(i / kPiece, piece);
    return piece;
  }
  void begin_piece();
  void load(uint64_t number, Piece& place);
  void make_room(Piece& place);

  const std::filesystem::path folder_;
  const uint64_t last_place_;  // the number of places, a power of two, minus one
  std::vector<std::unique_ptr<Piece>> places_;
  std::optional<SpillFile> file_;
  uint64_t size_ = 0;
};

using VertexTable = SpillTable<Vec3>;
using TriangleTable = SpillTable<std::array<uint32_t, 3>>;  // the numbers of vertices

}  // namespace teracell::mesher
