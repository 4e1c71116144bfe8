// STL, binary and ASCII.
#include "tests/support/surfaces.hpp"

using namespace teracell;
using namespace teracell::mesher;
using namespace teracell::surfaces;
using Catch::Contains;

TEST_CASE("Binary STL: a file with fewer facets than the header counts is refused") {
  const std::string whole = binary_stl(tetrahedron());
  for (const bool zip : {false, true}) {
    const auto message = [&](const std::string& bytes) { return refusal(zip ? gzipped(bytes) : bytes); };
    CHECK_THAT(message(whole.substr(0, 200)), Contains("byte 80") && Contains("the header counts 4 facets (284 bytes), the file has 200: cut short"));
  }
  std::string liar = whole;
  liar.replace(80, 4, "\xff\xff\xff\xff");
  CHECK_THAT(refusal(liar), Contains("4294967295 facets (214748364834 bytes), the file has 284"));
  // Long enough that the size of the gzip contents isn't known at the first look.
  const std::string large = binary_stl(Facets(5000, tetrahedron()[0]));
  CHECK_THAT(refusal(gzipped(large.substr(0, 100'000))), Contains("byte 80 (uncompressed)") && Contains("the file has 100000: cut short"));
  CHECK_THAT(refusal(binary_stl({})), Contains("mesh: holds no facet"));
}

TEST_CASE("Binary STL: bytes after the last facet are skipped and counted") {
  const bool zip = GENERATE(false, true);
  const Facets many(5000, tetrahedron()[0]);  // longer than the first look at the contents of a gzip
  for (const Facets& facets : {tetrahedron(), many})
    for (const std::string header : {"made by a test", "solid but binary"}) {
      const auto result = [&](const std::string& more) {
        const std::string bytes = binary_stl(facets, header) + more;
        return read(zip ? gzipped(bytes) : bytes);
      };
      CHECK(result("").file.warnings.empty());
      for (const std::string& more : {std::string("x"), std::string(120, '\0'), std::string(1'000'001, 'x')}) {
        const Result r = result(more);
        CHECK((r.facets == facets));
        REQUIRE(r.file.warnings.size() == 1);
        CHECK(r.file.warnings[0] == std::to_string(more.size()) +
                                        (more.size() == 1 ? " byte after the last facet was skipped" : " bytes after the last facet were skipped"));
      }
      const std::string count = std::to_string(facets.size());
      CHECK(result(std::string(50, 'x')).file.warnings[0] ==
            "50 bytes after the last facet were skipped, as many as 1 facet takes: the header's count of " + count + " may be wrong");
      CHECK_THAT(result(std::string(100, 'x')).file.warnings[0], Contains("as many as 2 facets take: "));
    }
  CHECK_THAT(refusal(binary_stl({}) + std::string(100, 'x')), Contains("byte 80: the header counts 0 facets, but 100 bytes follow"));
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

TEST_CASE("ASCII STL: all of it may be on one line, several solids too") {
  const auto on_one_line = [](std::string text) {
    for (char& c : text) c = c == '\n' ? ' ' : c;
    return text;
  };
  for (const std::string name : {"", "hull", "the solid hull", "facet", "endsolid"})
    for (const std::string& text : {on_one_line(ascii_stl(tetrahedron(), name) + ascii_stl(tetrahedron(), "deck")),
                                    on_one_line(ascii_stl(tetrahedron(), name)) + "\n" + ascii_stl(tetrahedron(), "deck")}) {
      CAPTURE(text);
      CHECK(read(text).facets.size() == 8);
      CHECK(read(text, "deck").facets == tetrahedron());
      CHECK(read(text, name).facets.size() == (name.empty() ? 8 : 4));
      CHECK(read(text).file.parts.size() == (name.empty() ? 1 : 2));
      CHECK(read(text).file.warnings.empty());
    }
}

TEST_CASE("ASCII STL: a solid may lack its endsolid, if its last facet is whole") {
  const std::string whole = ascii_stl(tetrahedron(), "a"), open = whole.substr(0, whole.find("endsolid"));
  const auto warnings = [](const std::string& text) { return read(text).file.warnings; };
  const std::string at_end = "the file ends without 'endsolid': it may be cut short";
  CHECK(read(open).facets == tetrahedron());
  CHECK(warnings(open) == std::vector<std::string>{at_end});
  CHECK(warnings(open.substr(0, open.size() - 1)) == std::vector<std::string>{at_end});
  const std::string two = open + ascii_stl(tetrahedron(), "b");
  CHECK(read(two, "b").facets == tetrahedron());
  CHECK(read(two).facets.size() == 8);
  CHECK(warnings(two) == std::vector<std::string>{"1 solid lacks its 'endsolid' before the next"});
  CHECK(warnings(open + two + open) == std::vector<std::string>{"2 solids lack their 'endsolid' before the next", at_end});
  CHECK_THAT(refusal(whole + "solid b\n"), Contains("line 31: cut short: expected 'facet'"));
  for (const std::string end : {" fac", " facet", " facet normal 0 0 0 outer loop vertex 1"})
    CHECK_THAT(refusal(open + end), Contains("mesh: line 30"));
}

TEST_CASE("ASCII STL: lines that begin with no word of STL are skipped and counted") {
  const std::string whole = ascii_stl(tetrahedron(), "t");
  std::string all = "# made by a test\n" + whole;
  for (const std::string word : {" facet", "  outer", "   vertex", "  endloop", " endfacet", "endsolid"}) {
    const std::string one = replaced(whole, word, "color 0.5 facet 0.5\n" + word);
    CHECK(read(one).facets == tetrahedron());
    CHECK(read(one).file.parts == std::vector<std::string>{"t"});
    const size_t line = 1 + static_cast<size_t>(std::ranges::count(whole.substr(0, whole.find(word)), '\n'));
    CHECK(read(one).file.warnings ==
          std::vector<std::string>{"a line that is not STL was skipped: line " + std::to_string(line) + ", 'color 0.5 facet 0.5'"});
    all = replaced(all, word, "\tcolor 1 0 0\r\n" + word);
  }
  all += "that is all\n";
  CHECK(read(all).facets == tetrahedron());
  CHECK(read(all).file.warnings == std::vector<std::string>{"8 lines that are not STL were skipped, the first is line 1, '# made by a test'"});
  CHECK_THAT(refusal(replaced(whole, "outer", "color 1\n  outer color 1")),
             Contains("line 4: expected 'loop', found 'color' (line 3, 'color 1', was skipped)"));
}

TEST_CASE("ASCII STL: what is wrong is named with its line") {
  const std::string whole = ascii_stl(tetrahedron(), "t");
  CHECK_THAT(refusal("solid as a rock\nnothing else\n"),
             Contains("line 2: cut short: expected 'facet'") && Contains("(line 2, 'nothing else', was skipped)"));
  CHECK_THAT(refusal(replaced(whole, "normal 0 0 0", "normal 0 0")), Contains("line 3: expected 'outer', found 'loop'"));
  CHECK_THAT(refusal(replaced(whole, "vertex 0 0 0", "vertex 0 0")), Contains("line 5: expected a number, found 'vertex'"));
  CHECK_THAT(refusal(replaced(whole, "  endloop", "vertex 1 1 1\n  endloop")), Contains("line 7: expected 'endloop', found 'vertex'"));
  CHECK_THAT(refusal(replaced(whole, " facet", " faced")),
             Contains("line 3: expected 'facet', found 'outer' (line 2, 'faced normal 0 0 0', was skipped)"));
  CHECK_THAT(refusal(whole + "facet normal\n"), Contains("line 31: expected 'solid', found 'facet'"));
  CHECK_THAT(refusal("solid Empty\nendsolid Empty\n"), Contains("holds no facet"));
}
