#include "server/render/cells/differing.hpp"

#include <algorithm>
#include <functional>

#include "store/base/error.hpp"
#include "store/compare/equal_cells.hpp"
#include "store/grid/space.hpp"
#include "store/read/nearest.hpp"

namespace teracell::server {
namespace {

constexpr double kSamePlane = 1e-9;  // of a cell: planes that are nearer differ by the rounding of another unit

bool has_equal_cells(const GridReader& a, const GridReader& b) try {
  expect_equal_cells(a, b);
  return true;
} catch (const InputError&) {
  return false;
}

double scale_between(const std::string& from, const std::string& to) {
  const auto a = nanometres_of(from), b = nanometres_of(to);
  return a && b ? *a / *b : 1;
}

MaterialName after_all(const MaterialNames& names) {
  MaterialName out = 0;
  for (const auto* const all : {&names.of_a, &names.of_b})
    for (const MaterialName name : *all) out = std::max(out, name + 1);
  return out;
}

// The background is material 0.
MaterialName background(const Metadata& meta, const std::vector<MaterialName>& names, MaterialName none) {
  const auto it = std::ranges::find(meta.labels, 0u, &LabelInfo::material);
  return it == meta.labels.end() ? none : names[static_cast<size_t>(it - meta.labels.begin())];
}

}  // namespace

Differing::Differing(const GridReader& a, const GridReader& b, bool damage)
    : a_(a),
      b_(b),
      equal_(has_equal_cells(a, b)),
      scale_(scale_between(a.meta().units, b.meta().units)),
      names_(a.meta(), b.meta()),
      outside_(after_all(names_)),
      air_a_(background(a.meta(), names_.of_a, outside_)),
      air_b_(background(b.meta(), names_.of_b, outside_)),
      sets_(outside_ + 1),
      number_a_{names_.of_a, sets_, damage},
      number_b_{names_.of_b, sets_, damage},
      cells_a_(a, number_a_),
      cells_b_(b, number_b_) {}

uint32_t Differing::Numbering::of(const std::vector<Label>& set) const {
  std::vector<Label> out;
  for (const Label label : set) out.push_back(names[label]);
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return sets.intern(out);
}

// The names in that cell of the second grid; above level 0 perhaps more: those of at most two coarse cells along each axis.
uint32_t Differing::there(int level, const Index3& cell) {
  if (equal_) return cells_b_.at(level, cell);
  Index3 from, to;
  int coarse = 0;
  bool reaches = true;
  for (int d = 0; d < 3; ++d) {
    const Axis &here = a_.meta().grid.axis[d], &axis = b_.meta().grid.axis[d];
    double lo = here.plane(cell[d] << level) * scale_, hi = here.plane(std::min((cell[d] + 1) << level, here.cells())) * scale_;
    const double rounding = kSamePlane * (hi - lo);
    lo += rounding, hi -= rounding;
    if (hi <= axis.min() || lo >= axis.max()) return outside_;
    reaches = reaches && lo >= axis.min() && hi <= axis.max();
    from[d] = axis.cell_at(std::max(lo, axis.min())), to[d] = axis.cell_at(std::min(hi, axis.max()));
    while ((to[d] >> coarse) - (from[d] >> coarse) > 1) ++coarse;
  }
  while (!b_.stored(coarse) && coarse + 1 < b_.levels()) ++coarse;
  // Of the cells of level 0 from `from` to `to`, as far as they lie in a coarse one.
  const std::function<uint32_t(int, const Index3&)> names_between = [&](int above, const Index3& c) {
    uint32_t set = cells_b_.at(above, c);
    if (above == 0 || set < sets_.labels() || set == Visible::kDamaged) return set;
    bool is_whole = true;
    Box box;
    for (int d = 0; d < 3; ++d) {
      const int64_t lo = c[d] << above, hi = std::min((c[d] + 1) << above, b_.meta().grid.axis[d].cells());
      is_whole = is_whole && from[d] <= lo && hi <= to[d] + 1;
      box.lo[d] = std::max(from[d], lo) >> (above - 1), box.hi[d] = ((std::min(to[d] + 1, hi) - 1) >> (above - 1)) + 1;
    }
    if (is_whole) return set;
    set = ~uint32_t{0};
    Index3 finer;
    for (finer[2] = box.lo[2]; finer[2] < box.hi[2]; ++finer[2])
      for (finer[1] = box.lo[1]; finer[1] < box.hi[1]; ++finer[1])
        for (finer[0] = box.lo[0]; finer[0] < box.hi[0]; ++finer[0]) {
          const uint32_t one = names_between(above - 1, finer);
          if (one == Visible::kDamaged) return one;
          set = set == ~uint32_t{0} ? one : sets_.unite(set, one);
        }
    return set;
  };
  uint32_t out = reaches ? ~uint32_t{0} : outside_;
  Index3 at;
  for (at[2] = from[2] >> coarse; at[2] <= to[2] >> coarse; ++at[2])
    for (at[1] = from[1] >> coarse; at[1] <= to[1] >> coarse; ++at[1])
      for (at[0] = from[0] >> coarse; at[0] <= to[0] >> coarse; ++at[0]) {
        const uint32_t one = level > 0 ? cells_b_.at(coarse, at) : names_between(coarse, at);
        if (one == Visible::kDamaged) return one;
        out = out == ~uint32_t{0} ? one : sets_.unite(out, one);
      }
  return out;
}

uint32_t Differing::at(int level, const Index3& cell) {
  const uint32_t a = cells_a_.at(level, cell), b = a == Visible::kDamaged ? a : there(level, cell);
  if (b == Visible::kDamaged) return b;
  if (a == b) return a < sets_.labels() ? 0 : kAlike;
  const auto [known, is_new] = known_[level == 0].try_emplace(uint64_t{a} << 32 | b);
  if (is_new) known->second = compare(a, b, level == 0);
  return known->second;
}

uint32_t Differing::compare(SetId here, SetId there, bool is_fine) const {
  const std::vector<MaterialName> a = sets_.members(here);
  std::vector<MaterialName> b = sets_.members(there);
  const bool reaches = std::erase(b, outside_) == 0;
  if (b.empty()) return 0;
  const auto has = [](const std::vector<MaterialName>& set, MaterialName name) { return std::binary_search(set.begin(), set.end(), name); };
  const auto is_only = [](const std::vector<MaterialName>& set, MaterialName name) { return set.size() == 1 && set[0] == name; };
  if (std::ranges::any_of(a, [&](MaterialName name) { return has(b, name); })) return is_fine ? 0 : Visible::kSeveral;
  if (!is_fine && !reaches) return Visible::kSeveral;
  if (is_only(a, air_a_)) return 1 + kCellAdded;
  if (is_only(b, air_b_)) return 1 + kCellRemoved;
  return is_fine || (!has(a, air_a_) && !has(b, air_b_)) ? 1 + kCellOther : Visible::kSeveral;
}

std::pair<std::vector<std::string>, std::vector<std::string>> Differing::names(const Index3& cell) {
  std::pair<std::vector<std::string>, std::vector<std::string>> out;
  for (const MaterialName name : sets_.members(cells_a_.at(0, cell))) out.first.push_back(names_[name]);
  for (const MaterialName name : sets_.members(there(0, cell)))
    if (name != outside_) out.second.push_back(names_[name]);
  return out;
}

bool Differing::has(SetId set, const std::string& name) const {
  const std::vector<MaterialName> names = sets_.members(set);
  return std::any_of(names.begin(), names.end(), [&](MaterialName one) { return one != outside_ && names_[one] == name; });
}

std::optional<Index3> Differing::nearest(const std::string& from, const std::string& into, const Index3& to, const Box& box) {
  const auto changes = [&](int level, const Index3& cell) {
    const uint32_t a = cells_a_.at(level, cell), b = a == Visible::kDamaged ? a : there(level, cell);
    return b != Visible::kDamaged && has(a, from) && has(b, into);
  };
  return nearest_cell(a_.meta().grid, {.to = to, .box = box, .has = changes});
}

}  // namespace teracell::server
