// What the cells alone tell: walls, components, and the sides of the domain.
#pragma once
#include <functional>

#include "store/check/components.hpp"
#include "store/check/finding.hpp"
#include "store/check/options.hpp"
#include "store/check/thickness.hpp"

namespace teracell::inline store {

// Of a label.
struct LabelFacts {
  CellCount cells = 0;
  std::array<CellCount, kThickest / 2 - 1> thin{};  // cells of thickness 1 to 7, by the whole part
  uint32_t thinnest = kThickest;                // in half cells
  std::array<uint32_t, 3> thinnest_at{~0u, ~0u, ~0u};  // a cell of that thickness: by z, y, x
  Component at_sides;                           // its cells at the sides of the domain
  Component largest;                            // of its components
};

// The components with the most cells, and how many there are in all.
class LargestComponents {
 public:
  explicit LargestComponents(size_t most) : most_(most) {}
  void add(const Component& c);
  std::vector<Component> sorted() const;  // the largest first, equal ones by their first cells
  uint64_t number() const { return number_; }
  CellCount cells() const { return cells_; }

 private:
  const size_t most_;
  std::vector<Component> heap_;
  uint64_t number_ = 0;
  CellCount cells_ = 0;
};

struct CellFacts {
  std::vector<LabelFacts> labels;
  LargestComponents islands{kMostFindings};   // components of a label but its largest
  LargestComponents enclosed{kMostFindings};  // of the background, those that touch no side of the domain
  LargestComponents thin{kMostFindings};      // regions of a label's cells below CheckOptions::thin_cells
  LargestComponents narrow{kMostFindings};    // of the background's, below CheckOptions::narrow_cells
};

inline constexpr uint32_t kFewCells = 4;  // a region of fewer cells is a tip

// `sheets`: of each label, whether it is one of sheets alone. They have no walls.
CellFacts look_at_cells(const GridReader& reader, const std::vector<bool>& sheets, const CheckOptions& options,
                        const std::function<void(double share)>& progress);

}  // namespace teracell::store
