// OBJ.
#include "store/base/background.hpp"
#include "tests/support/surfaces.hpp"

using namespace teracell;
using namespace teracell::mesher;
using namespace teracell::surfaces;
using Catch::Contains;

TEST_CASE("OBJ: every way to name a vertex") {
  const std::string vertices = "v 0 0 0 1.0\nv 1 0 0 0.1 0.2 0.3\nvt 0 0\nvn 0 0 1\nv 0 1 0\nv 0 0 0.5\n";
  CHECK(read(vertices + "f 1 3 2\nf 1/1 2/1 4/1\nf 1//1 4//1 3//1\nf -3/-1/-1 -2/1/1 -1/1/1 # the last\n").facets == tetrahedron());
  CHECK(read(vertices + "f 1 3 2\nf 1/1  2/1\t4/1 \nf 1//1 4//1 3//1\r\nf -3 -2 -1").facets == tetrahedron());
  CHECK(read(vertices + "f 1 3 2\nf 1 2 4\ng a\nf 1 4 3 # the third\nf 2 3 4\n").facets == tetrahedron());
  CHECK(read(vertices + "f 1 \\\n3 2\nf 1 2\\\r\n4\n# in C:\\\nf 1 4 3\nf 2 3 \\\n \\\n4").facets == tetrahedron());
}

TEST_CASE("OBJ: polygons are fans from their first vertex") {
  const Result r = read("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0.5 0\nf 2 3 4 5 1\n");
  const Vec3 a{1, 0, 0}, b{1, 1, 0}, c{0, 1, 0}, d{0, 0.5, 0}, e{0, 0, 0};
  CHECK(r.facets == Facets{{a, b, c}, {a, c, d}, {a, d, e}});

  std::string large = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf";  // a line longer than the window
  for (int i = 0; i < 300'000; ++i) large += " " + std::to_string(i % 3 + 1);
  CHECK(read(large).facets.size() == 299'998);
}

TEST_CASE("OBJ: lines joined without end are refused before they fill the memory") {
  std::string text = "v 0 0 0\nf ";
  while (text.size() < 2 * Input::kLongestLine) text += "1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 \\\n";
  CHECK_THAT(refusal(text), Contains("expected at most 16777216 bytes in lines joined by backslashes"));
  CHECK_THAT(refusal(kObj + std::string(2 * Input::kLongestLine, ' ')), Contains("line 10: the line is longer than 16777216 bytes"));
}

TEST_CASE("OBJ: what is decoration is skipped; lines, points and free-form parts are counted") {
  const auto warnings = [](const std::string& more) {
    const Result r = read(more + kObj + more);
    CHECK(r.facets == tetrahedron());
    return r.file.warnings;
  };
  const auto one = [](const std::string& text) { return std::vector<std::string>{text}; };
  CHECK(warnings("mtllib a.mtl\nusemtl steel\ns off\nvp 1 2\nsomething new 1 2 3\n\n  \t\n").empty());
  CHECK(warnings("l 1 2 3\n") == one("2 polylines were skipped"));
  CHECK(warnings("p 1 2 \\\n3 # 4\n") == one("6 points were skipped"));
  CHECK(warnings("l 1 2\np 1\ncstype bezier\ndeg 3 3\ncurv 0 1 1 2\nparm u 0 1\nend\ncurv2 1 2\n") ==
        one("2 polylines, 2 points and 4 free-form curves were skipped"));
  CHECK(warnings("l 1 2\ncstype rat bspline\ndeg 3 3\nsurf 0 1 0 1 1 2 3 4\nparm u 0 1\ntrim 0 1 1\nhole 0 1 1\nscrv 0 1 1\nsp 1\nend\n") ==
        one("2 polylines and 2 free-form surfaces were skipped: convert surfaces to polygons where the body needs them"));
  CHECK(read(kObj + "l 1 2").file.warnings == one("1 polyline was skipped"));
  CHECK_THAT(refusal("v 0 0 0\nsurf 0 1 0 1 1\n"), Contains("mesh: holds no facet: 1 free-form surface was skipped: convert"));
}

TEST_CASE("OBJ: what is wrong is named with its line") {
  const auto with_face = [](const std::string& face) { return refusal("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + face + "\nv 0 0 1\n"); };
  CHECK_THAT(with_face("f 1 2 0"), Contains("mesh: line 4: vertex 0 of a face"));
  CHECK_THAT(with_face("f 1 2 3\nf 3/1 2/1 1/1\nf 3 2 1\nf 1 2 4"),
             Contains("mesh: line 7: vertex 4 of a face: expected one of the 3 declared so far"));
  CHECK_THAT(with_face("f 1 2 3\nf 1 2 3\nf 1 2"), Contains("mesh: line 6: expected a face of 3 or more vertices, found 2"));
  CHECK_THAT(with_face("f 1 2 4"), Contains("mesh: line 4: vertex 4 of a face: expected one of the 3 declared so far"));
  CHECK_THAT(with_face("f 1 2 -4"), Contains("mesh: line 4: vertex -4"));
  CHECK_THAT(with_face("f 1 2"), Contains("mesh: line 4: expected a face of 3 or more vertices, found 2"));
  CHECK_THAT(with_face("f 1 2 x"), Contains("expected a vertex number, found 'x'"));
  CHECK_THAT(with_face("f 1 2 3.5"), Contains("expected a vertex number, found '3.5'"));
  CHECK_THAT(with_face("f 1 2 3/a"), Contains("expected a vertex v, v/t, v//n or v/t/n, found '3/a'"));
  CHECK_THAT(with_face("f 1 2 /3"), Contains("found '/3'"));
  CHECK_THAT(with_face("f 1 2 99999999999999999999"), Contains("expected a vertex number"));
  CHECK_THAT(refusal("v 1 2\n"), Contains("mesh: line 1: expected a number, found the end of the line"));
  CHECK_THAT(with_face(""), Contains("holds no facet"));
}

TEST_CASE("OBJ: a helper that parses half of the plain vertices changes neither facets nor messages") {
  constexpr int kVertices = 60'000;
  const auto text = [](int odd_at, const std::string& odd) {
    std::string s;
    for (int i = 0; i < kVertices; ++i) s += i == odd_at ? odd : "v " + std::to_string(i) + ".25 -0 1e" + std::to_string(i % 9) + "\n";
    for (int i = 3; i <= kVertices; i += 1000) s += "f -1 " + std::to_string(i - 1) + " " + std::to_string(i) + "\n";
    return s;
  };
  const auto outcome = [](const std::string& bytes, Background* helper) {
    std::pair<Facets, std::string> found;
    Input input("mesh", bytes);
    try {
      read_facets(input, "",
                  [&](std::span<const Facet> some) {
                    for (const Facet& f : some) found.first.push_back(f.vertex);
                  },
                  {.helper = helper});
    } catch (const InputError& e) {
      found.second = e.what();
    }
    return found;
  };
  for (const int odd_at : {0, 1, 5'000, 12'345, 30'000, kVertices - 1}) {
    if (kSanitized && odd_at != 12'345) continue;
    for (const std::string odd : {"v 1 2 3\n", "  v 1 2 3\n", "v\t1  2\t3 \r\n", "v 1 2 3 0.5\n", "v 1 2 3 # red\n", "v 1 \\\n2 3\n",
                                  "# v 1 2 3\nv 1 2 3\n", "vn 0 0 1\nv 1 2 3\n", "f 1 1 1\nv 1 2 3\n", "v 1 2\n", "v 1 2 x\n", "v 1 2 3x\n",
                                  "v 1 2-3\n", "v 1 2 inf\n", "v +1 2 3\n", "v 1e-400 2 3\n", "v1 2 3\n", "\n\nv 1 2 3\n"}) {
      INFO("'" << odd << "' at " << odd_at);
      const std::string bytes = text(odd_at, odd);
      const auto alone = outcome(bytes, nullptr);
      const std::string fault_alone = outcome(bytes + "f 1 2 nothing\n", nullptr).second;
      for (const bool own_thread : {false, true}) {
        Background helper(own_thread);
        CHECK((outcome(bytes, &helper) == alone));
        CHECK(outcome(bytes + "f 1 2 nothing\n", &helper).second == fault_alone);
      }
    }
  }
  Background helper(true);
  CHECK_THAT(outcome(text(5'000, "v 1 2 3 # red\n") + "f 1 2 nothing\n", &helper).second,
             Contains("mesh: line " + std::to_string(kVertices + kVertices / 1000 + 1) + ":"));
}
