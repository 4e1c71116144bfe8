// What is to be how fine, as people type it.
#include "store/refine/refinement.hpp"

#include "store/base/error.hpp"
#include "tests/support/stored.hpp"

namespace teracell {
namespace {

using namespace testing;

Metadata with_names() {
  Metadata meta = metadata_of(unit_grid({10, 20, 30}), 2, 3);
  meta.materials[1].name = R"(steel, "A=3")", meta.materials[2].name = "a=b";
  return meta;
}

TEST_CASE("Levels, layers and selectors are read, names with commas and quotes too, and the finest counts") {
  const Metadata meta = with_names();
  const Refinement plain = parse_refinement(meta, "5", "", "--refine", "--want");
  CHECK((plain.coarsest == 5 && plain.layers == 2 && plain.interfaces == 0 && plain.of_materials.empty() && plain.boxes.empty()));
  const Refinement r = parse_refinement(
      meta, "8,3",
      R"(interface=5,interface=4,interface=6,material:"steel, ""A=3"""=2,material:"steel, ""A=3"""=1,inside:a=b=3,box:0,0,0,5,6,7=2,box:-9,0,0,99,1,1=0)",
      "--refine", "--want");
  CHECK((r.coarsest == 8 && r.layers == 3 && r.interfaces == 4));
  CHECK(r.of_materials == std::vector<int>{kNoLevel, 1, kNoLevel});
  CHECK(r.inside == std::vector<int>{kNoLevel, kNoLevel, 3});
  REQUIRE(r.boxes.size() == 2);
  CHECK((r.boxes[0].box == Box{{0, 0, 0}, {5, 6, 7}} && r.boxes[0].level == 2));
  CHECK((r.boxes[1].box == Box{{0, 0, 0}, {10, 1, 1}} && r.boxes[1].level == 0));
}

TEST_CASE("What is no refinement is refused with what was expected and found") {
  const Metadata meta = with_names();
  for (const auto& [levels, wants, words] : std::vector<std::array<const char*, 3>>{{"", "", "M,N"},
                                                                                    {"3,", "", "'3,'"},
                                                                                    {"3,0", "", "1 to 100"},
                                                                                    {"17", "", "0 to 16"},
                                                                                    {"1,2,3", "", "'1,2,3'"},
                                                                                    {"3", "interface", "interface=L"},
                                                                                    {"3", "interface=17", "0 to 16"},
                                                                                    {"3", "interface=-1", "'interface=-1'"},
                                                                                    {"3", "steel=1", "'steel=1'"},
                                                                                    {"3", "material:=1", "one name"},
                                                                                    {"3", "material:gold=1", "no material 'gold'"},
                                                                                    {"3", "inside:\"a=1", "closing quote"},
                                                                                    {"3", "box:0,0,0,5,6=1", "box:X0"},
                                                                                    {"3", "box:5,0,0,5,6,7=1", "'box:5,0,0,5,6,7'"},
                                                                                    {"3", "box:10,0,0,15,6,7=1", "10 x 20 x 30"},
                                                                                    {"3", "patch:xmin=1", "no links"},
                                                                                    {"3", ",", "found ''"}}) {
    INFO(levels << " " << wants);
    CHECK_THROWS_WITH(parse_refinement(meta, levels, wants, "--refine", "--want"), Catch::Contains(words) && Catch::StartsWith("--"));
    CHECK_THROWS_AS(parse_refinement(meta, levels, wants, "--refine", "--want"), UsageError);
  }
}

}  // namespace
}  // namespace teracell
