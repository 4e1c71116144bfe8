// OFF.
#include "tests/support/surfaces.hpp"

using namespace teracell;
using namespace teracell::mesher;
using namespace teracell::surfaces;
using Catch::Contains;

namespace {

const std::string kBody = "4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 0.5\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

}  // namespace

TEST_CASE("OFF: vertices and faces; normals, colours, comments and the counts' place don't matter") {
  const Result r = read("OFF\n" + kBody);
  CHECK(r.facets == tetrahedron());
  CHECK(r.file.format == "OFF");
  CHECK_FALSE(r.file.float32);
  CHECK(r.file.unit.empty());
  CHECK(read("OFF " + kBody).facets == tetrahedron());
  CHECK(read("# made by a test\nOFF # a comment\n\n" + replaced(kBody, "1 0 0\n", "1 0 0 # the second\n\n")).facets == tetrahedron());
  CHECK(read("CNOFF\n" + replaced(kBody, "0 1 0\n", "0 1 0 0 0 1 255 0 0 255\n")).facets == tetrahedron());
  CHECK(read("OFF\n" + replaced(kBody, "3 1 2 3", "3 1 2 3 0.5 0.5 0.5")).facets == tetrahedron());
  CHECK(read("OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n").facets.size() == 2);
  CHECK(read("OFF\n" + kBody + "1 2 3\n").file.warnings == std::vector<std::string>{"1 line after the last face was skipped"});
}

TEST_CASE("OFF: what is wrong is named with its line") {
  CHECK_THAT(refusal("OFF\n" + replaced(kBody, "4 4", "5 4")), Contains("mesh: line 10: cut short: expected a face"));
  CHECK_THAT(refusal("OFF\n" + replaced(kBody, "3 1 2 3", "3 1 2 4")), Contains("mesh: line 10: expected the number of a vertex, 0 to 3, found '4'"));
  CHECK_THAT(refusal("OFF\n" + replaced(kBody, "3 1 2 3", "3 1 2")), Contains("line 10: expected the number of a vertex, found the end of the line"));
  CHECK_THAT(refusal("OFF\n" + replaced(kBody, "0 0 0.5", "0 0")), Contains("line 6: expected a number"));
  CHECK_THAT(refusal("OFF\n4 -4 6\n"), Contains("line 2: expected the number of faces, found '-4'"));
  CHECK_THAT(refusal("OFF BINARY\n1 2 3"), Contains("line 1: expected an OFF file in text"));
  CHECK_THAT(refusal("4OFF\n" + kBody), Contains("expected three coordinates in each vertex"));
  CHECK_THAT(refusal("OFF\n1000000000000000 5 6\n0 0 0\n"), Contains("cut short: expected a vertex"));
}
