#include "mesher/compose.hpp"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "store/error.hpp"

namespace teracell {
namespace {

// Sorts the crossings of a ray: a handful that the engine leaves nearly in order, so insertion is one compare each.
// Returns whether all are of one layer; asked here because a second loop over freshly stored crossings waits for the
// stores (it took a tenth of the whole run).
bool sort_crossings(std::span<uint64_t> c) {
  if (c.empty()) return true;
  const uint64_t first = c[0];
  uint64_t mixed = 0;
  if (c.size() > 64) {
    for (const uint64_t x : c) mixed |= x ^ first;
    std::ranges::sort(c);
  } else {
    for (size_t i = 1; i < c.size(); ++i) {
      const uint64_t x = c[i];
      mixed |= x ^ first;
      size_t j = i;
      for (; j > 0 && c[j - 1] > x; --j) c[j] = c[j - 1];
      c[j] = x;
    }
  }
  return Crossing::layer(mixed) == 0;
}

}  // namespace

Composer::Composer(std::vector<Layer> layers, const std::vector<uint32_t>& strength, const std::vector<Label>& label)
    : layers_(std::move(layers)),
      strength_(strength),
      label_(label.size() + 1, 0),
      body_(label.size()),
      cells_(label.size()),
      covered_(label.size()),
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
  const bool body_was = inside > 0;
  inside += is ? 1 : -1;
  overlap_ += (inside > 0) - body_was;
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

void Composer::count(uint32_t cells, uint32_t owner) {
  if (overlap_ == 0 || cells == 0) return;
  cells_[body_[owner]] += cells;
  int weaker = overlap_ - 1;
  for (uint32_t s = owner + 1; weaker > 0; ++s)
    if (active_[s / 64] >> (s % 64) & 1) {
      covered_[body_[s]] += cells;
      --weaker;
    }
}

void Composer::note_close(std::span<const uint64_t> crossings, uint32_t length) {
  const uint32_t cell = Crossing::cell(crossings[0]);
  if (cell == 0 || cell >= length) return;
  for (size_t i = 0; i < crossings.size();) {
    const size_t first = i;
    const uint32_t body = layers_[Crossing::layer(crossings[i])].body;
    while (i < crossings.size() && !Crossing::is_mark(crossings[i]) && layers_[Crossing::layer(crossings[i])].body == body) ++i;
    if (i == first) return;  // marks are sorted last
    if (i - first > 1) close_.push_back({ray_, cell, body, (i - first) / 2});
  }
}

void Composer::compose(Crossings& crossings, uint32_t nu, uint32_t nv, uint32_t length, RayBlock& out) {
  out.reset(nu, nv, length);
  out.pattern.resize(out.rays());
  out.begin.resize(out.rays() + 1);
  out.at.resize(crossings.all.size());  // as many changes at most
  alternating_.assign(2, {});
  close_.clear();
  uint32_t* at = out.at.data();
  for (uint32_t ray = 0; ray < out.rays(); ++ray) {
    ray_ = ray;
    const std::span<uint64_t> all(crossings.all.data() + crossings.begin[ray], crossings.begin[ray + 1] - crossings.begin[ray]);
    const bool one_layer = sort_crossings(all);
    const bool simple = one_layer && (all.empty() || label_[strength_[layers_[Crossing::layer(all[0])].body]] != 0);
    const size_t open = simple ? compose_one_layer(all, length, at, out.pattern[ray], out.patterns) : compose_any(all, length, at, out.pattern[ray], out.patterns);
    if (open != 0)
      throw Error(fmt::format("ray {}, {} of a tile leaves {} of its surfaces open: the crossings are inconsistent", ray % nu, ray / nu, open));
    out.begin[ray + 1] = static_cast<uint32_t>(at - out.at.data());
  }
  out.at.resize(at - out.at.data());
}

// Nearly all rays: one layer, so background and body take turns and the pattern follows from their number.
size_t Composer::compose_one_layer(std::span<const uint64_t> all, uint32_t length, uint32_t*& at, uint32_t& pattern, PatternTable& patterns) {
  uint32_t* const first = at;
  bool begins_inside = false, was = false;
  int counter = 0;
  int64_t cells = 0;
  const Layer layer = all.empty() ? Layer{0, false} : layers_[Crossing::layer(all[0])];
  for (size_t i = 0; i < all.size();) {
    const size_t begin = i;
    const uint32_t cell = Crossing::cell(all[i]);
    do counter += Crossing::step(all[i++]);
    while (i < all.size() && Crossing::cell(all[i]) == cell);
    if (i - begin > 1) note_close(all.subspan(begin, i - begin), length);
    const bool is = layer.evenodd ? counter & 1 : counter != 0;
    if (is == was || cell >= length) continue;
    was = is;
    cells += is ? -int64_t{cell} : int64_t{cell};
    if (cell == 0) begins_inside = true;
    else *at++ = cell;
  }
  const auto changes = static_cast<size_t>(at - first);
  if (was) cells += length;
  if (!all.empty()) cells_[layer.body] += cells;
  // Patterns known by layer, beginning and number of changes.
  std::vector<Alternating>& known = alternating_[begins_inside];
  if (known.size() <= changes) known.resize(changes + 1);
  Alternating& k = known[changes];
  if (k.pattern == ~0u || k.body != layer.body) {
    const Label label = changes == 0 && !begins_inside ? 0 : label_[strength_[layer.body]];
    sets_.clear();
    for (size_t i = 0; i <= changes; ++i) sets_.push_back((i % 2 == 0) == begins_inside ? label : 0);
    k = {layer.body, patterns.intern(sets_)};
  }
  pattern = k.pattern;
  return layer.evenodd ? counter & 1 : counter != 0;
}

size_t Composer::compose_any(std::span<const uint64_t> all, uint32_t length, uint32_t*& at, uint32_t& pattern, PatternTable& patterns) {
  sets_.assign(1, 0);
  uint32_t since = 0;
  auto owner = static_cast<uint32_t>(body_.size());
  for (size_t i = 0; i < all.size();) {
    const uint32_t cell = Crossing::cell(all[i]), until = std::min(cell, length);
    count(until - since, owner);
    since = until;
    const size_t begin = i;
    for (; i < all.size() && Crossing::cell(all[i]) == cell; ++i) step(all[i]);
    if (i - begin > 1) note_close(all.subspan(begin, i - begin), length);
    if (cell >= length) continue;
    owner = top();
    const Label label = label_[owner];
    if (cell == 0) {
      sets_[0] = label;
    } else if (label != sets_.back()) {
      sets_.push_back(label);
      *at++ = cell;
    }
  }
  count(length - since, owner);
  pattern = patterns.intern(sets_);
  return open_;
}

}  // namespace teracell
