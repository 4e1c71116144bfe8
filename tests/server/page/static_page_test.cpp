// The page without a server: which files there are, what lists the grids in them, and what is refused.
#include "server/page/static_page.hpp"

#include "tests/support/gzip.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

namespace teracell::server {
namespace {

using namespace testing;

const std::string kListElement = "<script id=\"grids\" type=\"application/json\">";
const std::string kPageIndex = "<!doctype html><body>" + kListElement + "null</script><p>page</body>",
                  kPageWhole = "<!doctype html>" + kListElement + "[]</script><p>whole";

std::span<const EmbeddedFile> page() {
  static const std::string index = gzipped(kPageIndex), whole = gzipped(kPageWhole), script = gzipped("let a = 1;");
  static const EmbeddedFile files[] = {{"assets/main.js", script}, {"index.html", index}, {"whole.html", whole}};
  return files;
}

struct Memory : MemorySource {
  Memory(std::string name, const std::string& bytes) : MemorySource({bytes.begin(), bytes.end()}, std::move(name)) {}
};

void write(const std::filesystem::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

const auto kSilent = [](double) {};

nlohmann::json list_in(const std::string& html) {
  const size_t begin = html.find(kListElement) + kListElement.size();
  return nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

// Reads the elements of grid `number` back.
std::string held(const std::string& html, int number) {
  const std::string begin = "<script type=\"text/plain\" class=\"grid-" + std::to_string(number) + "\">";
  std::string out;
  for (size_t at = html.find(begin); at != html.npos; at = html.find(begin, at + 1)) {
    const size_t from = at + begin.size();
    uint32_t bits = 0;
    int have = 0;
    for (const char c : html.substr(from, html.find('<', from) - from)) {
      const size_t digit = std::string_view("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/").find(c);
      if (digit == std::string_view::npos) {
        REQUIRE(c == '=');
        continue;
      }
      bits = bits << 6 | static_cast<uint32_t>(digit);
      if ((have += 6) >= 8) out += static_cast<char>(bits >> (have -= 8) & 255);
    }
  }
  return out;
}

TEST_CASE("a folder has the page, its licences, the grids, and an index that lists them", "[server][static_page]") {
  TempFolder folder;
  const Memory a("a b.tcell", std::string(3 << 20, 'x'));
  double share = 0;
  write_site(page(), "licences", {{"a b.tcell", "", &a}, {"far.tcell", "https://example.org/far.tcell", nullptr}}, folder / "site",
             [&](double s) { share = s; });
  CHECK(share == 1);
  CHECK(bytes_of(folder / "site/assets/main.js") == "let a = 1;");
  CHECK(bytes_of(folder / "site/NOTICE") == "licences");
  CHECK(bytes_of(folder / "site/a b.tcell") == std::string(3 << 20, 'x'));
  CHECK(list_in(bytes_of(folder / "site/index.html")) ==
        nlohmann::json::parse(
            R"([{"name": "a b.tcell", "address": "a%20b.tcell"}, {"name": "far.tcell", "address": "https://example.org/far.tcell"}])"));
}

TEST_CASE("what was found in a grid travels with it", "[server][static_page]") {
  TempFolder folder;
  const Memory a("a", "1"), b("b", "2");
  const std::string findings = R"({"name":"</script>"})";
  const std::vector<PageGrid> grids = {{"a.tcell", "", &a}, {"b c.tcell", "", &b, findings, "1234"}};
  write_site(page(), "", grids, folder / "site", kSilent);
  write_whole_page(page(), grids, folder / "g.html", kSilent);
  CHECK(bytes_of(folder / "site/b c.check.json") == findings);
  CHECK(!std::filesystem::exists(folder / "site/a.check.json"));
  CHECK(list_in(bytes_of(folder / "site/index.html")) ==
        nlohmann::json::parse(R"([{"name": "a.tcell", "address": "a.tcell"}, {"name": "b c.tcell", "address": "b%20c.tcell", "checked": "1234"}])"));
  const std::string html = bytes_of(folder / "g.html");
  CHECK(list_in(html)[1]["checked"] == "1234");
  CHECK(html.find(R"(</script>
<script id="findings-1" type="application/json">{"name":"\u003c/script>"}</script>)") != html.npos);
  CHECK(html.find("findings-0") == html.npos);
}

TEST_CASE("a folder may be written again, and its grids may lie in it already", "[server][static_page]") {
  TempFolder folder;
  std::filesystem::create_directories(folder / "site");
  write(folder / "site/g.tcell", "grid");
  write(folder / "site/other.txt", "stays");
  const InputFile grid(folder / "site/g.tcell");
  for (int i = 0; i < 2; ++i) write_site(page(), "", {{"g.tcell", "", &grid}}, folder / "site", kSilent);
  CHECK(bytes_of(folder / "site/g.tcell") == "grid");
  CHECK(bytes_of(folder / "site/other.txt") == "stays");
}

TEST_CASE("a folder with another page, and two grids of one name, are refused before anything is written", "[server][static_page]") {
  TempFolder folder;
  std::filesystem::create_directories(folder / "home");
  write(folder / "home/index.html", "<h1>my home page</h1>");
  CHECK_THROWS_WITH(write_site(page(), "", {}, folder / "home", kSilent), Catch::Contains("it is not a page of teracell, and would be replaced"));
  CHECK(!std::filesystem::exists(folder / "home/assets"));
  const Memory one("x/g.tcell", "1"), two("y/g.tcell", "2");
  CHECK_THROWS_WITH(write_site(page(), "", {{"g.tcell", "", &one}, {"g.tcell", "", &two}}, folder / "site", kSilent),
                    Catch::Contains("two grids have the name g.tcell"));
  CHECK(!std::filesystem::exists(folder / "site"));
  for (const char* name : {"NOTICE", "index.html", "whole.html", "assets"})
    CHECK_THROWS_WITH(write_site(page(), "", {{name, "", &one}}, folder / "site", kSilent), Catch::Contains("the page has a file of this name"));
  std::filesystem::create_directories(folder / "source");
  write(folder / "source/NOTICE", "of somebody else");
  CHECK_THROWS_WITH(write_site(page(), "", {}, folder / "source", kSilent), Catch::Contains("source/NOTICE: it would be replaced"));
  write(folder / "file", "no folder");
  CHECK_THROWS_WITH(write_site(page(), "", {}, folder / "file", kSilent),
                    Catch::Contains("expected a folder, or a name that ends with .html, found a file"));
  CHECK_THROWS_AS(write_site(page(), "", {}, "", kSilent), UsageError);
}

TEST_CASE("one file holds the grids, to the last byte", "[server][static_page]") {
  TempFolder folder;
  for (const size_t size : {size_t{0}, size_t{1}, size_t{2}, size_t{49151}, size_t{49152}, size_t{49153}, size_t{200000}}) {
    std::string bytes;
    for (size_t i = 0; i < size; ++i) bytes += static_cast<char>(i * 7919 >> 3);
    const Memory a("a", bytes), b("</script><b>", "second");
    write_whole_page(page(), {{"a", "", &a}, {"</script><b>", "", &b}}, folder / "g.html", kSilent);
    const std::string html = bytes_of(folder / "g.html");
    CHECK(held(html, 0) == bytes);
    CHECK(held(html, 1) == "second");
    CHECK(list_in(html) == nlohmann::json({{{"name", "a"}, {"bytes", size}}, {{"name", "</script><b>"}, {"bytes", 6}}}));
    CHECK(html.ends_with("<p>whole"));
    CHECK(html.starts_with("<!doctype html>"));
  }
}

TEST_CASE("what is too large for one file, and a program without the module, are refused", "[server][static_page]") {
  struct Large final : ByteSource {
    std::string its_name = "large";
    uint64_t size() const override { return kMostHeld + 1; }
    const std::string& name() const override { return its_name; }
    void read(uint64_t, std::span<uint8_t>) const override {}
  } large;
  TempFolder folder;
  CHECK_THROWS_WITH(write_whole_page(page(), {{"large", "", &large}}, folder / "g.html", kSilent), Catch::Contains("at most 268435456 bytes"));
  CHECK(!std::filesystem::exists(folder / "g.html"));
  CHECK_THROWS_WITH(expect_module(page().first(2)), Catch::Contains("-DTERACELL_WASM=ON"));
  CHECK_NOTHROW(expect_module(page()));
}

}  // namespace
}  // namespace teracell::server
