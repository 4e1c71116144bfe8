#include "mesher/compose.hpp"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "store/error.hpp"

namespace teracell {
namespace {

// Rays have a handful of crossings in random order (that of the facets): compare-and-swap without branches wins there,
// insertion up to some tens, std::sort beyond.
void sort_crossings(std::span<uint64_t> c) {
  const size_t n = c.size();
  if (n > 32) {
    std::ranges::sort(c);
  } else if (n > 8) {
    for (size_t i = 1; i < n; ++i) {
      const uint64_t x = c[i];
      size_t j = i;
      for (; j > 0 && c[j - 1] > x; --j) c[j] = c[j - 1];
      c[j] = x;
    }
  } else {
    for (size_t i = 1; i < n; ++i)
      for (size_t j = i; j > 0; --j) {
        const uint64_t lower = std::min(c[j - 1], c[j]), upper = std::max(c[j - 1], c[j]);
        c[j - 1] = lower;
        c[j] = upper;
      }
  }
}

}  // namespace

Composer::Composer(std::vector<Layer> layers, const std::vector<uint32_t>& strength, const std::vector<Label>& label)
    : layers_(std::move(layers)),
      strength_(strength),
      label_(label.size() + 1, 0),
      body_(label.size()),
      cells_(label.size()),
      counter_(layers_.size(), 0),
      inside_(strength.size(), 0),
      active_(strength.size() / 64 + 1, 0) {
  for (uint32_t b = 0; b < strength.size(); ++b) {
    label_[strength[b]] = label[b];
    body_[strength[b]] = b;
  }
}

void Composer::step(uint64_t crossing) {
  const uint32_t l = Crossing::layer(crossing);
  const Layer& layer = layers_[l];
  int& counter = counter_[l];
  const bool was = counter != 0;
  counter = layer.evenodd ? counter ^ 1 : counter + Crossing::step(crossing);
  const bool is = counter != 0;
  if (was == is) return;
  open_ += is ? 1 : -1;
  int& inside = inside_[layer.body];
  inside += is ? 1 : -1;
  const uint32_t s = strength_[layer.body];
  const uint64_t bit = uint64_t{1} << (s % 64);
  active_[s / 64] = inside > 0 ? active_[s / 64] | bit : active_[s / 64] & ~bit;
}

// The strength of the strongest body that is inside, or the number of bodies.
uint32_t Composer::top() const {
  for (size_t w = 0; w < active_.size(); ++w)
    if (active_[w] != 0) return static_cast<uint32_t>(64 * w + std::countr_zero(active_[w]));
  return static_cast<uint32_t>(body_.size());
}

void Composer::compose(Crossings& crossings, uint32_t nu, uint32_t nv, uint32_t length, RayBlock& out) {
  out.reset(nu, nv, length);
  out.at.reserve(crossings.all.size());
  for (uint32_t ray = 0; ray < nu * nv; ++ray) {
    const std::span<uint64_t> all(crossings.all.data() + crossings.begin[ray], crossings.begin[ray + 1] - crossings.begin[ray]);
    sort_crossings(all);
    if (changes_.size() < all.size()) changes_.resize(2 * all.size());
    sets_.assign(1, 0);
    uint32_t* at = changes_.data();
    uint32_t owner = static_cast<uint32_t>(body_.size()), since = 0;  // strength of the current owner, its first cell
    const auto settle = [&](uint32_t until) {
      if (owner < body_.size()) cells_[body_[owner]] += until - since;
    };
    for (size_t i = 0; i < all.size();) {
      const uint32_t cell = Crossing::cell(all[i]);
      for (; i < all.size() && Crossing::cell(all[i]) == cell; ++i) step(all[i]);
      if (cell >= length) continue;
      settle(cell);
      owner = top();
      since = cell;
      const Label label = label_[owner];
      if (cell == 0) {
        sets_[0] = label;
      } else if (label != sets_.back()) {
        sets_.push_back(label);
        *at++ = cell;
      }
    }
    settle(length);
    if (open_ != 0)
      throw Error(fmt::format("ray {}, {} of a tile leaves {} of its surfaces open: the crossings are inconsistent", ray % nu, ray / nu, open_));
    out.append(sets_, {changes_.data(), at});
  }
}

}  // namespace teracell
