#include "mesher/scene/scene.hpp"

#include "store/base/error.hpp"
#include "store/text/text.hpp"
#include "tests/support/meshed.hpp"

using namespace teracell;
using namespace teracell::mesher;

namespace {

namespace fs = std::filesystem;

// A scene with one steel body; `grid` and `body` are further text for their places.
std::string scene_text(const std::string& grid = "", const std::string& body = "") {
  return R"({"grid": {)" + grid + R"(}, "materials": {"steel": {"color": "#8899aa"}}, "bodies": [{"mesh": "hull.stl", "material": "steel")" +
         (body.empty() ? "" : ", " + body) + "}]}";
}
Scene parse(const std::string& text) { return parse_scene(text, "models"); }

std::string usage_error(const std::string& text) {
  try {
    parse(text);
  } catch (const UsageError& e) {
    return e.what();
  }
  return "no error";
}

void check_error(const std::string& text, std::initializer_list<const char*> words) {
  const std::string message = usage_error(text);
  for (const char* word : words) {
    INFO(text << "\n" << message);
    CHECK(message.find(word) != std::string::npos);
  }
}

Matrix matrix_of(const std::string& placement) { return parse(scene_text("", placement)).bodies[0].matrix; }

Grid resolve(const std::string& grid, const GridOptions& options, const Vec3& lo, const Vec3& hi) {
  Scene scene = parse(scene_text(grid));
  override_grid(scene, options);
  return resolve_grid(scene, lo, hi);
}

struct SceneFolder : testing::TempFolder {
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(*this / name, std::ios::binary) << text;
    return *this / name;
  }
};

}  // namespace

TEST_CASE("the specified example is read with all its keys", "[scene]") {
  const Scene s = parse(R"({"units": "mm",
   "grid": {"min": [0,0,0], "max": [120,80,40], "cells": [1200,800,400]},
   "background": "air",
   "materials": {"air": {"color": "#00000000"}, "steel": {"color": "#8899AA"}},
   "bodies": [{"name": "hull", "mesh": "hull.stl", "part": "deck*", "material": "steel", "priority": -3, "fill": "evenodd", "closing": "strict",
               "scale": 1.0, "rotate": {"axis": [0,0,1], "degrees": 0}, "translate": [0,0,0]}]})");
  CHECK(s.units == "mm");
  CHECK(s.axis[1] == SceneAxis{0.0, 80.0, std::nullopt, 800, {}});
  CHECK(s.materials == std::vector<SceneMaterial>{{"air", "#00000000"}, {"steel", "#8899aa"}});
  REQUIRE(s.bodies.size() == 1);
  CHECK(s.bodies[0] ==
        SceneBody{"hull", "models/hull.stl", "hull.stl", "deck*", 1, -3, Fill::kEvenodd, {Closing::Way::kStrict}, {}, {}, {}, kIdentity});
  const Grid g = resolve_grid(s, {}, {});
  CHECK(g.cells() == Index3{1200, 800, 400});
  CHECK(g.axis[0].step() == 120.0 / 1200);
}

TEST_CASE("what a scene leaves out has the specified default", "[scene]") {
  const Scene s = parse(scene_text());
  CHECK(s.units == "m");
  CHECK(s.sample == Vec3{0.5, 0.5, 0.5});
  CHECK(s.pad == 1);
  CHECK(s.label_by == LabelBy::kMaterial);
  CHECK(s.materials[0] == SceneMaterial{"air", "#00000000"});
  CHECK(s.bodies[0] == SceneBody{"hull", "models/hull.stl", "hull.stl", "", 1, 0, Fill::kAuto, {}, {}, {}, {}, kIdentity});
}

TEST_CASE("materials are numbered in the scene's order, the background is 0", "[scene]") {
  const Scene s = parse(R"({"background": "sea", "materials": {"zinc": {}, "sea": {"color": "#0000ff"}, "alu": {}},
    "bodies": [{"mesh": "a", "material": "alu"}, {"mesh": "b", "material": "zinc"}, {"mesh": "c", "material": "sea"}]})");
  REQUIRE(s.materials.size() == 3);
  CHECK(s.materials[0] == SceneMaterial{"sea", "#0000ff"});
  CHECK(s.materials[1].name == "zinc");
  CHECK(s.materials[2].name == "alu");
  CHECK(s.materials[1].color != s.materials[2].color);
  CHECK(s.bodies[0].material == 2);
  CHECK(s.bodies[1].material == 1);
  CHECK(s.bodies[2].material == 0);
}

TEST_CASE("an unknown key is named with its place and the nearest known one", "[scene]") {
  check_error(R"({"bodys": []})", {"the scene", "\"bodys\"", "\"bodies\""});
  check_error(scene_text("", R"("transalte": [0,0,0])"), {"bodies[0]", "\"transalte\"", "\"translate\""});
  check_error(scene_text(R"("cell": [1,1,1])"), {"grid", "\"cell\"", "\"cells\""});
  check_error(scene_text(R"("x": {"plane": [0,1]})"), {"grid.x", "\"plane\"", "\"planes\""});
  check_error(scene_text("", R"("rotate": {"axis": [0,0,1], "degree": 3})"), {"bodies[0].rotate", "\"degrees\""});
  check_error(R"({"materials": {"odd name": {"colour": ""}}, "bodies": []})", {"materials[\"odd name\"]", "\"colour\"", "\"color\""});
}

TEST_CASE("a wrong value says where, expected, found", "[scene]") {
  check_error("[]", {"the scene", "an object", "an array of 0"});
  check_error("{}", {"\"bodies\" is missing"});
  check_error(R"({"bodies": {}})", {"bodies", "an array", "an object"});
  check_error(R"({"bodies": [{"mesh": "a.stl"}]})", {"bodies[0]", "\"material\" is missing"});
  check_error(R"({"bodies": [{"mesh": "", "material": "air"}]})", {"bodies[0].mesh", "not empty"});
  check_error(R"({"bodies": [{"mesh": "a\u0000b", "material": "air"}]})", {"bodies[0].mesh", "control characters", "a\\u0000b"});
  check_error(R"({"units": "km", "bodies": []})", {"units", "mm", "\"km\""});
  check_error(R"({"units": 3, "bodies": []})", {"units", "one of m, cm", "found 3"});
  check_error(R"({"sample": [0, 1, 0], "bodies": []})", {"sample[1]", "below 1", "found 1"});
  check_error(R"({"label_by": "bodies", "bodies": []})", {"label_by", "\"body\"?"});
  check_error(R"({"materials": {"a": {"color": "#12345"}}, "bodies": []})", {"materials.a.color", "#rrggbb", "#12345"});
  check_error(R"({"materials": {"a": "red"}, "bodies": []})", {"materials.a", "an object", "\"red\""});
  check_error(R"({"materials": {"": {}}, "bodies": []})", {"materials", "not empty"});
  check_error(scene_text(R"("min": [0,0,0], "max": [1,1], "cells": [1,1,1])"), {"grid.max", "an array of 3", "an array of 2"});
  check_error(scene_text(R"("cells": [1,0,1])"), {"grid.cells[1]", "an integer from 1", "found 0"});
  check_error(scene_text(R"("cells": [1,1.5,1])"), {"grid.cells[1]", "an integer", "found 1.5"});
  check_error(scene_text(R"("cells": 3000000000)"), {"grid.cells", "found 3000000000"});
  check_error(scene_text(R"("step": -1)"), {"grid.step", "above 0"});
  check_error(scene_text(R"("pad": -1)"), {"grid.pad", "an integer from 0"});
  check_error(scene_text("", R"("fill": "even-odd")"), {"bodies[0].fill", "nonzero", "\"evenodd\"?"});
  check_error(scene_text("", R"("priority": 9223372036854775808)"), {"bodies[0].priority", "an integer"});
  check_error(scene_text("", R"("scale": [1,0,1])"), {"bodies[0].scale", "not 0"});
  check_error(scene_text("", R"("rotate": {"axis": [0,0,0], "degrees": 3})"), {"bodies[0].rotate.axis", "not zero"});
}

TEST_CASE("a material that is not in the scene is an error naming the nearest", "[scene]") {
  check_error(R"({"materials": {"steel": {}, "water": {}}, "bodies": [{"mesh": "a", "material": "steal"}]})",
              {"bodies[0].material", "\"steel\"", "\"steal\""});
  check_error(R"({"background": "watre", "materials": {"steel": {}, "water": {}}, "bodies": []})", {"background", "\"water\"", "\"watre\""});
}

TEST_CASE("cells with step, min without max, and a matrix with scale exclude each other", "[scene]") {
  check_error(scene_text(R"("cells": [1,1,1], "step": 1)"), {"grid", "cells and step exclude"});
  check_error(scene_text(R"("y": {"cells": 1, "step": 1})"), {"grid.y", "cells and step exclude"});
  check_error(scene_text(R"("min": [0,0,0])"), {"grid (axis x)", "only min"});
  check_error(scene_text(R"("z": {"max": 1})"), {"grid.z", "only max"});
  check_error(scene_text(R"("min": [0,0,1], "max": [1,1,1])"), {"grid (axis z)", "min < max"});
  check_error(scene_text(R"("x": {"planes": [0, 1], "cells": 1})"), {"grid.x", "planes", "take away \"cells\""});
  check_error(scene_text(R"("z": {"planes": [0, 1], "min": 0, "max": 1})"), {"grid.z", "\"planes\"", "take away \"min\", \"max\""});
  check_error(scene_text("", R"("matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0], "scale": 1)"), {"bodies[0]", "matrix excludes"});
}

TEST_CASE("a sheet takes no key that is for solids only", "[scene]") {
  for (const char* key : {R"("fill": "nonzero")", R"("closing": "strict")", R"("stitch": 0)", R"("thin": "keep")"}) {
    CHECK_NOTHROW(parse(scene_text("", key)));
    check_error(scene_text("", std::string(R"("kind": "sheet", )") + key), {"bodies[0]", "fill, closing, stitch and thin are for solids only"});
  }
}

TEST_CASE("a syntax error has its line and column", "[scene]") {
  check_error("{\"bodies\": [],\n \"units\": }", {"line 2, column 11"});
  check_error("", {"line 1, column 1"});
  check_error("{\"bodies\": [1e999]}", {"line 1", "1e999"});
  check_error("{\"bodies\": []} x", {"line 1"});
  check_error("{\"units\": \"\xff\"}", {"line 1", "UTF-8"});
  check_error("[{\"a\": 1}]", {"expected an object", "an array of 1"});
}

TEST_CASE("a key given twice is refused", "[scene]") {
  check_error(R"({"bodies": [], "bodies": []})", {"bodies", "twice"});
  check_error(R"({"bodies": [{"mesh": "a"}, {"mesh": "a", "rotate": {"axis": [0,0,1], "axis": 1}}]})", {"bodies[1].rotate.axis", "twice"});
  check_error(R"({"materials": {"a": {}, "b": {}, "a": {}}, "bodies": []})", {"materials.a", "twice"});
}

TEST_CASE("65,535 materials besides the background, not one more", "[scene]") {
  std::string list;
  for (int i = 0; i < 65535; ++i) list += fmt::format("\"m{}\": {{}}, ", i);
  CHECK(parse("{\"materials\": {" + list + "\"air\": {}}, \"bodies\": []}").materials.size() == 65536);
  check_error("{\"materials\": {" + list + "\"air\": {}, \"last\": {}}, \"bodies\": []}", {"at most 65535"});
}

TEST_CASE("names of materials and bodies have at most 256 bytes, those that come from files too", "[scene]") {
  const std::string longest(256, 'n');
  const auto scene = [](const std::string& material, const std::string& body) {
    return "{\"materials\": {\"" + material + "\": {}}, \"bodies\": [{\"mesh\": \"a.stl\", \"name\": \"" + body + "\", \"material\": \"" + material +
           "\"}]}";
  };
  CHECK(parse(scene(longest, longest)).bodies[0].name == longest);
  check_error(scene(longest + "n", "a"), {"materials", "at most 256 bytes", "of 257"});
  check_error(scene("a", longest + "n"), {"bodies[0].name", "at most 256 bytes"});
  std::string umlauts;
  for (int i = 0; i < 200; ++i) umlauts += "\xc3\xbc";
  const Scene bare = bare_scene({"x" + umlauts + ".stl", "y/x" + umlauts + ".stl"});
  CHECK(bare.bodies[0].name == "x" + umlauts.substr(0, 238));  // whole characters
  CHECK(bare.bodies[1].name == bare.bodies[0].name + "-2");
}

TEST_CASE("bodies without a name are named after their mesh and numbered", "[scene]") {
  const Scene s = parse(R"({"bodies": [{"mesh": "a/hull.stl", "material": "air"}, {"mesh": "b/hull.stl.gz", "material": "air"},
    {"mesh": "x.ply", "name": "hull-2", "material": "air"}, {"mesh": "hull.obj", "material": "air"}]})");
  CHECK(s.bodies[0].name == "hull");
  CHECK(s.bodies[1].name == "hull-3");
  CHECK(s.bodies[2].name == "hull-2");
  CHECK(s.bodies[3].name == "hull-4");
}

TEST_CASE("names that a terminal would obey are refused, in messages they are harmless", "[scene]") {
  check_error(scene_text("", R"("name": "a\u001b[2J")"), {"bodies[0].name", "control characters", "a\\u001b[2J"});
  CHECK(parse(scene_text("", "\"part\": \"a\x7f\"")).bodies[0].part == "a\x7f");  // names of files have them
  check_error("{\"units\": \"\xc2\x9b\"}", {"units", "\"?\""});
  check_error(R"({"materials": {"st\u0007": {}}, "bodies": []})", {"materials[\"st\\u0007\"]", "control characters"});
  check_error("{\"bodies\": [], \"a\xc2\x85\": 1}", {"unknown key \"a?\""});
  CHECK(parse(scene_text("", "\"name\": \"\xc3\x85 \xe2\x82\xac\"")).bodies[0].name == "\xc3\x85 \xe2\x82\xac");
  CHECK(printable("a\x1b[0m\r\n\x7f \xc2\x9b \xc2\xa0 \xff") == "a?[0m??? ? \xc2\xa0 \xef\xbf\xbd");
  CHECK(bare_scene({"a\x1b.stl"}).bodies[0].name == "a?");
}

TEST_CASE("two bodies of one name are refused with both places", "[scene]") {
  check_error(R"({"bodies": [{"mesh": "a", "name": "x", "material": "air"}, {"mesh": "x", "material": "air"},
    {"mesh": "b", "name": "x", "material": "air"}]})",
              {"bodies[2].name", "\"x\"", "bodies[0]"});
}

TEST_CASE("bare meshes are one body and one material a file", "[scene]") {
  const Scene s = bare_scene({"a/hull.stl", "hull.ply", "air.stl", "b\xff.stl"});
  REQUIRE(s.materials.size() == 5);
  CHECK(s.materials[0].name == "air");
  CHECK(s.materials[1].name == "hull");
  CHECK(s.materials[2].name == "hull-2");
  CHECK(s.materials[3].name == "air-2");
  CHECK(s.materials[4].name == "b\xef\xbf\xbd");
  for (size_t i = 0; i < 4; ++i) {
    CHECK(s.bodies[i].material == i + 1);
    CHECK(s.bodies[i].name == s.materials[i + 1].name);
  }
  CHECK(s.bodies[0].mesh == "a/hull.stl");
  CHECK(s.bodies[3].mesh == "b\xff.stl");
  CHECK_NOTHROW(normalised(s));
}

TEST_CASE("quarter turns about a grid axis are exact", "[scene]") {
  CHECK(matrix_of(R"("rotate": {"axis": [0,0,3], "degrees": 90})") == Matrix{0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0});
  CHECK(matrix_of(R"("rotate": {"axis": [0,0,-0.1], "degrees": -90})") == Matrix{0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0});
  CHECK(matrix_of(R"("rotate": {"axis": [1e300,0,0], "degrees": 270})") == Matrix{1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0});
  CHECK(matrix_of(R"("rotate": {"axis": [0,1,0], "degrees": 540})") == Matrix{-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0});
  CHECK(matrix_of(R"("rotate": {"axis": [1,2,3], "degrees": 720})") == kIdentity);
  for (const double entry : matrix_of(R"("rotate": {"axis": [0,0,-1], "degrees": 180}, "scale": -2)"))
    CHECK_FALSE((entry == 0 && std::signbit(entry)));
}

TEST_CASE("a rotation agrees with sine and cosine and is orthogonal", "[scene]") {
  for (double degrees = -720; degrees <= 720; degrees += 7.3) {
    const Matrix m = rotation({0, 0, 1}, degrees);
    const double a = degrees * 3.14159265358979323846 / 180;
    CHECK(std::abs(m[0] - std::cos(a)) < 4e-15);
    CHECK(std::abs(m[4] - std::sin(a)) < 4e-15);
    CHECK(m[10] == 1);
    const Matrix r = rotation({1, -2, 0.5}, degrees);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) CHECK(std::abs(r[i] * r[j] + r[4 + i] * r[4 + j] + r[8 + i] * r[8 + j] - (i == j)) < 1e-15);
  }
  // 120 degrees about the diagonal: x -> y -> z -> x.
  const Vec3 y = transform(rotation({1, 1, 1}, 120), {1, 0, 0});
  CHECK(std::abs(y[0]) + std::abs(y[1] - 1) + std::abs(y[2]) < 1e-15);
}

TEST_CASE("scale comes first, then rotate, then translate", "[scene]") {
  const Matrix m = matrix_of(R"("translate": [10, 20, 30], "rotate": {"axis": [0,0,1], "degrees": 90}, "scale": [2, 3, -4])");
  CHECK(transform(m, {1, 1, 1}) == Vec3{7, 22, 26});
  CHECK(matrix_of(R"("matrix": [1,2,3,4, 0,1,5,6, 0,0,1,7])") == Matrix{1, 2, 3, 4, 0, 1, 5, 6, 0, 0, 1, 7});
}

TEST_CASE("a singular matrix is refused, a mirror and a needle are not", "[scene]") {
  check_error(scene_text("", R"("matrix": [1,2,3,0, 4,5,6,0, 7,8,9,0])"), {"bodies[0].matrix", "singular"});
  check_error(scene_text("", R"("matrix": [1,0,0,0, 0,0,0,0, 0,0,1,0])"), {"bodies[0].matrix", "singular"});
  CHECK(matrix_of(R"("scale": [-1, 1e-20, 1e20])")[0] == -1);
}

TEST_CASE("an axis entry overrides that axis", "[scene]") {
  const Scene s =
      parse(scene_text(R"("min": [0,0,0], "max": [10,10,10], "cells": [10,10,10], "x": {"step": 2}, "y": {"planes": [0, 1, 3]}, "z": {"max": 20})"));
  CHECK(s.axis[0] == SceneAxis{0.0, 10.0, 2.0, std::nullopt, {}});
  CHECK(s.axis[1] == SceneAxis{std::nullopt, std::nullopt, std::nullopt, std::nullopt, {0, 1, 3}});
  CHECK(s.axis[2] == SceneAxis{0.0, 20.0, std::nullopt, 10, {}});
  CHECK(resolve_grid(s, {}, {}).cells() == Index3{5, 2, 10});
}

TEST_CASE("planes come from a file beside the scene", "[scene]") {
  const SceneFolder folder;
  folder.write("x.txt", "# planes\n0, 0.1\t+0.3,\r\n1e0 # the last one");
  const fs::path scene = folder.write("scene.json", scene_text(R"("step": 1, "x": {"planes_file": "x.txt"})"));
  CHECK(read_scene(scene).axis[0].planes == std::vector<double>{0, 0.1, 0.3, 1});

  const auto message_of = [&] {
    try {
      read_scene(scene);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string("no error");
  };
  for (const char* bad : {"0\n1\nnan", "0\n1\n1e999", "0\n1\n--2", "0\n1\n+-2", "0\n1\n2;3", "0\n1\n0x2"}) {
    folder.write("x.txt", bad);
    CHECK_THROWS_AS(read_scene(scene), InputError);
    CHECK(message_of().find("x.txt:3: expected a number") != std::string::npos);
  }
  folder.write("x.txt", "0 1 1");
  CHECK(message_of().find("ascend strictly") != std::string::npos);
  folder.write("x.txt", "7");
  CHECK(message_of().find("at least 2 planes") != std::string::npos);
  fs::remove(folder / "x.txt");
  CHECK_THROWS_AS(read_scene(scene), IoError);
  fs::create_symlink("/dev/zero", folder / "x.txt");
  CHECK(message_of().find("x.txt: expected at most 64000000 bytes") != std::string::npos);
}

TEST_CASE("reading a scene that is not there, is a folder, or is wrong names the file", "[scene]") {
  const SceneFolder folder;
  CHECK_THROWS_AS(read_scene(folder / "none.json"), IoError);
  CHECK_THROWS_AS(read_scene(folder.path()), IoError);
  const fs::path scene = folder.write("scene.json", "{\n}}");
  CHECK_THROWS_WITH(read_scene(scene), Catch::Contains("scene.json: line 2"));
}

TEST_CASE("--cells N gives cubic cells, N on the longest axis with its pad", "[scene][grid]") {
  const Grid g = resolve("", {102}, {0, 0, 0}, {10, 4.95, 0});
  CHECK(g.cells() == Index3{102, 52, 3});  // ceil(49.5) + 2; a flat sheet has one layer and its pad
  for (int a = 0; a < 3; ++a) {
    CHECK(g.axis[a].step() == 10.0 / 100);
    CHECK(g.axis[a].origin() == 0 - 10.0 / 100);
    CHECK(g.axis[a].first() == 0);
  }
  // Axes exactly as long all get N, also where dividing back by the step would round above it.
  for (int n = 3; n < 400; ++n) CHECK(resolve("", {n}, {0, 0, 0}, {0.7, 0.7, 0.7}).cells() == Index3{n, n, n});
  CHECK(resolve("", {10, {}, {}, 0}, {1, 1, 1}, {2, 2, 2}).axis[0].origin() == 1);
  CHECK(resolve(R"("cells": 102)", {}, {0, 0, 0}, {10, 4.95, 0}) == g);
  CHECK_THROWS_WITH(resolve("", {2}, {0, 0, 0}, {1, 1, 1}), Catch::Contains("at least 3"));
  CHECK_THROWS_WITH(resolve("", {9}, {1, 1, 1}, {1, 1, 1}), Catch::Contains("no extent"));
}

TEST_CASE("--cells N within the scene's min and max counts no pad", "[scene][grid]") {
  const Grid g = resolve(R"("min": [0,0,0], "max": [3,1.5,0.25], "cells": [7,7,7])", {30}, {}, {});
  CHECK(g.cells() == Index3{30, 15, 3});
  CHECK(g.axis[2].step() == 0.1);
  CHECK(g.axis[0].origin() == 0);
}

TEST_CASE("--cells NX,NY,NZ divides the box between the pads", "[scene][grid]") {
  const Grid g = resolve("", {{}, {{12, 7, 5}}}, {0, 0, 0}, {10, 10, 9});
  CHECK(g.cells() == Index3{12, 7, 5});
  CHECK(g.axis[0].step() == 1);
  CHECK(g.axis[1].step() == 2);
  CHECK(g.axis[2].step() == 3);
  CHECK(g.axis[1].origin() == -2);
  CHECK(resolve(R"("min": [0,0,0], "max": [3,1.5,0.25], "step": 1)", {{}, {{3, 3, 1}}}, {}, {}).axis[1].step() == 0.5);
  CHECK_THROWS_WITH(resolve("", {{}, {{12, 12, 12}}}, {0, 0, 0}, {1, 0, 1}), Catch::Contains("axis y") && Catch::Contains("no extent"));
  CHECK_THROWS_WITH(resolve("", {{}, {{12, 2, 12}}}, {0, 0, 0}, {1, 1, 1}), Catch::Contains("axis y"));
}

TEST_CASE("--step H covers the box and its pad", "[scene][grid]") {
  const Grid g = resolve("", {{}, {}, 0.1, 2}, {0, 0, 0}, {1, 0.95, 0});
  CHECK(g.cells() == Index3{14, 14, 5});  // 1 / 0.1 is 10 in spite of rounding
  CHECK(g.axis[0].origin() == 0 - 2.0 * 0.1);
  CHECK(resolve(R"("min": [0,0,0], "max": [0.3,1,2.05])", {{}, {}, 0.1}, {}, {}).cells() == Index3{3, 10, 21});
  CHECK(resolve(R"("step": 0.5)", {}, {0, 0, 0}, {1, 2, 3}).cells() == Index3{4, 6, 8});
  CHECK(resolve(R"("step": [0.5, 1, 1])", {}, {0, 0, 0}, {1, 2, 3}).cells() == Index3{4, 4, 5});
  CHECK_THROWS_WITH(resolve("", {{}, {}, 1e-12}, {0, 0, 0}, {1, 1, 1}), Catch::Contains("at most 2147483646"));
}

TEST_CASE("graded axes keep their planes whatever the command line gives", "[scene][grid]") {
  const std::string graded = R"("x": {"planes": [0, 1, 4]}, "step": 1)";
  CHECK(resolve(graded, {12}, {0, 0, 0}, {1, 5, 10}).cells() == Index3{2, 7, 12});
  CHECK(resolve(graded, {{}, {{2, 7, 12}}}, {0, 0, 0}, {1, 5, 10}).axis[0].is_graded());
  CHECK_THROWS_WITH(resolve(graded, {{}, {{3, 7, 12}}}, {0, 0, 0}, {1, 5, 10}), Catch::Contains("axis x has 2 cells"));
  const std::string all = R"("x": {"planes": [0, 1]}, "y": {"planes": [0, 1]}, "z": {"planes": [0, 1]})";
  CHECK(resolve(all, {}, {}, {}).cells() == Index3{1, 1, 1});
  CHECK_THROWS_AS(resolve(all, {12}, {}, {}), UsageError);
}

TEST_CASE("options that contradict, are out of range, or are missing are usage errors", "[scene][grid]") {
  CHECK_THROWS_AS(resolve("", {12, {}, 0.5}, {0, 0, 0}, {1, 1, 1}), UsageError);
  CHECK_THROWS_AS(resolve("", {0}, {0, 0, 0}, {1, 1, 1}), UsageError);
  CHECK_THROWS_AS(resolve("", {{}, {{1, 1, -1}}}, {0, 0, 0}, {1, 1, 1}), UsageError);
  CHECK_THROWS_AS(resolve("", {{}, {}, NAN}, {0, 0, 0}, {1, 1, 1}), UsageError);
  CHECK_THROWS_AS(resolve("", {{}, {}, 1.0, -1}, {0, 0, 0}, {1, 1, 1}), UsageError);
  const std::string fixed = R"("min": [0,0,0], "max": [1,1,1], "cells": 4, "x": {"planes": [0, 1]})";
  CHECK_THROWS_WITH(resolve(fixed, {{}, {}, {}, 2}, {}, {}), Catch::StartsWith("pad:"));
  CHECK(resolve(R"("cells": 9, "x": {"min": 0, "max": 9})", {{}, {}, {}, 2}, {0, 0, 0}, {5, 5, 5}).cells() == Index3{9, 9, 9});
  CHECK_THROWS_WITH(resolve("", {}, {0, 0, 0}, {1, 1, 1}), Catch::Contains("neither a number of cells nor a step"));
  CHECK_THROWS_AS(resolve("", {12}, {INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}), InputError);
}

TEST_CASE("sample points reach the axes", "[scene][grid]") {
  Scene s = parse(R"({"sample": [0, 0.25, 0.5], "grid": {"min": [0,0,0], "max": [4,4,4], "cells": [4,4,4]}, "bodies": []})");
  const Grid g = resolve_grid(s, {}, {});
  CHECK(g.axis[0].centre(0) == 0);
  CHECK(g.axis[1].centre(1) == 1.25);
  CHECK(g.axis[2].centre(3) == 3.5);
}

TEST_CASE("the normalised scene reads back equal and is its own normal form", "[scene]") {
  const char* grids[] = {"",
                         R"("cells": 100, "pad": 3)",
                         R"("step": 0.1)",
                         R"("min": [0.1,-1e-7,0], "max": [120,80,40], "cells": [1200,800,400])",
                         R"("cells": 100, "x": {"cells": 3}, "y": {"min": 0, "max": 7})",
                         R"("step": [1,2,3], "x": {"cells": 3}, "z": {"planes": [0, 0.1, 0.30000000000000004]})",
                         R"("cells": 9, "x": {"step": 1}, "y": {"step": 1}, "z": {"planes": [1, 2]})"};
  for (const char* grid : grids) {
    const Scene s = parse(scene_text(grid, R"("part": "a*", "priority": 9223372036854775807, "fill": "nonzero", "closing": "strict",
                                              "scale": 0.1, "rotate": {"axis": [1,2,3], "degrees": 33.3}, "translate": [0.1,0,1e-9])"));
    const std::string text = normalised(s);
    INFO(text);
    CHECK(parse(text) == s);
    CHECK(normalised(parse(text)) == text);
  }
  const Scene bare = bare_scene({"a.stl", "b.stl"});
  CHECK(parse_scene(normalised(bare), "") == bare);
  CHECK(normalised(parse(scene_text(R"("min": [0,0,0], "max": [1,2,3], "step": 0.5)"))) ==
        R"({"units":"m","grid":{"min":[0.0,0.0,0.0],"max":[1.0,2.0,3.0],"step":[0.5,0.5,0.5],"pad":1},"sample":[0.5,0.5,0.5],)"
        R"("background":"air","materials":{"air":{"color":"#00000000"},"steel":{"color":"#8899aa"}},"label_by":"material",)"
        R"("bodies":[{"name":"hull","mesh":"hull.stl","material":"steel","priority":0,"fill":"auto","closing":"cap",)"
        R"("matrix":[1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0,0.0]}]})");
}

TEST_CASE("A report shows no folder of the machine: what the scene names, what lies below it, or a file's name") {
  const std::string here = fs::current_path().string();
  CHECK(mesh_shown("../shared/hull.stl", "models") == "../shared/hull.stl");
  CHECK(mesh_shown("/home/me/models/parts/hull.stl", "/home/me/models") == "parts/hull.stl");
  CHECK(mesh_shown("/home/me/models/x/../parts/hull.stl", "/home/me/models/") == "parts/hull.stl");
  CHECK(mesh_shown("/home/me/hull.stl", "/home/me/models") == "hull.stl");
  CHECK(mesh_shown("/home/me/", "/home/me/models") == ".");  // a folder: no name is empty
  CHECK(mesh_shown(here + "/models/hull.stl", "models") == "hull.stl");
  CHECK(mesh_shown(here + "/hull.stl", "") == "hull.stl");
  const Scene scene =
      parse_scene(R"({"materials": {"a": {}}, "bodies": [{"mesh": "/home/me/models/parts/hull.stl", "material": "a"}]})", "/home/me/models");
  CHECK(scene.bodies[0].mesh == "/home/me/models/parts/hull.stl");
  CHECK(normalised(scene).find("/home") == std::string::npos);
  const Scene bare = bare_scene({"/home/me/a.stl", "b/c.stl", here + "/models/hull.stl"});
  CHECK(bare.bodies[0].mesh == "/home/me/a.stl");
  CHECK(bare.bodies[0].mesh_text == "a.stl");
  CHECK(bare.bodies[1].mesh_text == "b/c.stl");
  CHECK(bare.bodies[2].mesh_text == "hull.stl");
}
