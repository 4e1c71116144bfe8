// Names of parts, and globs for them.
#include "mesher/surface/part_path.hpp"

#include "tests/support/catch.hpp"

using namespace teracell::mesher;

using Names = std::vector<std::string>;

TEST_CASE("A path is a glob that matches itself, whatever its names hold") {
  const Names names = {"as1", "a/b*c?[d]\\", "колонна", "支持体#2"};
  std::string path;
  for (const std::string& name : names) path = path_below(path, name);
  CHECK(path == "/as1/a\\/b\\*c\\?\\[d]\\\\/колонна/支持体#2");
  CHECK(names_of(path) == names);
  CHECK(PartGlob(path).is_path());
  CHECK(PartGlob(path).matches(path));
  CHECK_FALSE(PartGlob(path).matches(path_below("/as1", "a")));
}

TEST_CASE("Globs: a leading slash asks for the whole path, else the last name or the path; a star matches slashes, too") {
  const auto matches = [](const char* glob, const char* path) { return PartGlob(glob).matches(path); };
  CHECK(matches("", "/as1/nut"));
  CHECK(matches("nut", "/as1/nut"));
  CHECK(matches("n*", "/as1/nut"));
  CHECK_FALSE(matches("as1", "/as1/nut"));
  CHECK(matches("/as1/*", "/as1/rod/nut"));
  CHECK_FALSE(matches("/as1", "/as1/nut"));
  CHECK(matches("*rod/nut", "/as1/rod/nut"));
  CHECK(matches("*nut*", "/nuts/bolt"));
  CHECK_FALSE(matches("NUT", "/as1/nut"));
  CHECK(matches("a\\/b", "/x/a\\/b"));  // a name with a slash is told from two names
  CHECK_FALSE(matches("/x/a/b", "/x/a\\/b"));
  CHECK(matches("?", "/a/ж"));  // a character, of however many bytes
  CHECK(matches("支[一-龠]?", "/支持体"));
  CHECK_FALSE(matches("???", "/ж"));
  CHECK(PartGlob("gear?").matches_name("gear1"));
  CHECK(PartGlob("/gear1").matches_name("gear1"));
  CHECK(PartGlob("/mesh 1").matches_name(""));
  CHECK_FALSE(PartGlob("/").matches_name(""));
}

TEST_CASE("Of siblings with one name the later get a number that no other has") {
  CHECK(told_apart({"a", "b", "a", "a"}) == Names{"a", "b", "a#2", "a#3"});
  CHECK(told_apart({"a", "a", "a#2", "a#2", "a"}) == Names{"a", "a#3", "a#2", "a#2#2", "a#4"});
}
