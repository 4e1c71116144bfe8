// Columns in parts against the same columns made at once.
#include "server/parts/column_parts.hpp"

#include "server/service/deflate.hpp"
#include "store/whole/info.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/served_cells.hpp"

namespace teracell::server {
namespace {

using namespace testing;

// All parts, and their number.
std::pair<std::string, int> joined_parts(Parts& parts) {
  std::string all;
  int n = 0;
  for (bool more = true; more; ++n) {
    std::string part;
    more = parts.append(part);
    REQUIRE(part.size() < Parts::kEnough + 10'000);
    all += part;
  }
  return {all, n};
}

TEST_CASE("The parts of a column are those of the whole one, whatever the ray axis, and with gzip", "[server]") {
  constexpr int64_t kLong = 20'000;
  for (const int ray_axis : {0, 1, 2}) {
    Metadata meta = metadata_of(uniform_grid(0, 0.1, {2, kLong, 3}), ray_axis, 3);
    meta.chunk_cells = 64, meta.chunk_rays = 16;
    meta.materials[1].name = std::string(256, '"');
    std::vector<Label> cells(static_cast<size_t>(2 * 3 * kLong));
    std::mt19937_64 random(5);
    int64_t same = 0;  // cells to come with the label of the last one: 1 or 2 for the most part, now and then thousands
    Label label = 0;
    for (Label& c : cells) {
      if (same-- == 0) label = static_cast<Label>((label + 1) % 3), same = random() % 500 == 0 ? 6000 : static_cast<int64_t>(random() % 2) * 6;
      c = label;
    }
    const GridReader reader = reader_of(meta, cells);
    const auto check = [&](int along, int64_t a, int64_t b, int64_t from, int64_t to) {
      const std::string whole = column_json(meta, along, a, b, read_column(reader, along, a, b, from, to));
      const auto [plain, n] = joined_parts(*column_parts(reader, along, a, b, from, to));
      REQUIRE(plain == whole);
      const auto [gzip, m] = joined_parts(*gzip_parts(column_parts(reader, along, a, b, from, to)));
      REQUIRE(inflated(gzip, whole.size()) == whole);
      return n;
    };
    CHECK(check(1, 0, 1, 0, kLong) > 5);
    CHECK(check(1, 1, 2, 17, kLong - 5) > 5);
    CHECK(check(1, 1, 0, 4711, 4712) == 1);
    CHECK(check(0, 300, 1, 0, 2) == 1);
  }
}

}  // namespace
}  // namespace teracell::server
