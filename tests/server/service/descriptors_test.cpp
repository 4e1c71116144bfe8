// The shares of connections and files, and what is said when there are too few descriptors.
#include "server/service/descriptors.hpp"

#include "store/base/error.hpp"
#include "tests/support/test.hpp"

namespace teracell::server {
namespace {

TEST_CASE("The number of grids counts, within limits", "[server]") {
  CHECK(wanted_descriptors(1024, 1000, 2, 3).files == 1000);
  CHECK(wanted_descriptors(1024, 1, 2, 3).files == 64);
  CHECK(wanted_descriptors(1024, 100'000, 2, 3).files == 4096);
  CHECK(wanted_descriptors(1024, 1, 16, 3).others > wanted_descriptors(1024, 1, 2, 3).others);
}

TEST_CASE("What is allowed is never exceeded, and everybody gets some", "[server]") {
  for (const uint64_t connections : {1, 7, 100, 1024, 1'000'000})
    for (const uint64_t grids : {0, 5, 5200})
      for (const uint64_t threads : {1, 64}) {
        const DescriptorShares wanted = wanted_descriptors(connections, grids, threads, 3);
        uint64_t least = 0;
        for (uint64_t allowed = 0; allowed <= wanted.all() + 10 && allowed < 10'000; ++allowed) try {
            const DescriptorShares got = allowed_descriptors(wanted, allowed);
            if (least == 0) least = allowed;
            if (got.all() > allowed || got.connections == 0 || got.files == 0 || got.connections > connections || got.files > wanted.files ||
                got.others != wanted.others)
              FAIL(connections << " " << grids << " " << threads << " " << allowed);
            if (allowed >= wanted.all() && (got.connections != connections || got.files != wanted.files)) FAIL("less than allowed");
          } catch (const IoError&) {
            if (least != 0) FAIL("refused " << allowed << ", not " << least);
          }
        CHECK(least > wanted.others);
        CHECK(least <= wanted.others + 16);
      }
}

TEST_CASE("Files give way before connections, but keep a quarter", "[server]") {
  const DescriptorShares wanted = wanted_descriptors(1000, 5000, 1, 3);
  CHECK(allowed_descriptors(wanted, wanted.others + 1500).connections == 1000);
  CHECK(allowed_descriptors(wanted, wanted.others + 1500).files == 500);
  CHECK(allowed_descriptors(wanted, wanted.others + 400).files == 100);
  CHECK(allowed_descriptors(wanted, wanted.others + 400).connections == 300);
}

TEST_CASE("Too few descriptors: how many are needed, how many are allowed, what to do", "[server]") {
  const DescriptorShares wanted{1024, 64, 40};
  CHECK_THROWS_WITH(allowed_descriptors(wanted, 8), Catch::Contains("at least 56") && Catch::Contains("found 8:") &&
                                                        Catch::Contains("ulimit -n 1128") && Catch::Contains("LimitNOFILE"));
}

}  // namespace
}  // namespace teracell::server
