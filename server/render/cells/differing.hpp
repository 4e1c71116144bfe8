// Which cells of a grid have another material in a second grid, by the names of materials, as `teracell diff` and the slices of the dashboard
// compare them.
//
// Where both have the same cells, each is compared with the same one of the other grid. Otherwise a cell differs where its material is
// nowhere in that cell of the other grid: so surfaces that lie within a cell of each other are the same. What the second grid does not reach
// does not differ.
#pragma once
#include <unordered_map>

#include "server/render/cells/numbered_cells.hpp"
#include "server/render/cells/visible.hpp"
#include "store/runs/change_numbers.hpp"

namespace teracell::server {

// What is looked at: a grid or, with a second one, the cells of it that differ there.
struct Viewed {
  const GridReader& reader;
  const GridReader* against;
  Viewed(const GridReader& r, const GridReader* other = nullptr) : reader(r), against(other) {}  // NOLINT(google-explicit-constructor)
};

// The labels of what differs: only the background is left, there was nothing but the background, or both have materials.
inline constexpr Label kCellRemoved = 0, kCellAdded = 1, kCellOther = 2, kDifferences = 3;

// Each thread has its own.
class Differing {
 public:
  // Keeps references. `damage`: as in Visible.
  Differing(const GridReader& a, const GridReader& b, bool damage);

  // Of a cell of the first grid, as Visible::of(): 0 where nothing differs, 1 + the label of what differs; kSeveral where finer cells may be of
  // several kinds, kAlike where both have the same materials, and only finer cells tell which are where. Of level 0 it is never one of these.
  static constexpr uint32_t kAlike = Visible::kDamaged - 1;
  uint32_t at(int level, const Index3& cell);
  // The materials of a cell of level 0, and those there in the second grid. REQUIRES: it differs.
  std::pair<std::vector<std::string>, std::vector<std::string>> names(const Index3& cell);
  // The cell of level 0 in a box nearest to `to` that has the first material, and there in the second grid the second one, as far as
  // nearest_cell() finds one. REQUIRES: the box is not empty.
  std::optional<Index3> nearest(const std::string& from, const std::string& into, const Index3& to, const Box& box);

 private:
  // Labels as sets of names.
  struct Numbering {
    static constexpr uint32_t kDamaged = Visible::kDamaged;
    const std::vector<MaterialName>& names;
    SetTable& sets;
    bool damage;
    bool shows_damage() const { return damage; }
    uint32_t of(Label label) const { return names[label]; }
    uint32_t of(const std::vector<Label>& set) const;
  };
  uint32_t there(int level, const Index3& cell);
  uint32_t compare(SetId here, SetId there, bool is_fine) const;
  bool has(SetId set, const std::string& name) const;

  const GridReader &a_, &b_;
  const bool equal_;  // whether both have the same cells
  const double scale_;  // from lengths of the first grid to those of the second one
  const MaterialNames names_;
  const MaterialName outside_;  // stands for what the second grid does not reach
  const MaterialName air_a_, air_b_;  // the backgrounds
  SetTable sets_;  // of names
  Numbering number_a_, number_b_;
  NumberedCells<const Numbering> cells_a_, cells_b_;
  std::unordered_map<uint64_t, uint32_t> known_[2];  // verdicts of two sets; [1] of level 0
};

}  // namespace teracell::server
