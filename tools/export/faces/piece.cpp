#include "tools/export/faces/piece.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace teracell::exports::faces {
namespace {

// The corners of a cell's faces, as dx + 2 dy + 4 dz, by direction. Seen from outside of the cell they turn counterclockwise.
constexpr uint8_t kFace[6][4] = {{1, 3, 7, 5}, {2, 6, 7, 3}, {4, 5, 7, 6}, {0, 4, 6, 2}, {0, 1, 5, 4}, {0, 2, 3, 1}};

Index3 steps_of(const Index3& size) { return {1, size[0], size[0] * size[1]}; }

uint64_t word(const uint8_t* bytes) {
  uint64_t out;
  std::memcpy(&out, bytes, sizeof out);
  return out;
}

}  // namespace

void Piece::find(const Cells& cells) {
  cells_ = &cells;
  Index3 n;
  for (int d = 0; d < 3; ++d) n[d] = cells.box.hi[d] - cells.box.lo[d], size_[d] = n[d] - 1;
  cell_step_ = steps_of(n), step_ = steps_of(size_);
  pattern_.resize(static_cast<size_t>(size_[0] * size_[1] * size_[2]));
  first_.resize(pattern_.size());
  corner_.clear(), middles_.clear();
  for (int64_t z = 0; z < size_[2]; ++z)
    for (int64_t y = 0; y < size_[1]; ++y) {
      const uint8_t* const a = cells.in.data() + z * cell_step_[2] + y * cell_step_[1];
      const uint8_t *const b = a + cell_step_[1], *const c = a + cell_step_[2], *const d = c + cell_step_[1];
      uint8_t* const out = pattern_.data() + z * step_[2] + y * step_[1];
      int64_t x = 0;
      for (; x + 8 <= size_[0]; x += 8) {  // eight corners at once: each of their bits has its place in each byte
        const uint64_t eight = word(a + x) | word(a + x + 1) << 1 | word(b + x) << 2 | word(b + x + 1) << 3 | word(c + x) << 4 |
                               word(c + x + 1) << 5 | word(d + x) << 6 | word(d + x + 1) << 7;
        std::memcpy(out + x, &eight, sizeof eight);
      }
      for (; x < size_[0]; ++x)
        out[x] = static_cast<uint8_t>(a[x] | a[x + 1] << 1 | b[x] << 2 | b[x + 1] << 3 | c[x] << 4 | c[x + 1] << 5 | d[x] << 6 | d[x + 1] << 7);
    }
  // A corner's own vertices come first, then those at the middle of the edges that leave it upwards.
  for (size_t i = 0; i < pattern_.size(); ++i) {
    if (pattern_[i] == 0 || pattern_[i] == 255) {
      const uint64_t same = pattern_[i] == 0 ? 0 : ~uint64_t{0};
      while (i + 8 < pattern_.size() && word(pattern_.data() + i + 1) == same) i += 8;
      continue;
    }
    first_[i] = vertices();
    const Corner& here = corner_of(pattern_[i]);
    corner_.insert(corner_.end(), here.vertices, static_cast<uint32_t>(i));
    unsigned cell;
    for (unsigned axis = 0; axis < 3 && (here.forks & 7) != 0; ++axis)
      if (has_middles(i, axis, cell)) corner_.insert(corner_.end(), 2, static_cast<uint32_t>(i));
  }
  for (uint32_t vertex = 0; vertex < vertices();) {
    const size_t i = corner_[vertex];
    vertex += corner_of(pattern_[i]).vertices;
    unsigned cell;
    for (unsigned axis = 0; vertex < vertices() && corner_[vertex] == i; ++axis) {
      if (!has_middles(i, axis, cell)) continue;
      const uint32_t from = vertex_of(i, cell), to = vertex_of(i + static_cast<size_t>(step_[axis]), cell ^ (1u << axis));
      for (int k = 0; k < 2; ++k) middles_.push_back({vertex++, from, to});
    }
  }
}

Index3 Piece::place(uint32_t vertex) const {
  const int64_t i = corner_[vertex];
  const Index3& lo = cells_->box.lo;
  return {lo[0] + 1 + i % size_[0], lo[1] + 1 + i / size_[0] % size_[1], lo[2] + 1 + i / step_[2]};
}

bool Piece::has_middles(size_t corner, unsigned axis, unsigned& first_cell) const {
  const Corner& here = corner_of(pattern_[corner]);
  if ((here.forks >> axis & 1) == 0) return false;
  const size_t other = corner + static_cast<size_t>(step_[axis]);
  if (other >= pattern_.size()) return false;
  const unsigned side = 1u << axis, a = 1u << (axis + 1) % 3, b = 1u << (axis + 2) % 3;
  const bool straight = (pattern_[corner] >> side & 1) != 0;  // the fork's cells are `side` and that beyond, or the other two
  const unsigned one = straight ? side : side | a, two = straight ? side | a | b : side | b;
  const Corner& there = corner_of(pattern_[other]);
  first_cell = std::min(one, two);
  return (there.forks >> (axis + 3) & 1) != 0 && here.vertex[one] == here.vertex[two] && there.vertex[one ^ side] == there.vertex[two ^ side];
}

// `cell_corner` is the lower corner of the cell.
Piece::Outline Piece::outline(size_t cell_corner, unsigned face) const {
  Outline out;
  const auto at = [&](unsigned k) { return cell_corner + static_cast<size_t>((k & 1) * step_[0] + (k >> 1 & 1) * step_[1] + (k >> 2) * step_[2]); };
  for (size_t i = 0; i < 4; ++i) {
    const unsigned from = kFace[face][i], to = kFace[face][(i + 1) % 4], lower = from & to;
    out.vertex[out.size++] = vertex_of(at(from), 7 ^ from);
    if (middles_.empty()) continue;
    const size_t corner = at(lower);
    const Corner& here = corner_of(pattern_[corner]);
    const auto axis = static_cast<unsigned>(std::countr_zero(from ^ to));
    unsigned first_cell;
    if (!has_middles(corner, axis, first_cell)) continue;
    uint32_t vertex = first_[corner] + here.vertices + ((7 ^ lower) == first_cell ? 0 : 1);
    unsigned ignored;
    for (unsigned before = 0; before < axis; ++before)
      if (has_middles(corner, before, ignored)) vertex += 2;
    out.start = out.size;
    out.vertex[out.size++] = vertex;
  }
  return out;
}

unsigned Piece::exposed(size_t cell) const {
  const uint8_t* const in = cells_->in.data() + cell;
  const auto [x, y, z] = cell_step_;
  return static_cast<unsigned>((in[x] ^ 1) | (in[y] ^ 1) << 1 | (in[z] ^ 1) << 2 | (in[-x] ^ 1) << 3 | (in[-y] ^ 1) << 4 | (in[-z] ^ 1) << 5);
}

}  // namespace teracell::exports::faces
