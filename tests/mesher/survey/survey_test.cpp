// What a file holds, without a grid.
#include "mesher/survey/survey.hpp"

#include "store/base/error.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/shared_files.hpp"
#include "tests/support/test.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

TEST_CASE("Each open group of a file has its own open edges, however many there are and wherever their facets stand") {
  const TempFolder folder;
  const auto file = folder.path() / "groups.obj";
  constexpr size_t kGroups = 500;
  std::string text;
  for (size_t i = 0; i < kGroups; ++i) text += fmt::format("v {0} 0 0\nv {0} 1 0\nv {0} 0 1\nv {1} 1 1\n", i, static_cast<double>(i) + 0.5);
  for (const size_t turn : {0, 1})  // the facets of a group don't follow each other; every fifth group is closed
    for (size_t i = 0; i < kGroups; ++i) {
      const size_t v = 4 * i + 1;
      text += fmt::format("g part{}\n", i);
      text += turn == 0    ? fmt::format("f {} {} {}\nf {} {} {}\n", v, v + 1, v + 2, v + 1, v, v + 3)
              : i % 5 == 0 ? fmt::format("f {} {} {}\nf {} {} {}\n", v + 2, v + 1, v + 3, v, v + 2, v + 3)
                           : "";
    }
  std::ofstream(file) << text;
  for (const uint64_t budget : {uint64_t{1} << 12, uint64_t{1} << 30}) {
    const FileSurvey found = survey(file, {.bytes = budget, .folder = folder.path()});
    REQUIRE(found.kinds.size() == kGroups);
    for (size_t i = 0; i < kGroups; ++i) {
      REQUIRE(found.kinds[i].path == fmt::format("/part{}", i));
      REQUIRE(found.kinds[i].closed == (i % 5 == 0));
      REQUIRE(found.kinds[i].open_edges == (i % 5 == 0 ? 0 : 4));
    }
  }
}

TEST_CASE("The 3MF consortium's samples have their volumes; what must fail is refused with the reason") {
  const auto folder = shared_files("assemblies");
  if (!folder) return;
  const Budget budget{.bytes = uint64_t{1} << 28, .folder = std::filesystem::temp_directory_path()};
  const auto read = [&](const std::string& name) { return survey(*folder / name, budget); };
  for (const auto& [name, parts, volume] : std::vector<std::tuple<std::string, size_t, double>>{{"box", 1, 6000},
                                                                                                {"sphere", 1, 4172.803},
                                                                                                {"torus", 1, 776.831},
                                                                                                {"multiple_cylinders", 6, 6198.09},
                                                                                                {"cube_gears", 17, 24'815.075},
                                                                                                {"box_prod", 1, 6000}}) {
    CAPTURE(name);
    const FileSurvey found = read("3mf/" + name + ".3mf");
    CHECK(found.places.size() == parts);
    CHECK(found.file.unit == "mm");
    CHECK(found.kinds[0].closed);
    CHECK(found.kinds[0].volume == Approx(volume).epsilon(1e-6));
  }
  const auto refused = [&](const std::string& name, const std::string& why) { CHECK_THROWS_WITH(read(name), Catch::Contains(why)); };
  refused("3mf/cube_gears_prod_req.3mf", "without an extension of 3MF, 'p'");
  refused("3mf-must-fail/2.1.1a_PartsRelationships_NonExist3DModelPart.3mf", "expected one relationship to a 3D model, found none");
  refused("3mf-must-fail/2.1.2_PartsRelationships_MoreThanOne3DModelPart.3mf", "expected one relationship to a 3D model, found");
  refused("3mf-must-fail/2.3.2a_NonUTF_Encoding.3mf", "not well-formed XML");
  refused("3mf-must-fail/2.3.2b_DataTypeDefinitionInXMLMarkup.3mf", "expected no document type definition");
  refused("3mf-must-fail/3.4.3.1a_NotMatchingObjectIdInBuildItem.3mf", "expected the id of an object, found 14");
}

}  // namespace
}  // namespace teracell::mesher
