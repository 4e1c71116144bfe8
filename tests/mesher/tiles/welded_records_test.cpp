// Records of facets whose vertices are kept once: they come back byte for byte.
#include "mesher/tiles/welded_records.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <random>

#include "tests/support/catch.hpp"

namespace teracell::mesher {
namespace {

using Bytes = std::vector<uint8_t>;

Bytes random_bytes(std::mt19937_64& random, size_t count) {
  Bytes out(count);
  for (uint8_t& byte : out) byte = static_cast<uint8_t>(random());
  return out;
}

Bytes records_of(const WeldedRecords& block, const RecordShape& shape) {
  Bytes out;
  size_t next = 0;
  block.for_each_run([&](size_t first, size_t last, std::span<const uint8_t> rest) {
    REQUIRE(first == next);
    REQUIRE(last > first);
    REQUIRE(rest.size() == shape.rest);
    for (size_t i = first; i < last; ++i) {
      for (const uint32_t number : block.vertices_of(i)) {
        REQUIRE(number < block.vertices());
        std::ranges::copy(block.vertex(number), std::back_inserter(out));
      }
      std::ranges::copy(rest, std::back_inserter(out));
    }
    next = last;
  });
  REQUIRE(next == block.records());
  return out;
}

TEST_CASE("Records come back byte for byte and in their order, however few or many vertices they share, and take little more room at worst") {
  std::mt19937_64 random(1);
  const RecordShape shape{GENERATE(size_t{12}, size_t{24}), GENERATE(size_t{4}, size_t{8})};
  RecordWelder welder(shape);
  WeldedRecords read(shape);
  UnfilledVector<uint8_t> block;
  for (const size_t pool : {1, 2, 3, 200, 254, 255, 256, 257, 6000})
    for (const size_t count : {1, 2, 90, 700, 5000}) {
      std::vector<Bytes> vertices(pool), rests(3);
      for (Bytes& vertex : vertices) vertex = random_bytes(random, shape.vertex);
      for (size_t i = 1; i < pool; i += 2) vertices[i] = vertices[i - 1], vertices[i][random() % shape.vertex] ^= 1;  // nearly equal
      for (Bytes& rest : rests) rest = random_bytes(random, shape.rest);
      Bytes records;
      for (size_t i = 0; i < count; ++i) {
        // Near one another as in a surface, anywhere in turn, or each one new.
        for (size_t k = 0; k < 3; ++k) {
          const size_t near = i / 2 + random() % 20, which = pool == 6000 ? 3 * i + k : i % 3 == 0 ? random() : near;
          std::ranges::copy(vertices[which % pool], std::back_inserter(records));
        }
        std::ranges::copy(rests[count % 2 == 0 ? i / 7 % 3 : random() % 3], std::back_inserter(records));
      }
      welder.weld(records, block);
      CAPTURE(shape.vertex, shape.rest, pool, count);
      REQUIRE(block.size() <= RecordWelder::most_bytes(records.size()));
      read.read(block);
      REQUIRE((records_of(read, shape) == records));
    }
}

TEST_CASE("Of a sheet of facets nearly every vertex is kept once, in less than a third of the bytes, some blocks after facets in no order as well") {
  constexpr uint32_t kWide = 30, kHigh = 8;
  const RecordShape shape{12, 4};
  std::mt19937_64 random(2);
  Bytes records;
  const auto put = [&](uint32_t x, uint32_t y) {
    const std::array<uint32_t, 3> vertex{x, y, x * y};
    const auto* bytes = reinterpret_cast<const uint8_t*>(vertex.data());
    records.insert(records.end(), bytes, bytes + sizeof vertex);
  };
  for (uint32_t y = 0; y < kHigh; ++y)
    for (uint32_t x = 0; x < kWide; ++x) {
      put(x, y), put(x + 1, y), put(x, y + 1), records.resize(records.size() + 4, 7);
      put(x + 1, y), put(x + 1, y + 1), put(x, y + 1), records.resize(records.size() + 4, 7);
    }
  RecordWelder welder(shape);
  UnfilledVector<uint8_t> block;
  WeldedRecords read(shape);
  for (int again = 0; again < 3; ++again) {
    if (again == 2) {
      const Bytes unlike = random_bytes(random, 200 * shape.bytes());
      for (const Bytes& of_block : {unlike, records}) {  // the sheet is not looked at, yet it comes back
        welder.weld(of_block, block);
        read.read(block);
        REQUIRE((records_of(read, shape) == of_block));
        CHECK(read.vertices() == 3 * read.records());
      }
      for (int more = 0; more < 20; ++more) welder.weld(records, block);
    }
    welder.weld(records, block);
    read.read(block);
    REQUIRE((records_of(read, shape) == records));
    CHECK(read.vertices() >= (kWide + 1) * (kHigh + 1));
    CHECK(10 * read.vertices() < 11 * (kWide + 1) * (kHigh + 1));
    CHECK(3 * block.size() < records.size());
  }
}

TEST_CASE("Welded facets come back bit for bit, all or some of them, with the bytes that each is to have, one block after another") {
  std::mt19937_64 random(3);
  const bool float32 = GENERATE(true, false);
  const size_t vertex = 3 * (float32 ? sizeof(float) : sizeof(double)), rest_bytes = GENERATE(size_t{0}, size_t{4}, size_t{8});
  const auto welder = std::make_unique<FacetWelder>();
  std::vector<std::vector<Facet>> all;
  UnfilledVector<uint8_t> blocks;
  const Bytes rest = random_bytes(random, rest_bytes);
  for (const size_t pool : {1, 2, 40, 250, 100'000})
    for (const size_t count : {size_t{1}, size_t{2}, size_t{77}, FacetWelder::kMost}) {
      const auto coordinate = [&] { return static_cast<double>(static_cast<float>(static_cast<int64_t>(random())) * 0x1p-40F); };
      std::vector<Vec3> vertices(std::min(pool, 3 * count));
      for (Vec3& v : vertices) v = {coordinate(), coordinate() * (float32 ? 1 : 1.1), -0.0};
      for (size_t i = 1; i < vertices.size(); i += 2) vertices[i] = vertices[i - 1], vertices[i][2] = i % 4 == 1 ? 0.0 : 0x1p-149;  // nearly equal
      std::vector<Facet> facets(count);
      for (size_t f = 0; f < count; ++f)
        for (size_t k = 0; k < 3; ++k) facets[f].vertex[k] = vertices[(pool > 250 ? 3 * f + k : random()) % vertices.size()];
      welder->weld(facets);
      REQUIRE(welder->vertices().size() <= 3 * count);
      for (size_t f = 0; f < count; ++f)
        for (size_t k = 0; k < 3; ++k) {
          const Vec3& found = welder->vertices()[welder->vertices_of(f)[k]];
          REQUIRE(std::memcmp(&found, &facets[f].vertex[k], sizeof found) == 0);
        }
      UnfilledVector<uint8_t> alone;
      welder->append_to(alone, float32);
      WeldedRecords block({vertex, 0});
      block.read(alone);
      REQUIRE(block.rest_of_all());
      block.append_all(rest, blocks), all.push_back(facets);
      std::vector<uint32_t> which;
      std::vector<Facet> some;
      for (uint32_t f = 0; f < count; ++f)
        if (random() % 3 == 0) which.push_back(f), some.push_back(facets[f]);
      if (which.empty()) continue;
      block.append_some(which, rest, blocks), all.push_back(some);
    }
  size_t next = 0;
  WeldedRecords block({vertex, rest_bytes});
  WeldedRecords::for_each(blocks, [&](std::span<const uint8_t> bytes) {
    REQUIRE(next < all.size());
    const std::vector<Facet>& expected = all[next++];
    block.read(bytes);
    REQUIRE(WeldedRecords::records_in(bytes) == expected.size());
    REQUIRE(block.rest_of_all());
    REQUIRE(std::ranges::equal(*block.rest_of_all(), rest));
    std::vector<Facet> found;
    block.facets(found);
    REQUIRE(found.size() == expected.size());
    REQUIRE(std::memcmp(found.data(), expected.data(), found.size() * sizeof(Facet)) == 0);
  });
  REQUIRE(next == all.size());
}

}  // namespace
}  // namespace teracell::mesher
