// Which process makes which piece of a grid. Where facets are spilled, each has a home, a stretch of pieces, so that it needs only the facets
// there. One whose home is done takes the second half of what is left of another's: the one that has most left. Processes with all facets in
// memory share a home. Then pieces are made in their order, so they can be put into the file while others are made.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace teracell::mesher {

class PieceQueue {
 public:
  struct Order {
    uint32_t piece;
    uint32_t first, end;  // the home that it lies in, as pieces
  };
  // `pieces`: those that are to be made, in order; by last_by_cost() if there is one home.
  PieceQueue(std::vector<uint32_t> pieces, uint32_t homes);
  // The next piece for one that lives there; none when all were handed out. The pieces of a home are handed out in order.
  std::optional<Order> next(uint32_t home);
  size_t left() const { return left_; }  // pieces that were not handed out

 private:
  struct Home {
    size_t at, end;     // in pieces_, of what is left
    uint32_t first, last;  // pieces
  };
  Home between(size_t from, size_t to) const;
  const std::vector<uint32_t> pieces_;
  std::vector<Home> homes_;
  size_t left_;
};

// Puts the last pieces into the order of their cost, the costliest first, as many as there are processes. So all end at about the same time.
void last_by_cost(std::vector<uint32_t>& pieces, size_t processes, const std::function<uint64_t(uint32_t piece)>& cost);

}  // namespace teracell::mesher
