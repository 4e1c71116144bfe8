#include "store/check/components.hpp"

#include <algorithm>
#include <utility>

namespace teracell::inline store {
namespace {

constexpr uint32_t kNotKept = ~0u;

// Calls f(i, j) for the runs i and j that have a cell in common.
template <class F>
void for_common_runs(std::span<const uint32_t> ends_a, std::span<const uint32_t> ends_b, F&& f) {
  for (size_t i = 0, j = 0; i < ends_a.size() && j < ends_b.size();) {
    f(i, j);
    const uint32_t end_a = ends_a[i], end_b = ends_b[j];
    i += end_a <= end_b;
    j += end_b <= end_a;
  }
}

std::span<const uint32_t> ends_of(const Border& border, uint32_t ray) {
  return std::span(border.ends).subspan(border.begin[ray], border.begin[ray + 1] - border.begin[ray]);
}

}  // namespace

void Component::add(const Component& other) {
  if (other.cells == 0) return;
  if (cells == 0 || std::pair(other.thinnest, other.first) < std::pair(thinnest, first)) thinnest = other.thinnest, first = other.first;
  cells += other.cells;
  for (size_t d = 0; d < 3; ++d) lo[d] = std::min(lo[d], other.lo[d]), hi[d] = std::max(hi[d], other.hi[d]);
}

// Whether each run of the one ray has a cell in common with the same run of the other. Then it has none in common with another run of the same
// label: that run would have to pass the ones between.
bool BlockLabeller::follows(const RayBlock& rays, uint32_t a, uint32_t b) {
  if (rays.pattern[a] != rays.pattern[b]) return false;
  const uint32_t* const at_a = rays.at.data() + rays.begin[a];
  const uint32_t* const at_b = rays.at.data() + rays.begin[b];
  const size_t changes = rays.begin[a + 1] - rays.begin[a];
  for (size_t i = 0; i + 1 < changes; ++i)
    if (std::max(at_a[i], at_b[i]) >= std::min(at_a[i + 1], at_b[i + 1])) return false;
  return true;
}

void BlockLabeller::join_rays(const RayBlock& rays, uint32_t a, uint32_t first_a, uint32_t b, uint32_t first_b) {
  const bool same = follows(rays, a, b);
  if (same && joined_ == std::pair(first_a, first_b)) return;
  const std::span<const SetId> sets_a = rays.sets(a), sets_b = rays.sets(b);
  const std::span<const uint32_t> changes_a = rays.changes(a), changes_b = rays.changes(b);
  const auto end = [&](std::span<const uint32_t> changes, size_t i) { return i < changes.size() ? changes[i] : rays.length; };
  for (size_t i = 0, j = 0; i < sets_a.size() && j < sets_b.size();) {
    if (sets_a[i] == sets_b[j]) groups_.join(first_a + static_cast<uint32_t>(i), first_b + static_cast<uint32_t>(j));
    const uint32_t end_a = end(changes_a, i), end_b = end(changes_b, j);
    i += end_a <= end_b;
    j += end_b <= end_a;
  }
  if (same) joined_ = {first_a, first_b};
}

void BlockLabeller::count(const RayBlock& rays, uint32_t ray, uint32_t first, uint32_t u, uint32_t v, const RayFrame& frame) {
  Component* node = &nodes_[first];
  std::array<uint32_t, 3> at;
  at[2 - frame.u] = u, at[2 - frame.v] = v;
  rays.for_each_run(ray, [&](uint32_t from, uint32_t to, SetId) {
    node->cells += to - from;
    node->lo = {std::min(node->lo[0], u), std::min(node->lo[1], v), std::min(node->lo[2], from)};
    node->hi = {std::max(node->hi[0], u + 1), std::max(node->hi[1], v + 1), std::max(node->hi[2], to)};
    at[2 - frame.w] = from;
    if (at < node->first) node->first = at;
    ++node;
  });
}

BlockComponents BlockLabeller::components(const RayBlock& rays, const RayWindow& window, uint32_t u0, uint32_t v0, const RayFrame& frame) {
  groups_ = Groups(), nodes_.clear();
  first_.assign(rays.rays(), 0);
  joined_ = {0, 0};
  for (uint32_t v = window.v0; v < window.v1; ++v)
    for (uint32_t u = window.u0; u < window.u1; ++u) {
      const uint32_t ray = v * rays.nu + u, before = ray - 1, above = ray - rays.nu;
      const bool has_before = u > window.u0, has_above = v > window.v0;
      uint32_t& first = first_[ray];
      if (has_before && follows(rays, ray, before)) first = first_[before];
      else if (has_above && follows(rays, ray, above)) first = first_[above];
      else {
        first = static_cast<uint32_t>(nodes_.size());
        for (const SetId label : rays.sets(ray)) {
          groups_.add();
          nodes_.push_back({.label = static_cast<Label>(label)});
        }
      }
      if (has_before && first_[before] != first) join_rays(rays, ray, first, before, first_[before]);
      if (has_above && first_[above] != first) join_rays(rays, ray, first, above, first_[above]);
      count(rays, ray, first, u0 + u - window.u0, v0 + v - window.v0, frame);
    }

  BlockComponents out;
  const std::vector<uint32_t> numbers = join_parts(groups_, nodes_, out.all);
  const auto border = [&](uint32_t bu0, uint32_t bv0, uint32_t bu1, uint32_t bv1) {
    Border b;
    for (uint32_t v = bv0; v < bv1; ++v)
      for (uint32_t u = bu0; u < bu1; ++u) {
        const uint32_t ray = v * rays.nu + u;
        uint32_t node = first_[ray];
        rays.for_each_run(ray, [&](uint32_t, uint32_t to, SetId) {
          b.ends.push_back(to);
          b.components.push_back(numbers[node++]);
        });
        b.begin.push_back(static_cast<uint32_t>(b.ends.size()));
      }
    return b;
  };
  out.borders = {border(window.u0, window.v0, window.u0 + 1, window.v1), border(window.u1 - 1, window.v0, window.u1, window.v1),
                 border(window.u0, window.v0, window.u1, window.v0 + 1), border(window.u0, window.v1 - 1, window.u1, window.v1)};
  return out;
}

std::vector<uint32_t> join_parts(Groups& groups, std::span<const Component> parts, std::vector<Component>& all) {
  std::vector<uint32_t> numbers(parts.size());
  for (uint32_t part = 0; part < parts.size(); ++part) {
    const uint32_t first = groups.of(part);
    if (first == part) {
      numbers[part] = static_cast<uint32_t>(all.size());
      all.push_back(parts[part]);
    } else {
      numbers[part] = numbers[first];
      all[numbers[first]].add(parts[part]);
    }
  }
  return numbers;
}

uint32_t OpenComponents::add(std::span<const Component> components) {
  const uint32_t first = groups_.size();
  for (const Component& c : components) {
    groups_.add();
    all_.push_back(c);
  }
  return first;
}

void OpenComponents::join(uint32_t a, uint32_t b) {
  if (all_[a].label != all_[b].label) return;
  a = groups_.of(a), b = groups_.of(b);
  if (a == b) return;
  groups_.join(a, b);
  all_[std::min(a, b)].add(all_[std::max(a, b)]);
}

uint32_t OpenComponents::keep(uint32_t component) {
  numbers_.resize(all_.size(), kNotKept);
  const uint32_t first = groups_.of(component);
  if (numbers_[first] == kNotKept) {
    numbers_[first] = static_cast<uint32_t>(kept_.size());
    kept_.push_back(all_[first]);
  }
  return numbers_[first];
}

void OpenComponents::finish_others() {
  numbers_.resize(all_.size(), kNotKept);
  for (uint32_t i = 0; i < all_.size(); ++i)
    if (groups_.stands_for_one(i) && numbers_[i] == kNotKept) finished_(all_[i]);
  all_ = std::exchange(kept_, {});
  groups_ = Groups(all_.size());
  numbers_.clear();
}

void ComponentJoiner::join(const Border& a, const Border& b) {
  if (a.rays() == 0) return;  // no block is above the first row
  for (uint32_t ray = 0; ray < a.rays(); ++ray)
    for_common_runs(ends_of(a, ray), ends_of(b, ray),
                    [&](size_t i, size_t j) { open_.join(a.components[a.begin[ray] + i], b.components[b.begin[ray] + j]); });
}

void ComponentJoiner::add(uint32_t cu, BlockComponents&& block) {
  const uint32_t base = open_.add(block.all);
  for (Border& border : block.borders)
    for (uint32_t& component : border.components) component += base;
  auto& [lowest_u, highest_u, lowest_v, highest_v] = block.borders;
  if (cu > 0) join(before_, lowest_u);
  join(above_[cu], lowest_v);
  before_ = std::move(highest_u);
  above_[cu] = std::move(highest_v);
  if (cu + 1 < above_.size()) return;
  for (Border& border : above_)
    for (uint32_t& component : border.components) component = open_.keep(component);
  open_.finish_others();
}

}  // namespace teracell::store
