#include "store/format/cell_sums.hpp"

namespace teracell::inline store {
namespace {

void add(std::vector<LabelAmount>& amounts, Label label, unsigned __int128 cells, const Box& box) {
  if (label >= amounts.size()) amounts.resize(size_t{label} + 1);
  amounts[label].add(cells, box);
}

}  // namespace

void CellSums::add_amounts(const LevelShape& shape, const RayFrame& frame, const ChunkKey& key, const ChunkEntry& entry) {
  const Index3 first = {int64_t{key.cu} * shape.chunk_rays, int64_t{key.cv} * shape.chunk_rays, int64_t{key.segment} * shape.chunk_cells};
  const auto in_grid = [&](uint32_t u, uint32_t v, uint32_t w) { return Index3{first[0] + u, first[1] + v, first[2] + w}; };
  if (entry.size == 0) {
    const uint32_t nu = shape.rays_u(key.cu), nv = shape.rays_v(key.cv), length = shape.length(key.segment);
    const uint64_t cells = uint64_t{nu} * nv * length;
    add(amounts, entry.uniform[0], cells, frame.box(first, in_grid(nu, nv, length)));
  } else {
    for (const LabelStats& s : entry.stats)
      add(amounts, s.label, s.cells, frame.box(in_grid(s.lo[0], s.lo[1], s.lo[2]), in_grid(s.hi[0], s.hi[1], s.hi[2])));
  }
}

CellSums& CellSums::operator+=(const CellSums& other) {
  labels += other.labels;
  for (size_t label = 0; label < other.amounts.size(); ++label)
    if (const LabelAmount& a = other.amounts[label]; a.cells != 0) add(amounts, static_cast<Label>(label), a.cells, a.box);
  return *this;
}

void CellSums::save(Bytes& out) const {
  put_varint(out, labels.value);
  put_varint(out, amounts.size());
  for (const LabelAmount& a : amounts) {
    put_varint(out, static_cast<uint64_t>(a.cells));
    put_varint(out, static_cast<uint64_t>(a.cells >> 64));
    for (const int64_t at : a.box.corners()) put_varint(out, static_cast<uint64_t>(at));
  }
}

CellSums CellSums::restored(ByteReader& in) {
  CellSums out;
  out.labels.value = in.varint(0, LabelsSum::kMost, "sums");
  out.amounts.resize(in.varint(0, in.remaining() / 8, "labels"));
  for (LabelAmount& a : out.amounts) {
    a.cells = in.varint();
    a.cells |= static_cast<unsigned __int128>(in.varint()) << 64;
    for (Index3* corner : {&a.box.lo, &a.box.hi})
      for (int64_t& at : *corner) at = static_cast<int64_t>(in.varint(0, Axis::kMaxCells, "places of cells"));
  }
  return out;
}

}  // namespace teracell::store
