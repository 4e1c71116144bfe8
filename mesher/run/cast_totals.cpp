#include "mesher/run/cast_totals.hpp"

namespace teracell::mesher {

void CastTotals::add(const RowTotals& row) {
  crossings += row.crossings;
  exact_decisions += row.exact_decisions;
  sums.labels += row.labels;
  for (const BodyCells& b : row.cells) cells[b.body] += b.owned, covered[b.body] += b.covered;
  tallies.add(row.tallies);
  overlaps.add(row.overlaps);
  for (const auto& [label, n] : row.shares) shares[label] += n;
}

void CastTotals::add(const CastTotals& other) {
  crossings += other.crossings;
  exact_decisions += other.exact_decisions;
  sums += other.sums;
  for (size_t b = 0; b < cells.size(); ++b) cells[b] += other.cells[b], covered[b] += other.covered[b];
  tallies.add(other.tallies);
  overlaps.add(other.overlaps);
  for (const auto& [label, n] : other.shares) shares[label] += n;
}

void CastTotals::save(Bytes& out) const {
  put_varint(out, crossings);
  put_varint(out, exact_decisions);
  sums.save(out);
  put_varint(out, cells.size());
  for (const auto* counts : {&cells, &covered})
    for (const unsigned __int128 n : *counts) {
      put_fixed(out, static_cast<uint64_t>(n));
      put_fixed(out, static_cast<uint64_t>(n >> 64));
    }
  tallies.save(out);
  overlaps.save(out);
  put_varint(out, shares.size());
  for (const auto& [label, n] : shares) put_varint(out, label), put_fixed(out, static_cast<uint64_t>(n));
}

CastTotals CastTotals::restored(ByteReader& in) {
  CastTotals out;
  out.crossings = in.varint();
  out.exact_decisions = in.varint();
  out.sums = CellSums::restored(in);
  const uint64_t bodies = in.varint(0, in.remaining() / 32, "bodies");
  for (auto* counts : {&out.cells, &out.covered}) {
    counts->resize(bodies);
    for (unsigned __int128& n : *counts) {
      n = in.fixed<uint64_t>();
      n |= static_cast<unsigned __int128>(in.fixed<uint64_t>()) << 64;
    }
  }
  out.tallies = Tallies::restored(in);
  out.overlaps = OverlapSum::restored(in);
  for (uint64_t left = in.varint(0, in.remaining() / 9, "labels with shares"); left > 0; --left) {
    const auto label = static_cast<uint32_t>(in.varint());
    out.shares[label] = static_cast<int64_t>(in.fixed<uint64_t>());
  }
  return out;
}

}  // namespace teracell::mesher
