// Names in lists: plain ones, and those in quotes.
#include "store/text/name_list.hpp"

#include "store/base/error.hpp"
#include "tests/support/test.hpp"

namespace teracell {
namespace {

using Names = std::vector<std::string>;
using Pairs = std::vector<std::pair<std::string, std::string>>;

Pairs assigned(const std::string& list) {
  Pairs out;
  for (const Assignment& a : assignments_in(list, "--map")) out.emplace_back(a.name, a.value);
  return out;
}

TEST_CASE("A name in a list may stand in double quotes, with those inside it doubled") {
  CHECK(names_in("air", "--fluid") == Names{"air"});
  CHECK(names_in("air,fresh water,a=b", "--fluid") == Names{"air", "fresh water", "a=b"});
  CHECK(names_in(R"("air","a,b",steel)", "--fluid") == Names{"air", "a,b", "steel"});
  CHECK(names_in(R"("""","a""b")", "--fluid") == Names{"\"", "a\"b"});
}

TEST_CASE("A value stands behind the last equal sign, or behind the closing quote") {
  CHECK(assigned("air=0,steel=2.5") == Pairs{{"air", "0"}, {"steel", "2.5"}});
  CHECK(assigned(R"("a,b"=1,c=d=2,"e=f"=3,"g""h"=inf)") == Pairs{{"a,b", "1"}, {"c=d", "2"}, {"e=f", "3"}, {"g\"h", "inf"}});
}

TEST_CASE("Whatever names are, they are found in the list that is shown of them") {
  std::mt19937_64 random(1);
  for (int round = 0; round < 2000; ++round) {
    Names names(1 + random() % 4);
    std::string list, assignments;
    Pairs expected;
    for (std::string& name : names) {
      for (size_t length = 1 + random() % 5; name.size() < length;) name += "a,=\" "[random() % 5];
      list += (list.empty() ? "" : ",") + listed({name});
      expected.emplace_back(name, std::to_string(random() % 100));
      assignments += (assignments.empty() ? "" : ",") + listed({name}) + "=" + expected.back().second;
    }
    INFO(list);
    CHECK(names_in(list, "--fluid") == names);
    CHECK(assigned(assignments) == expected);
  }
}

TEST_CASE("A list that is shown ends when it is long") {
  CHECK(listed({}).empty());
  CHECK(listed({"air", "a,b", "c=d", "e\"f"}) == R"(air, "a,b", "c=d", "e""f")");
  const std::string shown = listed(Names(1000, "steel"));
  CHECK((shown.size() < 250 && shown.starts_with("steel, steel, ") && shown.ends_with(", steel, ...")));
}

TEST_CASE("A name or a value that is missing, and a quote without its end, are refused") {
  for (const char* list : {"", ",", "a,", ",a", "a,,b", R"(")", R"(""")", R"("a)", R"(a,"b)", R"("a"b)", R"("a" ,b)", R"("")"}) {
    INFO(list);
    CHECK_THROWS_AS(names_in(list, "--fluid"), UsageError);
    CHECK_THROWS_WITH(names_in(list, "--fluid"), Catch::StartsWith("--fluid: expected "));
  }
  for (const char* list : {"", "a", "a=", "=1", "a=1,", "a=1,b", R"("a")", R"("a=1)", R"("a"1)", R"("a"=)", R"(""=1)", R"("a" =1)"}) {
    INFO(list);
    CHECK_THROWS_AS(assignments_in(list, "--map"), UsageError);
    CHECK_THROWS_WITH(assignments_in(list, "--map"), Catch::StartsWith("--map: expected "));
  }
  CHECK_THROWS_WITH(assignments_in(R"("steel, 2 ""mm""")", "--map"), Catch::EndsWith(R"(found '"steel, 2 ""mm"""')"));
  CHECK_THROWS_WITH(assignments_in(R"(a=1,"b,c","d")", "--map"), Catch::EndsWith(R"(found '"b,c"' in a=1,"b,c","d")"));
  CHECK_THROWS_WITH(assignments_in(R"(a"b,c"=1)", "--map"), Catch::EndsWith(R"(found 'a"b')"));
}

}  // namespace
}  // namespace teracell
