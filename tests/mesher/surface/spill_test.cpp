// Temporary files, and records that wait in them by bucket.
#include "store/base/spill.hpp"

#include "mesher/closing/buckets.hpp"
#include "store/base/error.hpp"
#include "tests/support/descriptors.hpp"
#include "tests/support/meshed.hpp"

namespace teracell::mesher {
namespace {

namespace fs = std::filesystem;
using testing::open_descriptors;
using testing::TempFolder;

std::vector<uint8_t> bytes(uint8_t first, size_t count) {
  std::vector<uint8_t> out(count);
  std::iota(out.begin(), out.end(), first);
  return out;
}

TEST_CASE("A temporary file gives back what was written, anywhere and in any order") {
  const TempFolder folder;
  const bool in_memory = GENERATE(false, true);
  SpillFile file(in_memory ? folder / "none" : folder.path(), 0, in_memory);
  CHECK(file.in_memory() == in_memory);
  const std::vector<uint8_t> far = bytes(3, 5000), near = bytes(200, 300), over = bytes(9, 10);
  file.write(uint64_t{1} << 33, far);  // beyond 4 GiB: a hole takes no room
  file.write(0, near);
  file.write(100, over);
  file.write(77, {});
  std::vector<uint8_t> out(5000);
  file.read(uint64_t{1} << 33, out);
  CHECK(out == far);
  out.resize(300);
  file.read(0, out);
  std::vector<uint8_t> expected = near;
  std::ranges::copy(over, expected.begin() + 100);
  CHECK(out == expected);
}

TEST_CASE("A temporary file has no name while it is used, and is gone with its descriptor afterwards") {
  const TempFolder folder;
  const size_t before = open_descriptors();
  for (const bool in_memory : {false, true}) {
    SpillFile file(folder.path(), 0, in_memory);
    file.write(0, bytes(0, 100));
    CHECK(fs::is_empty(folder.path()));
    CHECK(open_descriptors() == before + 1);
  }
  CHECK(open_descriptors() == before);
  CHECK(fs::is_empty(folder.path()));
}

TEST_CASE("Reading behind the end of a temporary file is an error") {
  const TempFolder folder;
  SpillFile file(folder.path(), 0);
  file.write(0, bytes(0, 100));
  std::vector<uint8_t> out(100);
  CHECK_THROWS_AS(file.read(1, out), IoError);
}

TEST_CASE("A folder that is not there, or has too little room, is an error that names the folder") {
  const TempFolder folder;
  CHECK_THROWS_WITH(SpillFile(folder / "nowhere", 0), Catch::Contains("nowhere"));
  CHECK_THROWS_AS(SpillFile(folder / "nowhere", 0), IoError);
  CHECK_THROWS_WITH(SpillFile(folder.path(), ~uint64_t{0}), Catch::Contains(folder.path().string()));
  CHECK_NOTHROW(SpillFile(folder.path(), 1));
}

struct Record {
  uint64_t number;
  uint32_t bucket, check;
  friend bool operator==(const Record&, const Record&) = default;
};

TEST_CASE("Buckets give back their records in the order in which they were added, in memory or spilled") {
  const TempFolder folder;
  std::mt19937_64 random(1);
  for (const uint64_t memory : {uint64_t{0}, 3 * sizeof(Record), uint64_t{5000}, ~uint64_t{0}}) {
    const size_t before = open_descriptors();
    Buckets<Record> buckets(7, memory, folder.path());
    std::vector<std::vector<Record>> expected(7);
    for (uint64_t i = 0; i < 1000; ++i) {
      const auto bucket = static_cast<uint32_t>(random() % 6);  // the last one stays empty
      expected[bucket].push_back({i, bucket, static_cast<uint32_t>(random())});
      buckets.add(bucket, expected[bucket].back());
      if (i % 300 == 0) REQUIRE(buckets.load(bucket) == expected[bucket]);
    }
    REQUIRE(buckets.count() == 7);
    for (size_t b = 0; b < 7; ++b) REQUIRE(buckets.load(b) == expected[b]);
    CHECK((open_descriptors() > before) == (memory < 1000 * sizeof(Record)));
  }
}

TEST_CASE("Buckets that fit into memory need no folder") {
  Buckets<Record> buckets(2, 1000, "/nowhere");
  buckets.add(1, {5, 1, 9});
  CHECK(buckets.load(1) == std::vector<Record>{{5, 1, 9}});
  CHECK_THROWS_AS(
      [&] {
        for (uint64_t i = 0; i < 1000; ++i) buckets.add(0, {i, 0, 0});
      }(),
      IoError);
}

}  // namespace
}  // namespace teracell::mesher
