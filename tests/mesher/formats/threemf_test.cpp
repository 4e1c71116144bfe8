// 3MF.
#include "tests/support/assembly_files.hpp"

using namespace teracell;
using namespace teracell::mesher;
using namespace teracell::surfaces;
using Catch::Contains;

namespace {

std::string one_item(const std::string& object, const std::string& item = "") {
  return "<resources>" + object + "</resources><build><item objectid=\"1\" " + item + "/></build>";
}

}  // namespace

TEST_CASE("3MF: facets as they are, in the unit that the file states") {
  const Result r = read(threemf(one_item(tetrahedron_object(1, "name=\"tet\""))));
  CHECK(r.facets == tetrahedron());
  CHECK(r.file.format == "3MF");
  CHECK(r.file.unit == "mm");
  CHECK_FALSE(r.file.float32);
  CHECK(r.file.patches == std::vector<std::string>{"/tet"});

  const Result inch = read(threemf(one_item(tetrahedron_object(1)), "unit=\"inch\""), "", {}, nullptr, "mm");
  CHECK(inch.file.unit == "in");
  CHECK(inch.facets[3][0] == Vec3{25.4, 0, 0});
  CHECK(inch.facets[3][2] == Vec3{0, 0, 12.7});
  CHECK(inch.file.patches == std::vector<std::string>{"/object 1"});
}

TEST_CASE("3MF: components and items place objects, the outer last; mirrored facets are turned round") {
  const std::string resources = tetrahedron_object(1, "name=\"a\"") +
                                "<object id=\"2\" name=\"pair\"><components><component objectid=\"1\"/>"
                                "<component objectid=\"1\" transform=\"-1 0 0 0 1 0 0 0 1 5 0 0\"/></components></object>";
  const Result r = read(threemf("<resources>" + resources +
                                "</resources><build><item objectid=\"2\" transform=\"2 0 0 0 2 0 0 0 2 0 0 7\"/>"
                                "<item objectid=\"1\"/></build>"));
  REQUIRE(r.facets.size() == 12);
  CHECK(r.file.patches == std::vector<std::string>{"/pair/a", "/pair/a#2", "/a"});
  for (size_t i = 0; i < 4; ++i) {
    const auto f = tetrahedron()[i];
    const auto twice = [](const Vec3& v) { return Vec3{2 * v[0], 2 * v[1], 2 * v[2] + 7}; };
    const auto mirrored = [&](const Vec3& v) { return twice({5 - v[0], v[1], v[2]}); };
    CHECK(r.facets[i] == std::array{twice(f[0]), twice(f[1]), twice(f[2])});
    CHECK(r.facets[4 + i] == std::array{mirrored(f[0]), mirrored(f[2]), mirrored(f[1])});
    CHECK(r.facets[8 + i] == f);
  }
  CHECK(read(threemf(one_item(resources)), "/a").facets == tetrahedron());
}

TEST_CASE("3MF: what helps printing is left out, as an item and as a component, and said") {
  for (const std::string type : {"support", "solidsupport", "other"}) {
    const std::string helper = tetrahedron_object(2, "type=\"" + type + "\"");
    const Result r =
        read(threemf("<resources>" + tetrahedron_object(1, "name=\"a\"") + helper +
                     "<object id=\"3\" name=\"b\"><components><component objectid=\"1\"/><component objectid=\"2\"/></components></object>"
                     "</resources><build><item objectid=\"3\"/><item objectid=\"2\"/></build>"));
    CHECK(r.facets == tetrahedron());
    CHECK(r.file.patches == std::vector<std::string>{"/b/a"});
    REQUIRE(r.file.warnings.size() == 1);
    CHECK_THAT(r.file.warnings[0], Contains("2 places left out"));
  }
  CHECK_THAT(refusal(threemf("<resources>" + tetrahedron_object(1) + "</resources><build/>")),
             Contains("holds no facet: <build> has no item, so none of the 1 object stands anywhere"));
}

TEST_CASE("3MF: elements may declare namespaces of their own, however many do") {
  std::string objects;
  for (int id = 2; id < 400; ++id)
    objects += "<object id=\"" + std::to_string(id) + "\"><x:note xmlns:x=\"http://a/" + std::to_string(id) + "\"/></object>";
  CHECK(read(threemf(one_item(tetrahedron_object(1) + objects))).facets == tetrahedron());
}

TEST_CASE("3MF: a coordinate that leaves its range when it is converted is refused") {
  const std::string tiny = one_item(replaced(tetrahedron_object(1), "x=\"1\"", "x=\"2e-75\""));
  CHECK(read(threemf(tiny, "unit=\"micron\"")).facets[1][1][0] == 2e-75);
  try {
    read(threemf(tiny, "unit=\"micron\""), "", {}, nullptr, "m");
    FAIL("read");
  } catch (const InputError& e) {
    CHECK_THAT(e.what(), Contains("a vertex in the units of the scene: expected a coordinate that is 0 or has a magnitude from 1e-75"));
  }
}

TEST_CASE("3MF: what is wrong is named with its line") {
  const auto [inside, message] = GENERATE(table<std::string, std::string>({
      {one_item("<object id=\"1\"><mesh><vertices><vertex x=\"0\" y=\"nan\" z=\"0\"/></vertices></mesh></object>"),
       "y: expected a number that is 0 or has"},
      {one_item("<object id=\"1\"><mesh><vertices><vertex x=\"0\" z=\"0\"/></vertices></mesh></object>"),
       "y: expected a number that is 0 or has a magnitude from 1e-75 to 1e75, found none"},
      {one_item(replaced(tetrahedron_object(1), "v3=\"1\"", "v3=\"4\"")), "object 1: expected the number of a vertex, 0 to 3, found 4"},
      {one_item(replaced(tetrahedron_object(1), "v3=\"1\"", "v3=\"-1\"")), "v3: expected a whole number from 0 on, found '-1'"},
      {one_item(tetrahedron_object(2)), "expected the id of an object, found 1, which no object has"},
      {one_item(tetrahedron_object(1) + tetrahedron_object(1)), "expected objects with different ids, found 1 again"},
      {one_item(tetrahedron_object(1), "transform=\"1 2 3\""), "transform: expected a number"},
      {one_item(tetrahedron_object(1), "transform=\"1 0 0 0 1 0 0 0 1 0 0 0 7\""), "expected 12 numbers in a transform, found more"},
      {one_item("<object id=\"1\"><components><component objectid=\"1\"/></components></object>"), "does a part contain itself?"},
      {one_item("<object id=\"1\"/>"), "holds no facet"},
      {"<resources>", "not well-formed XML"},
      {std::string(100, ' ') + "<a>" + std::string(1 << 18, '<'), "not well-formed XML"},
  }));
  CHECK_THAT(refusal(threemf(inside)), Contains("mesh") && Contains(message));
}

TEST_CASE("3MF: packages and extensions that can't be read") {
  const std::string item = one_item(tetrahedron_object(1));
  CHECK_THAT(refusal(threemf(item, "unit=\"parsec\"")), Contains("line 2: expected the unit micron") && Contains("found 'parsec'"));
  CHECK_THAT(refusal(threemf(item, "xmlns:b=\"http://a/beamlattice\" requiredextensions=\"b\"")),
             Contains("an extension of 3MF, 'b' (http://a/beamlattice)"));
  CHECK(read(threemf(item, "xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\" requiredextensions=\"m\"")).facets ==
        tetrahedron());
  CHECK_THAT(refusal(threemf_package("<!DOCTYPE model [<!ENTITY a \"b\">]><model/>")), Contains("expected no document type definition"));
  CHECK_THAT(refusal(threemf_package(std::string("\xff\xfe\0\0<\0\0\0", 8))), Contains("expected text in UTF-8 or UTF-16, found UTF-32"));
  CHECK_THAT(refusal(threemf_package("<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><model/>")), Contains("found the encoding 'ISO-8859-1'"));
  CHECK_THAT(refusal(threemf_package("<html/>")), Contains("expected a <model> of 3MF, found none"));
  CHECK_THAT(refusal(package_of({{"_rels/.rels", kRelationships}})),
             Contains("expected the 3D model '/3D/3dmodel.model' in the package, found no such file"));
  CHECK_THAT(refusal(package_of({{"3D/3dmodel.model", "<model/>"}})), Contains("'_rels/.rels' in the package: expected a file, found none"));
}

TEST_CASE("3MF: cut short anywhere, or with any byte changed, it is refused or read, and nothing else") {
  const std::string whole = threemf(one_item(tetrahedron_object(1)));
  for (size_t bytes = 1; bytes < whole.size(); bytes += 7) CHECK_FALSE(refusal(std::string(whole.data(), bytes)).empty());
  for (size_t at = 0; at < whole.size(); at += 5) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x15);
    CHECK_NOTHROW(refusal(damaged));
  }
}

TEST_CASE("3MF: a tree that a few lines describe and no disk holds is refused") {
  const auto [first, message] = GENERATE(table<std::string, std::string>(
      {{tetrahedron_object(1), "expected at most 262144 parts"}, {"<object id=\"1\"/>", "expected at most 1048576 places in the tree of parts"}}));
  std::string objects = first;
  for (int id = 2; id < 45; ++id) {
    const std::string below = "<component objectid=\"" + std::to_string(id - 1) + "\"/>";
    objects += "<object id=\"" + std::to_string(id) + "\"><components>" + below + below + "</components></object>";
  }
  CHECK_THAT(refusal(threemf("<resources>" + objects + "</resources><build><item objectid=\"44\"/></build>")), Contains(message));
}
