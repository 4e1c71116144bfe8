#include "tests/support/refined.hpp"

#include <algorithm>

#include "tests/support/random.hpp"

namespace teracell::testing {
namespace {

// A value for each cell of a level.
template <class T>
struct Dense {
  Index3 n;
  std::vector<T> all;
  Dense(const Index3& size, T value) : n(size), all(static_cast<size_t>(size[0] * size[1] * size[2]), value) {}
  typename std::vector<T>::reference at(int64_t x, int64_t y, int64_t z) { return all[static_cast<size_t>((z * n[1] + y) * n[0] + x)]; }
};

template <class F>
void for_each_cell(const Box& box, F&& f) {
  for (int64_t z = box.lo[2]; z < box.hi[2]; ++z)
    for (int64_t y = box.lo[1]; y < box.hi[1]; ++y)
      for (int64_t x = box.lo[0]; x < box.hi[0]; ++x) f(x, y, z);
}

uint64_t morton(const Index3& cell) {
  unsigned __int128 code = 0;
  for (int bit = 0; bit < 21; ++bit)
    for (size_t d = 0; d < 3; ++d) code |= static_cast<unsigned __int128>(cell[d] >> bit & 1) << (3 * bit + static_cast<int>(d));
  return static_cast<uint64_t>(code);
}

}  // namespace

std::vector<Leaf> leaves_by_definition(const Metadata& meta, const std::vector<Label>& cells, const Refinement& r, const Box& region,
                                       const PatchOf& patches) {
  const Index3 n = meta.grid.cells();
  const auto label = [&](const Index3& c) { return cells[static_cast<size_t>((c[2] * n[1] + c[1]) * n[0] + c[0])]; };
  const auto said = [](const std::vector<int>& levels, uint32_t i) { return i < levels.size() ? levels[i] : kNoLevel; };

  Dense<int> wanted(n, kNoLevel);
  const auto want = [&](const Index3& c, int level) { wanted.at(c[0], c[1], c[2]) = std::min(wanted.at(c[0], c[1], c[2]), level); };
  for_each_cell({{0, 0, 0}, n}, [&](int64_t x, int64_t y, int64_t z) {
    const Index3 c{x, y, z};
    const uint32_t material = meta.labels[label(c)].material;
    want(c, said(r.inside, material));
    for (const auto& [box, level] : r.boxes)
      if (overlap(box, {c, {x + 1, y + 1, z + 1}})) want(c, level);
    for (int axis = 0; axis < 3; ++axis) {
      Index3 next = c;
      if (++next[static_cast<size_t>(axis)] == n[static_cast<size_t>(axis)] || label(c) == label(next)) continue;
      int level = std::min(said(r.of_materials, material), said(r.of_materials, meta.labels[label(next)].material));
      if (patches) level = std::min(level, said(r.of_patches, patches(c, axis)));
      if (level == kNoLevel) level = r.interfaces;
      want(c, level), want(next, level);
    }
  });

  // split[L] of the cells of level L, as the contract has it.
  const auto cells_of = [&](int level) { return meta.grid.cells(level); };
  std::vector<Dense<uint8_t>> split;
  split.emplace_back(n, uint8_t{0});
  for (int level = 0; level < r.coarsest; ++level) {
    Dense<uint8_t> marked = split.back(), above(cells_of(level + 1), 0);
    for_each_cell({{0, 0, 0}, n}, [&](int64_t x, int64_t y, int64_t z) {
      if (wanted.at(x, y, z) <= level) marked.at(x >> level, y >> level, z >> level) = 1;
    });
    for_each_cell({{0, 0, 0}, marked.n}, [&](int64_t x, int64_t y, int64_t z) {
      if (marked.at(x, y, z) == 0) return;
      Box near{{x - r.layers, y - r.layers, z - r.layers}, {x + r.layers + 1, y + r.layers + 1, z + r.layers + 1}};
      for (size_t d = 0; d < 3; ++d) near.lo[d] = std::max<int64_t>(near.lo[d], 0) / 2, near.hi[d] = (std::min(near.hi[d], marked.n[d]) - 1) / 2 + 1;
      for_each_cell(near, [&](int64_t a, int64_t b, int64_t c) { above.at(a, b, c) = 1; });
    });
    split.push_back(std::move(above));
  }

  std::vector<Leaf> out;
  for (int level = 0; level <= r.coarsest; ++level)
    for_each_cell({{0, 0, 0}, cells_of(level)}, [&](int64_t x, int64_t y, int64_t z) {
      if (split[static_cast<size_t>(level)].at(x, y, z) != 0) return;
      if (level < r.coarsest && split[static_cast<size_t>(level) + 1].at(x / 2, y / 2, z / 2) == 0) return;
      Leaf leaf{{x, y, z}, level, 0};
      const Index3 first = leaf.first();
      if (!overlap(region, {first, {(x + 1) << level, (y + 1) << level, (z + 1) << level}})) return;
      Index3 middle;
      for (size_t d = 0; d < 3; ++d) middle[d] = std::min(first[d] + (level == 0 ? 0 : int64_t{1} << (level - 1)), n[d] - 1);
      leaf.label = label(middle);
      out.push_back(leaf);
    });
  std::ranges::sort(out, {}, [](const Leaf& leaf) { return morton(leaf.first()); });
  return out;
}

std::vector<Label> blobs(std::mt19937_64& random, const Index3& n, uint32_t labels) {
  std::vector<Label> out(static_cast<size_t>(n[0] * n[1] * n[2]), 0);
  for (int i = random_int(random, 1, 4); i > 0; --i) {
    const auto label = static_cast<Label>(random_int(random, 0, static_cast<int>(labels) - 1));
    std::array<double, 3> at{}, size{};
    const double radius = random_in(random, 0.5, 0.3 * static_cast<double>(std::min({n[0], n[1], n[2]})) + 1);
    const bool plate = random() % 3 == 0;
    for (size_t d = 0; d < 3; ++d)
      at[d] = random_in(random, 0, static_cast<double>(n[d])), size[d] = plate ? random_in(random, 0.3, 2 * radius) : radius;
    for_each_cell({{0, 0, 0}, n}, [&](int64_t x, int64_t y, int64_t z) {
      const std::array<double, 3> p{(static_cast<double>(x) - at[0]) / size[0], (static_cast<double>(y) - at[1]) / size[1],
                                    (static_cast<double>(z) - at[2]) / size[2]};
      const bool inside = plate ? std::abs(p[0]) < 1 && std::abs(p[1]) < 1 && std::abs(p[2]) < 1 : p[0] * p[0] + p[1] * p[1] + p[2] * p[2] < 1;
      if (inside) out[static_cast<size_t>((z * n[1] + y) * n[0] + x)] = label;
    });
  }
  return out;
}

}  // namespace teracell::testing
