// The page: the paths that it answers and the fields of the answers, from the program and from a folder.
#include "server/page/web.hpp"

#include "server/http/wire.hpp"
#include "server/service/target.hpp"
#include "tests/support/gzip.hpp"
#include "tests/support/meshed.hpp"

namespace teracell::server {
namespace {

using namespace testing;

const std::string kIndex = "<!doctype html><div id=app></div>", kScript = "let a = 1;" + std::string(50'000, ' '), kIcon = "<svg/>";

Page embedded() {
  static const std::string index = gzipped(kIndex), script = gzipped(kScript), icon = gzipped(kIcon);
  static const EmbeddedFile files[] = {{"assets/main-Ab3_x.js", script}, {"favicon.svg", icon}, {"index.html", index}};
  return Page(files);
}

struct Folder {
  TempFolder temporary;
  std::filesystem::path root = temporary / "page";
  Folder() {
    write("index.html", kIndex);
    write("assets/main-Ab3_x.js", kScript);
    write("favicon.svg", kIcon);
  }
  void write(const std::string& name, const std::string& text) {
    std::filesystem::create_directories((root / name).parent_path());
    std::ofstream(root / name) << text;
  }
};

Request request(const std::string& target, bool accepts_gzip = false, const std::string& if_none_match = "") {
  return {.target = target, .if_none_match = if_none_match, .accepts_gzip = accepts_gzip};
}

// Paths that no page may answer, whatever is in its folder or beside it.
const char* const kOthers[] = {"",
                               "*",
                               "/.",
                               "/..",
                               "//",
                               "/../secret.txt",
                               "/assets",
                               "/assets/",
                               "/assets/../secret.txt",
                               "/index",
                               "/nowhere",
                               "/x.js",
                               "/%69ndex.html",
                               "/page",
                               "/index.html/",
                               "/assets//etc",
                               "//etc/passwd",
                               "/etc/passwd",
                               "/healthz",
                               "/api/v1/grids",
                               "/openapi.json",
                               "/.hidden.txt",
                               "/link.txt",
                               "/assets/.git/config",
                               "/assets/..",
                               "/linked/secret.txt",
                               "/assets/main-Ab3_x.js%00"};

TEST_CASE("Clients that accept gzip get the page as it is stored, others get it inflated", "[server][web]") {
  const Page page = embedded();
  for (const auto& [target, text] :
       {std::pair{"/", kIndex}, {"/?at=1", kIndex}, {"/index.html", kIndex}, {"/assets/main-Ab3_x.js", kScript}, {"/favicon.svg", kIcon}}) {
    INFO(target);
    CHECK(page.has(path_of(target)));
    const auto packed = page.at_once(request(target, true));
    REQUIRE(packed);
    CHECK(packed->status == 200);
    CHECK(packed->content_encoding == "gzip");
    CHECK(*packed->body == gzipped(text));
    CHECK_FALSE(page.at_once(request(target)));  // it must be inflated
    const auto plain = page.answer(request(target));
    REQUIRE(plain);
    CHECK(plain->content_encoding.empty());
    CHECK(*plain->body == text);
    CHECK(plain->etag != packed->etag);
  }
}

TEST_CASE("Files whose names change with their content may be cached for ever; for index.html clients ask each time", "[server][web]") {
  const Page page = embedded();
  CHECK(page.answer(request("/"))->cache_control == "no-cache");
  CHECK(page.answer(request("/favicon.svg"))->cache_control == "no-cache");
  CHECK(page.answer(request("/assets/main-Ab3_x.js"))->cache_control == "public, max-age=31536000, immutable");
  CHECK(page.answer(request("/"))->content_type == "text/html; charset=utf-8");
  CHECK(page.answer(request("/assets/main-Ab3_x.js"))->content_type == "text/javascript; charset=utf-8");
  CHECK(page.answer(request("/favicon.svg"))->content_type == "image/svg+xml");
}

TEST_CASE("A client that has a file of the page already gets 304", "[server][web]") {
  Folder folder;
  for (const Page& page : {embedded(), Page(folder.root)})
    for (const bool accepts_gzip : {false, true}) {
      const Response first = *page.answer(request("/", accepts_gzip));
      REQUIRE(first.etag.size() > 10);
      const Response again = *page.answer(request("/", accepts_gzip, "\"other\", " + first.etag));
      CHECK(again.status == 304);
      CHECK(again.etag == first.etag);
      CHECK_FALSE(again.body);
      CHECK(page.answer(request("/", accepts_gzip, "\"other\""))->status == 200);
    }
}

TEST_CASE("The page takes code from its own server alone", "[server][web]") {
  std::string head;
  append_head(head, *embedded().answer(request("/", true)), {});
  CHECK(head.find("\r\nContent-Security-Policy: default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; ") != std::string::npos);
  CHECK(head.find("'unsafe") == std::string::npos);  // 'wasm-unsafe-eval' lets the module be compiled, and no script
  CHECK(head.find("\r\nX-Content-Type-Options: nosniff\r\n") != std::string::npos);
  CHECK(head.find("\r\nVary: Accept-Encoding\r\n") != std::string::npos);
  CHECK(head.ends_with("\r\n\r\n"));
  head.clear();
  append_head(head, *embedded().answer(request("/favicon.svg", true)), {});
  CHECK(head.find("\r\nVary: Accept-Encoding\r\n") != std::string::npos);
}

TEST_CASE("Paths that name no file of the page are left to the routes", "[server][web]") {
  Folder folder;
  std::ofstream(folder.temporary / "secret.txt") << "secret";
  std::filesystem::create_directory(folder.temporary / "elsewhere");
  std::ofstream(folder.temporary / "elsewhere" / "secret.txt") << "secret";
  std::filesystem::create_symlink(folder.temporary / "secret.txt", folder.root / "link.txt");
  std::filesystem::create_directory_symlink(folder.temporary / "elsewhere", folder.root / "linked");
  folder.write(".hidden.txt", "secret");
  folder.write("assets/.git/config", "secret");
  folder.write("api/v1/grids", "not the grids");
  for (const Page& page : {embedded(), Page(folder.root), Page()})
    for (const char* target : kOthers) {
      INFO(target);
      CHECK_FALSE(page.has(target));
      CHECK_FALSE(page.at_once(request(target, true)));
      CHECK_FALSE(page.answer(request(target)));
    }
  CHECK_FALSE(Page().has("/"));
}

TEST_CASE("A folder is read at each request", "[server][web]") {
  Folder folder;
  const Page page(folder.root);
  const Response before = *page.answer(request("/", true));
  CHECK(*before.body == kIndex);
  CHECK(before.cache_control == "no-cache");
  CHECK(page.answer(request("/assets/main-Ab3_x.js"))->cache_control == "no-cache");
  folder.write("index.html", "other");
  folder.write("assets/new.css", "a{}");
  CHECK(*page.answer(request("/", true))->body == "other");
  CHECK(page.answer(request("/"))->etag != before.etag);
  CHECK(page.answer(request("/assets/new.css"))->content_type == "text/css; charset=utf-8");
  std::filesystem::remove(folder.root / "assets/new.css");
  CHECK_FALSE(page.answer(request("/assets/new.css")));
}

TEST_CASE("A folder without a page is refused", "[server][web]") {
  TempFolder folder;
  CHECK_THROWS_AS(Page(folder.path()), IoError);
  CHECK_THROWS_WITH(Page(folder / "nowhere"), Catch::Contains("index.html") && Catch::Contains("nowhere"));
}

TEST_CASE("In front of other handlers the page answers its own paths, which need no token", "[server][web]") {
  const Page page = embedded(), none;
  const Handler inner{[](const Request&) { return std::optional<Response>(); }, [](const Request&) { return Response{.status = 418}; }};
  const Handler with = with_page(inner, page), without = with_page(inner, none);
  CHECK(with.at_once(request("/", true))->status == 200);
  CHECK(with.handle(request("/")).status == 200);
  CHECK(with.handle(request("/api/v1/grids")).status == 418);
  CHECK(with.is_open("/"));
  CHECK(with.is_open("/assets/main-Ab3_x.js"));
  CHECK_FALSE(with.is_open("/api/v1/grids"));
  CHECK(without.handle(request("/")).status == 418);
  CHECK_FALSE(without.is_open("/"));
}

TEST_CASE("A text in front of other handlers has one path, which needs no token", "[server][web]") {
  const Page page = embedded();
  const Handler inner{[](const Request&) { return std::optional<Response>(); }, [](const Request&) { return Response{.status = 418}; }};
  const Handler with = with_page(with_text(inner, "/NOTICE", body_of("what others wrote\n")), page);
  const Response r = *with.at_once(request("/NOTICE?x=1"));
  CHECK(r.status == 200);
  CHECK(r.content_type == "text/plain; charset=utf-8");
  CHECK(*r.body == "what others wrote\n");
  CHECK(with.handle(request("/NOTICE", false, r.etag)).status == 304);
  CHECK(with.is_open("/NOTICE"));
  CHECK(with.is_open("/"));
  for (const char* other : {"/NOTICE/", "/NOTICES", "/notice", "NOTICE", "/api/v1/grids"}) {
    INFO(other);
    CHECK_FALSE(with.at_once(request(other)));
    CHECK(with.handle(request(other)).status == 418);
    CHECK_FALSE(with.is_open(other));
  }
}

TEST_CASE("a page whose address names grids of other hosts, and its workers, may fetch from them; no other page may", "[server][web]") {
  static const std::string index = gzipped(kIndex), script = gzipped(kScript);
  static const EmbeddedFile files[] = {{"assets/main-Ab3_x.js", script}, {"assets/worker-Ab3_x.js", script}, {"index.html", index}};
  const Page page(files);
  const auto policy = [&](const std::string& target) { return std::string(page.answer(request(target))->more_fields); };
  for (const char* target : {"/", "/?other=1", "/assets/main-Ab3_x.js", "/assets/main-Ab3_x.js?grid=https://example.org/g.tcell"})
    CHECK_THAT(policy(target), Catch::Contains("connect-src 'self';"));
  for (const char* target : {"/?grid=https://example.org/g.tcell", "/assets/worker-Ab3_x.js"})
    CHECK_THAT(policy(target), Catch::Contains("connect-src 'self' https: http:;") && Catch::Contains("script-src 'self' 'wasm-unsafe-eval'"));
}

}  // namespace
}  // namespace teracell::server
