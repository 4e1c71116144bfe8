#include "tools/export/faces/corner.hpp"

#include <algorithm>
#include <tuple>

namespace teracell::exports::faces {
namespace {

constexpr bool in(unsigned cells, unsigned cell) { return (cells >> cell & 1) != 0; }

// The cells of the body whose faces have an edge, one for each face: none, two or four. One cell may have two of the faces.
struct Owners {
  std::array<uint8_t, 4> cell{};
  size_t size = 0;
};

constexpr Owners owners_of_faces(unsigned cells, unsigned direction) {
  const unsigned axis = direction % 3, side = direction < 3 ? 1u << axis : 0, a = 1u << (axis + 1) % 3, b = 1u << (axis + 2) % 3;
  const std::array<unsigned, 4> around = {side, side | a, side | a | b, side | b};
  Owners out;
  for (size_t i = 0; i < 4; ++i) {
    const unsigned one = around[i], next = around[(i + 1) % 4];
    if (in(cells, one) != in(cells, next)) out.cell[out.size++] = static_cast<uint8_t>(in(cells, one) ? one : next);
  }
  std::sort(out.cell.begin(), out.cell.begin() + out.size);
  return out;
}

constexpr Corner corner_with(unsigned cells) {
  Corner out;
  std::array<uint8_t, 8> sheet{0, 1, 2, 3, 4, 5, 6, 7};
  std::array<Owners, 6> owners;
  for (unsigned d = 0; d < 6; ++d) {
    owners[d] = owners_of_faces(cells, d);
    if (owners[d].size == 4) out.forks |= static_cast<uint8_t>(1u << d);
    if (owners[d].size != 2) continue;
    const uint8_t one = sheet[owners[d].cell[0]], other = sheet[owners[d].cell[1]];
    std::replace(sheet.begin(), sheet.end(), one, other);
  }
  std::array<int, 8> number{-1, -1, -1, -1, -1, -1, -1, -1};  // of the vertex of each sheet
  for (unsigned c = 0; c < 8; ++c) {
    if (!in(cells, c) || (in(cells, c ^ 1) && in(cells, c ^ 2) && in(cells, c ^ 4))) continue;
    int& n = number[sheet[c]];
    if (n < 0) n = out.vertices++;
    out.vertex[c] = static_cast<uint8_t>(n);
  }
  for (uint8_t d = 0; d < 6; ++d)
    for (size_t i = 0; i < owners[d].size; i += 2) {  // two faces of one sheet have the edge
      const uint8_t c = owners[d].cell[i];
      out.links[out.link_count++] = {out.vertex[c], d, c};
    }
  std::sort(out.links.begin(), out.links.begin() + out.link_count,
            [](const Link& l, const Link& r) { return std::tie(l.vertex, l.direction, l.cell) < std::tie(r.vertex, r.direction, r.cell); });
  return out;
}

}  // namespace

constinit const std::array<Corner, 256> kCorners = [] {
  std::array<Corner, 256> table;
  for (unsigned c = 0; c < 256; ++c) table[c] = corner_with(c);
  return table;
}();

}  // namespace teracell::exports::faces
