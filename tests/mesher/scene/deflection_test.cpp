// How fine the facets of exact surfaces are to be: the scene's keys, and the words of the command line.
#include "mesher/scene/scene.hpp"

#include "store/base/error.hpp"
#include "tests/support/test.hpp"

namespace teracell::mesher {
namespace {

Scene scene_with(const std::string& keys) {
  return parse_scene(R"({"materials": {"steel": {}}, "bodies": [{"mesh": "a.step", "material": "steel", )" + keys + "}]}", "models");
}
SceneBody body_with(const std::string& keys) { return scene_with(keys).bodies[0]; }

std::string refusal_of(const std::string& keys) {
  try {
    scene_with(keys);
  } catch (const UsageError& e) {
    return e.what();
  }
  return "no error";
}

TEST_CASE("deflection is a length as a number, and a number of cells as text; a tenth of a cell and 12 degrees where it is not given", "[scene]") {
  CHECK(body_with(R"("priority": 0)").deflection == Deflection{0.1, true});
  CHECK(body_with(R"("priority": 0)").angle == 12);
  CHECK_FALSE(body_with(R"("priority": 0)").face_patches);
  CHECK(body_with(R"("deflection": 0.05)").deflection == Deflection{0.05, false});
  CHECK(body_with(R"("deflection": 2)").deflection == Deflection{2, false});
  CHECK(body_with(R"("deflection": "0.25c")").deflection == Deflection{0.25, true});
  CHECK(body_with(R"("deflection": "1e-3c")").deflection == Deflection{0.001, true});
  CHECK(body_with(R"("angle": 5.5)").angle == 5.5);
  CHECK(body_with(R"("angle": 90)").angle == 90);
  CHECK(body_with(R"("face_patches": true)").face_patches);
}

TEST_CASE("a wrong deflection, angle or face_patches says where, expected, found", "[scene]") {
  using Catch::Contains;
  for (const char* value : {R"("c")", R"("0.1")", R"("0.1 c")", R"("0.1cells")", R"("-1c")", R"("0c")", R"("nanc")", R"("infc")", R"("1e99c")"}) {
    INFO(value);
    CHECK_THAT(refusal_of(std::string(R"("deflection": )") + value), Contains("bodies[0].deflection") && Contains("0.1c"));
  }
  for (const char* value : {"0", "-1", "1e76", "true", "[1]", "null", R"("")"}) {
    INFO(value);
    CHECK_THAT(refusal_of(std::string(R"("deflection": )") + value), Contains("bodies[0].deflection"));
  }
  for (const char* value : {"0", "0.09", "90.5", "-5", R"("12")"}) {
    INFO(value);
    CHECK_THAT(refusal_of(std::string(R"("angle": )") + value), Contains("bodies[0].angle"));
  }
  CHECK_THAT(refusal_of(R"("face_patches": 1)"), Contains("bodies[0].face_patches"));
  CHECK_THAT(refusal_of(R"("deflecton": 1)"), Contains("\"deflecton\"") && Contains("\"deflection\""));
}

TEST_CASE("the normal form has deflection, angle and face_patches where they are not the default, and reads back equal", "[scene]") {
  const std::string plain = normalised(scene_with(R"("priority": 0)"));
  for (const char* defaults : {R"("deflection": "0.1c")", R"("angle": 12)", R"("face_patches": false)"})
    CHECK(normalised(scene_with(defaults)) == plain);
  for (const char* keys : {R"("deflection": 0.1)", R"("deflection": "0.30000000000000004c")", R"("deflection": 1e-7, "angle": 0.1)",
                           R"("deflection": "1e-05c", "angle": 33.3, "face_patches": true)", R"("deflection": 123456789012345678)"}) {
    const Scene scene = scene_with(keys);
    const std::string text = normalised(scene);
    INFO(text);
    CHECK(text != plain);
    CHECK(parse_scene(text, "models").bodies[0].deflection == scene.bodies[0].deflection);
    CHECK(parse_scene(text, "models") == scene);
    CHECK(normalised(parse_scene(text, "models")) == text);
  }
}

TEST_CASE("a sheet has a deflection, too", "[scene]") {
  CHECK(body_with(R"("kind": "sheet", "deflection": 0.5, "angle": 3)").deflection == Deflection{0.5, false});
}

TEST_CASE("the words of --deflection: a length, or cells", "[scene]") {
  CHECK(parse_deflection("0.05") == Deflection{0.05, false});
  CHECK(parse_deflection("0.05c") == Deflection{0.05, true});
  CHECK(parse_deflection("1e75") == Deflection{1e75, false});
  for (const char* text : {"", "c", "0", "-1", "0c", "+1", " 1", "1 ", "1mm", "1cc", "1C", "nan", "inf", "1e76", "0x1", "1,5", "1e-400"}) {
    INFO(text);
    CHECK_FALSE(parse_deflection(text));
  }
}

}  // namespace
}  // namespace teracell::mesher
