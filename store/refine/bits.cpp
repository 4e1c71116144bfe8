#include "store/refine/bits.hpp"

#include <algorithm>

#include "store/base/bit_words.hpp"

namespace teracell::inline store {
namespace {

// Ones at [from, to) of a word. REQUIRES: from < to <= 64.
uint64_t ones(uint64_t from, uint64_t to) { return ~uint64_t{0} >> (64 - (to - from)) << from; }

// row[i] |= row[i + shift], bit by bit; beyond the end nothing is set.
void or_shifted(std::span<uint64_t> row, size_t shift) {
  const size_t words = shift / 64, bits = shift % 64;
  for (size_t i = 0; i + words < row.size(); ++i) {
    uint64_t x = row[i + words] >> bits;
    if (bits != 0 && i + words + 1 < row.size()) x |= row[i + words + 1] << (64 - bits);
    row[i] |= x;
  }
}

// Calls step(shift) so that x |= (x shifted by `shift`), done in this order, leaves at each place what the next `window` places had.
template <class Step>
void for_each_shift(int64_t window, Step&& step) {
  for (int64_t covered = 1; covered < window;) {
    const int64_t shift = std::min(covered, window - covered);
    step(shift);
    covered += shift;
  }
}

}  // namespace

Box grown(const Box& box, int64_t cells) {
  Box out = box;
  for (size_t d = 0; d < 3; ++d) out.lo[d] -= cells, out.hi[d] += cells;
  return out;
}

Bits::Bits(const Box& box)
    : box_(box),
      wide_(box.hi[0] - box.lo[0]),
      row_words_(static_cast<size_t>(box.hi[2] - box.lo[2] + 63) / 64),
      words_(static_cast<size_t>(wide_ * (box.hi[1] - box.lo[1])) * row_words_) {}

bool Bits::none() const {
  for (int64_t v = box_.lo[1]; v < box_.hi[1]; ++v)
    for (int64_t u = box_.lo[0]; u < box_.hi[0]; ++u)
      for (size_t i = 0, at = row(u, v), n = static_cast<size_t>(box_.hi[2] - box_.lo[2]); i * 64 < n; ++i)
        if ((words_[at + i] & ones(0, std::min<uint64_t>(64, n - i * 64))) != 0) return false;
  return true;
}

void Bits::set(int64_t u, int64_t v, int64_t w0, int64_t w1) {
  if (u < box_.lo[0] || u >= box_.hi[0] || v < box_.lo[1] || v >= box_.hi[1]) return;
  const int64_t from = std::max(w0, box_.lo[2]), to = std::min(w1, box_.hi[2]);
  if (from >= to) return;
  set_bits(&words_[row(u, v)], static_cast<size_t>(from - box_.lo[2]), static_cast<size_t>(to - box_.lo[2]));
}

void Bits::set(const Box& cells) {
  for (int64_t v = std::max(cells.lo[1], box_.lo[1]); v < std::min(cells.hi[1], box_.hi[1]); ++v)
    for (int64_t u = std::max(cells.lo[0], box_.lo[0]); u < std::min(cells.hi[0], box_.hi[0]); ++u) set(u, v, cells.lo[2], cells.hi[2]);
}

void Bits::add(int64_t u, int64_t v, int64_t w, uint32_t cells) {
  if (cells == 0 || u < box_.lo[0] || u >= box_.hi[0] || v < box_.lo[1] || v >= box_.hi[1]) return;
  int64_t at = w - box_.lo[2];
  const int64_t n = box_.hi[2] - box_.lo[2];
  uint64_t x = cells;
  if (at < 0) {
    if (at <= -32) return;
    x >>= -at, at = 0;
  }
  if (at >= n) return;
  if (n - at < 32) x &= ones(0, static_cast<uint64_t>(n - at));
  uint64_t* const words = &words_[row(u, v)];
  const auto first = static_cast<size_t>(at) / 64, bit = static_cast<size_t>(at) % 64;
  words[first] |= x << bit;
  if (bit > 32 && first + 1 < row_words_) words[first + 1] |= x >> (64 - bit);
}

uint32_t Bits::get32(int64_t u, int64_t v, int64_t w) const {
  const auto at = static_cast<size_t>(w - box_.lo[2]);
  return static_cast<uint32_t>(words_[row(u, v) + at / 64] >> at % 64);
}

void Bits::add(const Bits& other) {
  Box both;
  for (size_t d = 0; d < 3; ++d) both.lo[d] = std::max(box_.lo[d], other.box_.lo[d]), both.hi[d] = std::min(box_.hi[d], other.box_.hi[d]);
  if (both.empty()) return;
  for (int64_t v = both.lo[1]; v < both.hi[1]; ++v)
    for (int64_t u = both.lo[0]; u < both.hi[0]; ++u) {
      const uint64_t* const from = &other.words_[other.row(u, v)];
      // The word i of the other is added in two halves, each of which may reach into two words here.
      const auto n = static_cast<size_t>(other.box_.hi[2] - other.box_.lo[2]);
      for (size_t i = 0; i * 64 < n; ++i) {
        const uint64_t x = from[i] & ones(0, std::min<uint64_t>(64, n - i * 64));
        if (x == 0) continue;
        const int64_t w = other.box_.lo[2] + static_cast<int64_t>(i) * 64;
        add(u, v, w, static_cast<uint32_t>(x));
        add(u, v, w + 32, static_cast<uint32_t>(x >> 32));
      }
    }
}

void Bits::dilate(int64_t cells) {
  if (cells == 0) return;
  const int64_t window = 2 * cells + 1, high = box_.hi[1] - box_.lo[1], width = box_.hi[0] - box_.lo[0];
  const size_t line = static_cast<size_t>(wide_) * row_words_, used = static_cast<size_t>(width) * row_words_;
  // Along w, within each row.
  for (int64_t v = 0; v < high; ++v)
    for (int64_t u = 0; u < width; ++u) {
      const std::span<uint64_t> words(&words_[static_cast<size_t>(v) * line + static_cast<size_t>(u) * row_words_], row_words_);
      if (std::ranges::all_of(words, [](uint64_t x) { return x == 0; })) continue;
      for_each_shift(window, [&](int64_t shift) { or_shifted(words, static_cast<size_t>(shift)); });
    }
  // Along u, where a row has its neighbours beside it, and along v.
  for (int64_t v = 0; v < high; ++v) {
    uint64_t* const words = &words_[static_cast<size_t>(v) * line];
    for_each_shift(window, [&](int64_t shift) {
      const size_t by = static_cast<size_t>(shift) * row_words_;
      for (size_t i = 0; i + by < used; ++i) words[i] |= words[i + by];
    });
  }
  for_each_shift(window, [&](int64_t shift) {
    for (int64_t v = 0; v + shift < high; ++v) {
      uint64_t* const to = &words_[static_cast<size_t>(v) * line];
      const uint64_t* const from = to + static_cast<size_t>(shift) * line;
      for (size_t i = 0; i < used; ++i) to[i] |= from[i];
    }
  });
  // Each place has now what lies in the window that begins there: it stands for the cell in the window's middle.
  box_ = grown(box_, -cells);
}

Bits Bits::coarser() const {
  Box half;
  for (size_t d = 0; d < 3; ++d) half.lo[d] = box_.lo[d] / 2, half.hi[d] = box_.hi[d] / 2;
  Bits out(half);
  const auto n = static_cast<size_t>(box_.hi[2] - box_.lo[2]);
  for (int64_t v = half.lo[1]; v < half.hi[1]; ++v)
    for (int64_t u = half.lo[0]; u < half.hi[0]; ++u) {
      const uint64_t *const a = &words_[row(2 * u, 2 * v)], *const b = &words_[row(2 * u + 1, 2 * v)];
      const uint64_t *const c = &words_[row(2 * u, 2 * v + 1)], *const d = &words_[row(2 * u + 1, 2 * v + 1)];
      uint64_t* const to = &out.words_[out.row(u, v)];
      for (size_t i = 0; i * 64 < n; ++i) {
        const uint64_t x = (a[i] | b[i] | c[i] | d[i]) & ones(0, std::min<uint64_t>(64, n - i * 64));
        if (x != 0) to[i / 2] |= uint64_t{pairs_of_bits(x)} << (i % 2 * 32);
      }
    }
  return out;
}

Bits Bits::cropped(const Box& box) const {
  Bits out(box);
  out.add(*this);
  return out;
}

}  // namespace teracell::store
