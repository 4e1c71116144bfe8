// What stands for a set of labels: ids of materials, and bytes of these.
#include "store/grid/set_value.hpp"

#include "tests/support/stored.hpp"
#include "tests/support/test.hpp"

namespace teracell {
namespace {

using namespace testing;

TEST_CASE("Where one material must stand for a set it is the one of least rank, the background last") {
  Metadata meta = metadata_of({}, 2, 4);
  meta.materials[0].rank = 3, meta.materials[1].rank = 2, meta.materials[2].rank = 0, meta.materials[3].rank = 1;
  meta.labels = {{0, ""}, {3, "a"}, {1, "b"}, {2, "c"}, {3, "d"}};
  const SetValue material = strongest_material(meta);
  REQUIRE(material({0}) == 0);
  REQUIRE(material({0, 2}) == 1);
  REQUIRE(material({0, 1, 2}) == 3);
  REQUIRE(material({0, 1, 2, 3, 4}) == 2);
  REQUIRE(material({1, 4}) == 3);
}

TEST_CASE("The materials of a set ascend, and each is there once") {
  Metadata meta = metadata_of({}, 2, 4);
  meta.labels = {{0, ""}, {3, "a"}, {1, "b"}, {3, "c"}, {0, "d"}};
  REQUIRE(materials_of(meta, {0, 1, 2, 3, 4}) == std::vector<uint32_t>{0, 1, 3});
  REQUIRE(materials_of(meta, {1, 3}) == std::vector<uint32_t>{3});
}

TEST_CASE("Ids take one byte, or two, little endian, if there are more than 256 materials") {
  REQUIRE_FALSE(wide_labels(metadata_of({}, 2, 256)));
  REQUIRE(wide_labels(metadata_of({}, 2, 257)));
  const std::vector<uint16_t> ids = {0, 7, 255, 256, 0xABCD};
  Bytes bytes = {42};
  put_labels(bytes, std::span(ids).first(3), false);
  REQUIRE(bytes == Bytes{42, 0, 7, 255});
  put_labels(bytes, ids, true);
  REQUIRE(bytes == Bytes{42, 0, 7, 255, 0, 0, 7, 0, 255, 0, 0, 1, 0xCD, 0xAB});
}

}  // namespace
}  // namespace teracell
