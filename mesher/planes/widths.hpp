// The largest width that cells may have along an axis, as a step function: that of the coarsest cell, and less where a box has a resolution of
// its own.
#pragma once
#include <vector>

namespace teracell::mesher {

// Cells that reach into [lo, hi] are at most so wide.
struct Resolution {
  double lo, hi, most;
};

struct WidthPiece {
  double lo, hi, most;
};

class Widths {
 public:
  // REQUIRES: lo < hi.
  Widths(double lo, double hi, double coarsest, const std::vector<Resolution>& resolutions);
  // Pieces that share their ends and cover [lo, hi], in order. Neighbours differ.
  const std::vector<WidthPiece>& pieces() const { return pieces_; }
  // Those of [lo, hi], cut at its ends.
  std::vector<WidthPiece> within(double lo, double hi) const;

 private:
  std::vector<WidthPiece> pieces_;
};

}  // namespace teracell::mesher
