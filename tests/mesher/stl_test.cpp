// STL, binary and ASCII.
#include "tests/support/surfaces.hpp"

using namespace teracell;
using namespace teracell::surfaces;
using Catch::Matchers::Contains;

TEST_CASE("Binary STL: the header's count and the size must agree") {
  const std::string whole = binary_stl(tetrahedron());
  for (const bool zip : {false, true}) {
    const auto message = [&](const std::string& bytes) { return refusal(zip ? gzipped(bytes) : bytes); };
    CHECK_THAT(message(whole.substr(0, 200)),
               Contains("byte 80") && Contains("the header counts 4 facets (284 bytes), the file has 200: cut short"));
    CHECK_THAT(message(whole + "xyz"),
               Contains("byte 80") && Contains("4 facets (284 bytes)") && Contains("bytes follow"));
  }
  std::string liar = whole;
  liar.replace(80, 4, "\xff\xff\xff\xff");
  CHECK_THAT(refusal(liar), Contains("4294967295 facets (214748364834 bytes), the file has 284"));
  // Long enough that the size of the gzip contents isn't known at the first look.
  const std::string large = binary_stl(Facets(5000, tetrahedron()[0]));
  CHECK_THAT(refusal(gzipped(large.substr(0, 100'000))),
             Contains("byte 80 (uncompressed)") && Contains("the file has 100000: cut short"));
  CHECK_THAT(refusal(gzipped(large + "x")), Contains("the file has more than 250084"));
  CHECK_THAT(refusal(binary_stl({})), Contains("mesh: holds no facet"));
}

TEST_CASE("ASCII STL: keywords in any case, any layout, several solids") {
  std::string text = ascii_stl(tetrahedron(), "");
  for (char& c : text) c = static_cast<char>(std::toupper(c));
  CHECK(read(text).facets == tetrahedron());
  for (char& c : text) c = c == '\n' ? ' ' : c;
  CHECK(read(replaced(text, "SOLID ", "SOLID\n")).facets == tetrahedron());
  CHECK(read(replaced(text, "SOLID ", "SOLID\n")).file.parts.empty());
  const Result two = read(ascii_stl(tetrahedron(), "the hull") + ascii_stl(tetrahedron(), "deck"));
  CHECK(two.facets.size() == 8);
  CHECK(two.file.parts == std::vector<std::string>{"the hull", "deck"});
  CHECK(read(replaced(ascii_stl(tetrahedron(), "t"), "normal 0 0 0", "normal nan -1.#IND x")).facets == tetrahedron());
}

TEST_CASE("ASCII STL: what is wrong is named with its line") {
  const std::string whole = ascii_stl(tetrahedron(), "t");
  CHECK_THAT(refusal(whole.substr(0, whole.find("endsolid"))), Contains("line 29: cut short: expected 'endsolid'"));
  CHECK_THAT(refusal(replaced(whole, "normal 0 0 0", "normal 0 0")),
             Contains("line 3: expected 'outer', found 'loop'"));
  CHECK_THAT(refusal(replaced(whole, "vertex 0 0 0", "vertex 0 0")),
             Contains("line 5: expected a number, found 'vertex'"));
  CHECK_THAT(refusal(replaced(whole, "  endloop", "vertex 1 1 1\n  endloop")),
             Contains("line 7: expected 'endloop', found 'vertex'"));
  CHECK_THAT(refusal(replaced(whole, " facet", " faced")), Contains("line 2: expected 'facet', found 'faced'"));
  CHECK_THAT(refusal(whole + "and more\n"), Contains("line 31: expected 'solid', found 'and'"));
  CHECK_THAT(refusal("solid Empty\nendsolid Empty\n"), Contains("holds no facet"));
}
