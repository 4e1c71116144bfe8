#include "mesher/thin/tally.hpp"

#include <bit>
#include <tuple>

namespace teracell::mesher {
namespace {

auto order(const Index3& c) { return std::tuple(c[2], c[1], c[0]); }

}  // namespace

Vec3 place_of(const TallyKey& key, const Tally& tally, const Grid& grid) {
  Vec3 at;
  for (int d = 0; d < 3; ++d) at[d] = grid.axis[d].centre(tally.cell[d]);
  at[key.axis] = key.what == TallyKey::What::kLowerSide ? grid.axis[key.axis].min()
                                                        : sub_position(grid.axis[key.axis], tally.cell[key.axis], tally.from + tally.widest / 2);
  return at;
}

double length_of(const Axis& axis, int64_t i, uint32_t sub_positions) {
  const double apart = axis.is_graded() ? axis.centre(i + 1) - axis.centre(i) : axis.step();
  return sub_positions / static_cast<double>(kSubPositions) * apart;
}

void Tally::add(const Tally& other) {
  const uint64_t sum = number + other.number;
  if (number == 0 || other.length > length || (other.length == length && order(other.cell) < order(cell))) *this = other;
  number = sum;
}

void Tallies::add(const TallyKey& key, const Tally& tally) {
  const auto [it, fresh] = all_.try_emplace(key, tally);
  if (!fresh) it->second.add(tally);
}

void Tallies::add(const Tallies& other) {
  for (const auto& [key, tally] : other.all_) add(key, tally);
}

const Tally* Tallies::find(const TallyKey& key) const {
  const auto it = all_.find(key);
  return it == all_.end() ? nullptr : &it->second;
}

void Tallies::save(Bytes& out) const {
  put_varint(out, all_.size());
  for (const auto& [key, t] : all_)
    for (const uint64_t n :
         {uint64_t{static_cast<uint8_t>(key.what)}, uint64_t{key.of}, uint64_t{key.axis}, t.number, std::bit_cast<uint64_t>(t.length),
          uint64_t{t.widest}, uint64_t{t.from}, static_cast<uint64_t>(t.cell[0]), static_cast<uint64_t>(t.cell[1]), static_cast<uint64_t>(t.cell[2])})
      put_varint(out, n);
}

Tallies Tallies::restored(ByteReader& in) {
  Tallies out;
  for (uint64_t left = in.varint(); left > 0; --left) {
    TallyKey key{};
    key.what = static_cast<TallyKey::What>(in.varint());
    key.of = static_cast<uint32_t>(in.varint());
    key.axis = static_cast<uint8_t>(in.varint());
    Tally t;
    t.number = in.varint();
    t.length = std::bit_cast<double>(in.varint());
    t.widest = static_cast<uint32_t>(in.varint());
    t.from = static_cast<uint32_t>(in.varint());
    for (int64_t& c : t.cell) c = static_cast<int64_t>(in.varint());
    out.add(key, t);
  }
  return out;
}

}  // namespace teracell::mesher
