// Boxes in parts against the cells one by one.
#include "server/parts/box_parts.hpp"

#include "store/grid/vtk_header.hpp"
#include "store/text/npy_header.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

namespace teracell::server {
namespace {

using namespace testing;

std::string whole_file(Parts& parts) {
  std::string all;
  for (bool more = true; more;) {
    std::string part;
    more = parts.append(part);
    REQUIRE(part.size() < size_t{3} << 20);  // however long the rows are
    all += part;
  }
  return all;
}

TEST_CASE("The parts of a box are a header, the cells in the order z, y, x, and an end", "[server]") {
  std::mt19937_64 random(8);
  // Several layers are read at once, rows of a layer, or parts of a row.
  for (const Index3& n : {Index3{70, 50, 40}, Index3{1500, 900, 2}, Index3{1'100'000, 2, 1}}) {
    const Metadata meta = metadata_of(uniform_grid(3, 0.5, n), 1, 3);
    const auto cells = random_cells(random, n, 3);
    const GridReader reader = reader_of(meta, cells);
    for (int i = 0; i < (kSanitized ? 2 : 4); ++i) {
      Box box{{0, 0, 0}, n};
      if (i > 0)
        for (int d = 0; d < 3; ++d) {
          box.lo[d] = random_int(random, 0, static_cast<int>(n[d]) - 1);
          box.hi[d] = random_int(random, static_cast<int>(box.lo[d]) + 1, static_cast<int>(n[d]));
        }
      std::string expected;
      for (int64_t z = box.lo[2]; z < box.hi[2]; ++z)
        for (int64_t y = box.lo[1]; y < box.hi[1]; ++y)
          for (int64_t x = box.lo[0]; x < box.hi[0]; ++x) expected += static_cast<char>(cells[static_cast<size_t>((z * n[1] + y) * n[0] + x)]);
      const Index3 size = {box.hi[0] - box.lo[0], box.hi[1] - box.lo[1], box.hi[2] - box.lo[2]};
      const Bytes head = npy_header("|u1", {size[2], size[1], size[0]});
      CHECK(whole_file(*box_parts(reader, box, BoxFormat::kNpy)) == std::string(head.begin(), head.end()) + expected);
      const Vec3 origin = {3 + 0.5 * static_cast<double>(box.lo[0]), 3 + 0.5 * static_cast<double>(box.lo[1]),
                           3 + 0.5 * static_cast<double>(box.lo[2])};
      const VtkGrid vtk{size, origin, {0.5, 0.5, 0.5}, {}, meta.materials};
      CHECK(whole_file(*box_parts(reader, box, BoxFormat::kVti)) == vtk_header(vtk, 1) + expected + kVtkFooter);
    }
  }
}

TEST_CASE("A file that lists planes has so few of them that they fit into memory", "[server]") {
  CHECK_NOTHROW(expect_few_planes({kMostVtkPlanes - 1, 1, 1}));
  CHECK_THROWS_WITH(expect_few_planes({1, kMostVtkPlanes, 1}), Catch::Contains("expected fewer cells along y, found 1048576"));
}

}  // namespace
}  // namespace teracell::server
