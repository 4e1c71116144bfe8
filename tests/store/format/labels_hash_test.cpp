#include "store/format/labels_hash.hpp"

#include <map>
#include <random>

#include "tests/support/catch.hpp"

using namespace teracell;

namespace {

constexpr uint64_t kPrime = (uint64_t{1} << 61) - 1;

uint64_t times(uint64_t a, uint64_t b) { return static_cast<uint64_t>(static_cast<unsigned __int128>(a) * b % kPrime); }

uint64_t power(uint64_t base, int64_t exponent) {
  uint64_t out = 1;
  for (; exponent > 0; exponent >>= 1, base = times(base, base))
    if (exponent & 1) out = times(out, base);
  return out;
}

// FORMAT.md 7.11, cell by cell.
uint64_t by_cells(const std::map<Index3, uint64_t>& keys) {
  uint64_t sum = 0;
  for (const auto& [cell, key] : keys)
    sum =
        (sum + times(key, times(power(314159265358979323, cell[0]), times(power(271828182845904523, cell[1]), power(141421356237309504, cell[2]))))) %
        kPrime;
  return sum;
}

Metadata metadata(const Index3& cells, int ray_axis) {
  Metadata meta;
  for (int d = 0; d < 3; ++d) meta.grid.axis[d] = Axis::uniform(0, 1, 0, cells[d], 0.5);
  meta.ray_axis = ray_axis;
  meta.materials = {{"air", "#00000000", 1}, {"steel", "#8899aa", 0}};
  meta.labels = {{0, ""}, {1, "hull"}, {1, "mast"}};
  return meta;
}

uint64_t key(const std::string& name) { return checksum({reinterpret_cast<const uint8_t*>(name.data()), name.size()}) % kPrime; }

}  // namespace

TEST_CASE("the sum of labels is that of the cells one by one, along any axis, in blocks of any place") {
  std::mt19937 random(7);
  const std::array<uint64_t, 3> keys = {key(std::string("air\0", 4)), key(std::string("steel\0hull", 10)), key(std::string("steel\0mast", 10))};
  const Index3 n{7, 90, 264000};  // more cells than there are powers in a table
  for (int axis = 0; axis < 3; ++axis) {
    const Metadata meta = metadata(n, axis);
    const LabelsAdder adder(meta);
    const RayFrame f = meta.frame();
    for (int round = 0; round < 20; ++round) {
      Index3 first, size;
      for (const int d : {0, 1, 2}) {
        const int a = std::array{f.u, f.v, f.w}[static_cast<size_t>(d)];
        size[d] = 1 + static_cast<int64_t>(random() % std::min<uint64_t>(static_cast<uint64_t>(n[a]), 70));
        first[d] = static_cast<int64_t>(random()) % (n[a] - size[d] + 1);
        if (round % 2) first[d] = n[a] - size[d];
      }
      size[2] = std::min<int64_t>(size[2], 12);
      RayBlock rays;
      rays.reset(static_cast<uint32_t>(size[0]), static_cast<uint32_t>(size[1]), static_cast<uint32_t>(size[2]));
      std::map<Index3, uint64_t> cells;
      std::vector<SetId> sets;
      std::vector<uint32_t> changes;
      for (int64_t v = 0; v < size[1]; ++v)
        for (int64_t u = 0; u < size[0]; ++u) {
          if (random() % 3 == 0 || sets.empty()) {
            sets = {static_cast<SetId>(random() % 3)}, changes.clear();
            for (uint32_t w = 1; w < size[2]; ++w)
              if (random() % 4 == 0) sets.push_back((sets.back() + 1 + static_cast<SetId>(random() % 2)) % 3), changes.push_back(w);
          }
          rays.append(sets, changes);
          rays.for_each_run(static_cast<uint32_t>(v * size[0] + u), [&](uint32_t from, uint32_t to, SetId set) {
            for (uint32_t w = from; w < to; ++w) cells[f.cell(first[0] + u, first[1] + v, first[2] + w)] = keys[set];
          });
        }
      REQUIRE(adder.sum(first, rays).value == by_cells(cells));
    }
  }
}

TEST_CASE("the sum of a block of one label is that of its cells") {
  const Metadata meta = metadata({9, 7, 11}, 0);
  RayBlock rays;
  rays.fill(2, 3, 4, 1);
  std::map<Index3, uint64_t> cells;
  for (int64_t x = 5; x < 9; ++x)
    for (int64_t y = 1; y < 3; ++y)
      for (int64_t z = 2; z < 5; ++z) cells[{x, y, z}] = key(std::string("steel\0hull", 10));
  CHECK(LabelsAdder(meta).sum(Index3{1, 2, 5}, rays).value == by_cells(cells));
}

TEST_CASE("the hash of labels tells grids apart by axes, names and cells, not by how labels are numbered") {
  const Metadata meta = metadata({4, 5, 6}, 2);
  RayBlock rays;
  rays.fill(4, 5, 6, 1);
  const std::string hash = labels_hash(meta, LabelsAdder(meta).sum(Index3{0, 0, 0}, rays));
  Metadata other = meta;
  std::swap(other.labels[1], other.labels[2]);
  CHECK(labels_hash(other, LabelsAdder(other).sum(Index3{0, 0, 0}, rays)) != hash);
  rays.fill(4, 5, 6, 2);
  CHECK(labels_hash(other, LabelsAdder(other).sum(Index3{0, 0, 0}, rays)) == hash);
  CHECK(labels_hash(meta, LabelsAdder(meta).sum(Index3{0, 0, 0}, rays)) != hash);
  other.grid.axis[1] = Axis::uniform(0, 1.5, 0, 5, 0.5);
  CHECK(labels_hash(other, LabelsAdder(other).sum(Index3{0, 0, 0}, rays)) != hash);
}
