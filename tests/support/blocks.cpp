#include "tests/support/blocks.hpp"

#include <algorithm>
#include <functional>

namespace teracell::testing {
namespace {

std::vector<Label> set_of(Mask mask) {
  std::vector<Label> set;
  for (Label label = 0; label < 64; ++label)
    if (mask >> label & 1) set.push_back(label);
  return set;
}

// A ray with `changes` changes anywhere; `draw` gives its sets.
void append_random_ray(std::mt19937_64& random, RayBlock& rays, uint32_t changes, const std::function<SetId()>& draw) {
  std::vector<uint32_t> at;
  while (at.size() < std::min(changes, rays.length - 1)) {
    const auto cell = static_cast<uint32_t>(random() % (rays.length - 1) + 1);
    if (std::ranges::find(at, cell) == at.end()) at.push_back(cell);
  }
  std::ranges::sort(at);
  std::vector<SetId> sets = {draw()};
  std::vector<uint32_t> kept;
  for (const uint32_t cell : at) {
    const SetId next = draw();
    if (next == sets.back()) continue;
    sets.push_back(next);
    kept.push_back(cell);
  }
  rays.append(sets, kept);
}

// A lens of label 1 in label 0, with a core of label 2 where it is thick.
void append_lens(RayBlock& rays, uint32_t u, uint32_t v) {
  const double x = 2.0 * u / rays.nu - 0.9, y = 2.0 * v / rays.nv - 1.1;
  const double half = 0.4 * rays.length * (0.9 - x * x - y * y), middle = rays.length * (0.5 + 0.05 * x);
  const auto cell = [&](double w) { return static_cast<uint32_t>(std::clamp(w, 1.0, rays.length - 1.0)); };
  const uint32_t a = cell(middle - half), b = cell(middle - half / 2), c = cell(middle + half / 2), d = cell(middle + half);
  if (half <= 0 || a >= d) rays.append(std::array<SetId, 1>{0}, {});
  else if (a < b && b < c && c < d && half > 0.2 * rays.length) rays.append(std::array<SetId, 5>{0, 1, 2, 1, 0}, std::array{a, b, c, d});
  else rays.append(std::array<SetId, 3>{0, 1, 0}, std::array{a, d});
}

}  // namespace

Mask mask_of(const std::vector<Label>& set) {
  Mask mask = 0;
  for (const Label label : set) mask |= Mask{1} << label;
  return mask;
}

// REQUIRES: labels >= 3.
Chunk random_chunk(std::mt19937_64& random, BlockKind kind, uint32_t nu, uint32_t nv, uint32_t length, uint32_t labels) {
  Chunk out{{}, SetTable(labels)};
  out.rays.reset(nu, nv, length);
  const auto any_label = [&] { return static_cast<SetId>(random() % labels); };
  const auto any_set = [&] {
    std::vector<Label> set;
    for (int i = random_int(random, 1, 4); i > 0; --i) set.push_back(any_label());
    std::ranges::sort(set);
    set.erase(std::unique(set.begin(), set.end()), set.end());
    return out.sets.intern(set);
  };
  for (uint32_t v = 0; v < nv; ++v) {
    for (uint32_t u = 0; u < nu; ++u) {
      const auto some = static_cast<uint32_t>(random_int(random, 0, 12));
      switch (kind) {
        case BlockKind::kSmooth: append_lens(out.rays, u, v); break;
        case BlockKind::kNoise: append_random_ray(random, out.rays, length / 3, any_label); break;
        case BlockKind::kDifferent: append_random_ray(random, out.rays, some, any_label); break;
        case BlockKind::kSets: append_random_ray(random, out.rays, some, any_set); break;
        case BlockKind::kJagged: append_random_ray(random, out.rays, 2, [next = 0u]() mutable { return next++ % 2; }); break;
      }
    }
  }
  return out;
}

std::vector<Mask> expand(const RayBlock& rays, const SetTable& sets) {
  std::vector<Mask> cells;
  cells.reserve(size_t{rays.rays()} * rays.length);
  for (uint32_t ray = 0; ray < rays.rays(); ++ray)
    rays.for_each_run(ray, [&](uint32_t from, uint32_t to, SetId set) { cells.insert(cells.end(), to - from, mask_of(sets.members(set))); });
  return cells;
}

Chunk block_of_cells(uint32_t nu, uint32_t nv, uint32_t length, uint32_t labels, const std::vector<Mask>& cells) {
  Chunk out{{}, SetTable(labels)};
  out.rays.reset(nu, nv, length);
  for (uint32_t ray = 0; ray < nu * nv; ++ray) {
    const Mask* cell = cells.data() + size_t{ray} * length;
    std::vector<SetId> sets;
    std::vector<uint32_t> changes;
    for (uint32_t w = 0; w < length; ++w) {
      if (w > 0 && cell[w] == cell[w - 1]) continue;
      if (w > 0) changes.push_back(w);
      sets.push_back(out.sets.intern(set_of(cell[w])));
    }
    out.rays.append(sets, changes);
  }
  return out;
}

bool same_runs(const Chunk& a, const Chunk& b) {
  if (a.rays.nu != b.rays.nu || a.rays.nv != b.rays.nv || a.rays.length != b.rays.length) return false;
  if (a.rays.begin != b.rays.begin || a.rays.at != b.rays.at) return false;
  for (uint32_t ray = 0; ray < a.rays.rays(); ++ray)
    if (!std::ranges::equal(a.rays.sets(ray), b.rays.sets(ray), [&](SetId x, SetId y) { return a.sets.members(x) == b.sets.members(y); }))
      return false;
  return true;
}

std::string broken_invariant(const Chunk& chunk, uint32_t nu, uint32_t nv, uint32_t length, uint32_t labels) {
  const RayBlock& b = chunk.rays;
  if (b.nu != nu || b.nv != nv || b.length != length) return "the shape is not the one asked for";
  if (b.pattern.size() != b.rays() || b.begin.size() != b.rays() + 1 || b.begin.back() != b.at.size()) return "a table has the wrong size";
  if (chunk.sets.labels() != labels) return "the number of labels is not the one asked for";
  for (uint32_t ray = 0; ray < b.rays(); ++ray) {
    if (b.pattern[ray] >= b.patterns.size()) return "a pattern that is not there";
    const auto sets = b.sets(ray);
    const auto at = b.changes(ray);
    if (sets.size() != at.size() + 1) return "changes and pattern of a ray disagree";
    for (size_t i = 0; i < at.size(); ++i)
      if (at[i] == 0 || at[i] >= length || (i > 0 && at[i] <= at[i - 1])) return "changes do not ascend within the ray";
    for (size_t i = 0; i < sets.size(); ++i)
      if (sets[i] >= chunk.sets.ids() || (i > 0 && sets[i] == sets[i - 1])) return "a set repeats or is not there";
  }
  for (SetId id = labels; id < chunk.sets.ids(); ++id) {
    const auto members = chunk.sets.members(id);
    if (members.size() < 2 || members.back() >= labels || !std::ranges::is_sorted(members, std::less_equal<>{})) return "a set is not one";
  }
  return "";
}

}  // namespace teracell::testing
