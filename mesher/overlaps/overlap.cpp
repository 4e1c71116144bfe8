#include "mesher/overlaps/overlap.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace teracell::mesher {
namespace {

auto order(const Index3& c) { return std::tuple(c[2], c[1], c[0]); }

}  // namespace

void Overlap::add(const Overlap& other) {
  cells += other.cells;
  third |= other.third;
  for (int d = 0; d < 3; ++d) box.lo[d] = std::min(box.lo[d], other.box.lo[d]), box.hi[d] = std::max(box.hi[d], other.box.hi[d]);
  if (order(other.at) < order(at)) at = other.at;
}

void OverlapPacker::put(const Overlap& o) {
  const uint64_t bodies = uint64_t{o.bodies[0]} << 32 | o.bodies[1];
  put_varint(bytes_, bodies - std::exchange(last_, bodies));
  put_varint(bytes_, static_cast<uint64_t>(o.cells));
  put_varint(bytes_, static_cast<uint64_t>(o.cells >> 64) << 1 | o.third);
  for (int d = 0; d < 3; ++d)
    for (const int64_t n : {o.box.lo[d], o.box.hi[d] - o.box.lo[d], o.at[d] - o.box.lo[d]}) put_varint(bytes_, static_cast<uint64_t>(n));
}

Bytes OverlapPacker::take() {
  last_ = 0;
  return std::exchange(bytes_, {});
}

std::optional<Overlap> OverlapUnpacker::next() {
  if (in_.remaining() == 0) return std::nullopt;
  last_ += in_.varint(1, ~last_, "the step to the next pair of bodies");
  Overlap o;
  o.bodies = {static_cast<uint32_t>(last_ >> 32), static_cast<uint32_t>(last_)};
  o.cells = in_.varint();
  const uint64_t rest = in_.varint();
  o.cells |= static_cast<unsigned __int128>(rest >> 1) << 64;
  o.third = rest & 1;
  for (int d = 0; d < 3; ++d) {
    const auto in = [&](int64_t lo, int64_t hi) {
      return static_cast<int64_t>(in_.varint(static_cast<uint64_t>(lo), static_cast<uint64_t>(hi), "a cell of an overlap"));
    };
    o.box.lo[d] = in(0, Axis::kMaxCells - 1);
    o.box.hi[d] = o.box.lo[d] + in(1, Axis::kMaxCells - o.box.lo[d]);
    o.at[d] = o.box.lo[d] + in(0, o.box.hi[d] - o.box.lo[d] - 1);
  }
  return o;
}

}  // namespace teracell::mesher
