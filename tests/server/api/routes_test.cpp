// Requests made by hand, and answers compared with the cells.
#include "server/api/routes.hpp"

#include "store/check/check_json.hpp"
#include "tests/server/served.hpp"
#include "tests/support/png.hpp"

namespace teracell::server {
namespace {

using namespace testing;

TEST_CASE("What was found about a grid is answered when it is kept for this version, and may change", "[server]") {
  Served s;
  const std::string target = "/api/v1/grids/g/check";
  CHECK(s.get(target).status == 404);
  CHECK(s.error(target) == "nobody has looked through the cells of grid 'g' yet: `teracell check` does");
  const auto keep = [&](const std::string& hash, const std::string& sentence) {
    Findings findings;
    findings.hash = hash;
    findings.not_looked_at.push_back(sentence);
    std::ofstream(s.folder / "g.check.json") << findings_json(findings) << "\n";
    return findings_json(findings);
  };
  keep("0123", "");
  CHECK(s.get(target).status == 404);
  const std::string kept = keep(s.hash(), "one");
  const Response first = s.get(target);
  CHECK(first.status == 200);
  CHECK(*first.body == kept);
  CHECK(first.cache_control == "no-cache");
  const std::string later = keep(s.hash(), "two");
  const Response second = s.get(target);
  CHECK(*second.body == later);
  CHECK(second.etag != first.etag);
  CHECK(s.get(target + "?v=" + s.hash()).status == 400);
}

TEST_CASE("Raw tiles are the cells of every level, axis and place, whatever the ray axis", "[server]") {
  for (const int ray_axis : {0, 1, 2}) {
    Served s(ray_axis);
    const Metadata& meta = s.service->grids().find("g")->meta();
    for (int level = 0; level < meta.grid.levels(); ++level) {
      const auto sets = level_by_hand(meta.grid, s.cells, level);
      const Index3 n = meta.grid.cells(level);
      for (int axis = 0; axis < 3; ++axis) {
        const RayFrame f = RayFrame::along(axis);
        for (const int64_t index : {int64_t{0}, n[axis] / 2, n[axis] - 1})
          for (int64_t row = 0; row * 512 < n[f.v]; ++row)
            for (int64_t col = 0; col * 512 < n[f.u]; ++col) {
              const std::string target = fmt::format("/api/v1/grids/g/tile/{}/{}/{}/{}_{}", axis_name(axis), index, level, col, row);
              INFO(target);
              const Response labels = s.get(target + ".bin"), with_sets = s.get(target + ".bin?sets=1");
              REQUIRE(labels.status == 200);
              REQUIRE(with_sets.status == 200);
              const int64_t width = std::min<int64_t>(512, n[f.u] - col * 512), height = std::min<int64_t>(512, n[f.v] - row * 512);
              REQUIRE(labels.body->size() == static_cast<size_t>(width * height));
              // The table of sets, then one byte per cell: 5 materials have at most 31 sets.
              const std::string& b = *with_sets.body;
              const auto u16 = [&](size_t at) {
                return static_cast<unsigned>(static_cast<uint8_t>(b.at(at)) | static_cast<uint8_t>(b.at(at + 1)) << 8);
              };
              std::vector<Mask> table;
              size_t at = 4;
              for (unsigned i = u16(0); i > 0; --i) {
                Mask mask = 0;
                const unsigned members = u16(at);
                for (unsigned m = 0; m < members; ++m) mask |= Mask{1} << u16(at + 2 + 2 * m);
                at += 2 + 2 * members;
                table.push_back(mask);
              }
              REQUIRE(b.size() == at + static_cast<size_t>(width * height));
              bool same = true;
              for (int64_t v = 0; v < height; ++v)
                for (int64_t u = 0; u < width; ++u) {
                  Index3 cell;
                  cell[f.u] = col * 512 + u, cell[f.v] = row * 512 + v, cell[axis] = index;
                  const Mask set = sets[static_cast<size_t>((cell[2] * n[1] + cell[1]) * n[0] + cell[0])];
                  const auto place = static_cast<size_t>(v * width + u);
                  same &= static_cast<unsigned>((*labels.body)[place]) ==
                          63u - static_cast<unsigned>(__builtin_clzll(set));  // the last material is the strongest
                  same &= table.at(static_cast<uint8_t>(b[at + place])) == set;
                }
              REQUIRE(same);
            }
      }
    }
  }
}

TEST_CASE("Cells, columns and statistics are those of the grid", "[server]") {
  Served s;
  std::mt19937_64 random(3);
  for (int i = 0; i < 30; ++i) {
    const int x = random_int(random, 0, 36), y = random_int(random, 0, 529), z = random_int(random, 0, 20);
    const json cell = s.parsed(fmt::format("/api/v1/grids/g/cell?i={}&j={}&k={}", x, y, z));
    REQUIRE(cell["materials"].size() == 1);
    REQUIRE(cell["materials"][0]["id"] == s.at(x, y, z));
    REQUIRE(cell["centre"] == json({-1 + (x + 0.5) * 0.5, 2 + (y + 0.5) * 0.25, z + 0.5}));
    const json column = s.parsed(fmt::format("/api/v1/grids/g/column/y/{}_{}", x, z));
    bool found = false;
    for (const json& run : column["runs"])
      if (run["from"] <= y && run["to"] > y) found = run["material"] == s.at(x, y, z);
    REQUIRE(found);
  }
  const json stats = s.parsed("/api/v1/grids/g/stats?region=3,100,5,20,400,9");
  std::vector<uint64_t> counted(kMaterials);
  for (int z = 5; z < 9; ++z)
    for (int y = 100; y < 400; ++y)
      for (int x = 3; x < 20; ++x) ++counted[s.at(x, y, z)];
  for (uint32_t m = 0; m < kMaterials; ++m) REQUIRE(stats["materials"][m]["cells"] == counted[m]);
  REQUIRE(s.parsed("/api/v1/grids")["grids"][0]["id"] == "g");
  REQUIRE(s.parsed("/api/v1/grids/g")["grid"]["cells"] == json(kCells));
  const json coarse = s.parsed("/api/v1/grids/g/cell?i=0&j=0&k=0&level=10");
  REQUIRE(coarse["materials"].size() == kMaterials);
}

TEST_CASE("Values that are malformed or out of range get 400 with a message that names the range; what does not exist gets 404", "[server]") {
  Served s;
  const std::string g = "/api/v1/grids/g";
  for (const std::string& bad : std::initializer_list<std::string>{g + "/slice/w/0.png",
                                                                   g + "/slice/z/21.png",
                                                                   g + "/slice/z/-1.png",
                                                                   g + "/slice/z/x.png",
                                                                   g + "/slice/z/0.png?level=11",
                                                                   g + "/slice/z/0.png?level=",
                                                                   g + "/slice/z/0.png?region=0,0,38,1",
                                                                   g + "/slice/z/0.png?region=0,0,0,1",
                                                                   g + "/slice/z/0.png?region=1,2,3",
                                                                   g + "/slice/z/0.png?colour=1",
                                                                   g + "/slice/z/0.png?materials=5",
                                                                   g + "/slice/z/0.png?outline=2",
                                                                   g + "/tile/z/0/11/0_0.png",
                                                                   g + "/tile/z/21/0/0_0.png",
                                                                   g + "/tile/z/0/0/0.png",
                                                                   g + "/tile/z/0/0/a_b.png",
                                                                   g + "/cell?i=0&j=0",
                                                                   g + "/cell?i=0&j=0&k=21",
                                                                   g + "/column/z/37_0",
                                                                   g + "/column/z/0",
                                                                   g + "/stats?region=0,0,0,38,1,1",
                                                                   g + "/stats?region=1,1,1,1,2,2",
                                                                   g + "/diff",
                                                                   g + "/diff?with=g&with=g",
                                                                   g + "/diff?with=g&level=1",
                                                                   g + "/changed?with=g&from=a&to=b",
                                                                   g + "/changed?with=g&from=a&to=b&cell=0,0,21",
                                                                   g + "/view.bin?size=9,9&against=g&labels=1",
                                                                   "/%",
                                                                   g + "/stats?a%00=1"}) {
    INFO(bad);
    const Response r = s.get(bad);
    REQUIRE(r.status == 400);
    REQUIRE(json::parse(*r.body)["error"]["code"] == "bad_request");
  }
  for (const std::string& missing : std::initializer_list<std::string>{"/nothing",
                                                                       "/api",
                                                                       "/api/v2/grids",
                                                                       "/api/v1/grids/h",
                                                                       "/api/v1/grids/..",
                                                                       "/api/v1/grids/g.tcell",
                                                                       "/api/v1/grids/%2e%2e%2fg",
                                                                       g + "/tile/z/0/0/1_0.png",
                                                                       g + "/tile/z/0/0/0_2.png",
                                                                       g + "/tile/z/0/0/0_0.jpg",
                                                                       g + "/slice/z/0.jpg",
                                                                       g + "/diff?with=h",
                                                                       g + "/diff?with=..",
                                                                       g + "/diff?with=",
                                                                       g + "/changed?with=h&from=a&to=b&cell=0,0,0",
                                                                       g + "/view.bin?size=9,9&against=h",
                                                                       g + "/nothing",
                                                                       g + "/",
                                                                       g + "?v=0123",
                                                                       "/index.html"}) {
    INFO(missing);
    REQUIRE(s.get(missing).status == 404);
  }
  CHECK(s.error(g + "/slice/z/21.png") == "index: expected a whole number from 0 to 20, found '21'");
  for (const char* materials : {"steel", "1,5", "1,", "-1"})
    CHECK_THAT(s.error(g + "/slice/z/0.png?materials=" + materials), Catch::Contains("materials: expected ids from 0 to 4 separated by commas"));
  CHECK_THAT(s.error(g + "?v=0123"), Catch::Contains("v: the version of grid 'g' is " + s.hash() + ", found '0123'"));
}

TEST_CASE("Outlines are where neighbours differ, also across the edge of a tile", "[server]") {
  Served s(1);
  const std::string g = "/api/v1/grids/g/slice/x/7.png?outline=1&region=";
  const auto pixels = [&](const std::string& region) { return png_of(*s.get(g + region).body); };
  const Png whole = pixels("0,0,530,21"), part = pixels("100,3,140,9");
  const Rgba dark = {24, 24, 24, 255};
  int64_t wrong = 0;
  for (int64_t z = 0; z < 21; ++z)
    for (int64_t y = 0; y < 530; ++y) {
      const bool differs = (y < 529 && s.at(7, y + 1, z) != s.at(7, y, z)) || (z < 20 && s.at(7, y, z + 1) != s.at(7, y, z));
      const Rgba pixel = whole.pixels[static_cast<size_t>((20 - z) * 530 + y)];
      wrong += (pixel == dark) != differs;
      if (z >= 3 && z < 9 && y >= 100 && y < 140) wrong += part.pixels[static_cast<size_t>((8 - z) * 40 + y - 100)] != pixel;
    }
  CHECK(wrong == 0);
}

TEST_CASE("Pictures of too many pixels are refused before anything is made", "[server]") {
  Served s(2, {.max_pixels = 10000});
  CHECK(s.get("/api/v1/grids/g/slice/z/0.png").status == 400);
  CHECK(s.get("/api/v1/grids/g/slice/z/0.png?region=0,0,37,270").status == 200);
  CHECK(s.get("/api/v1/grids/g/slice/z/0.png?level=1").status == 200);
}

TEST_CASE("A part of a column is asked for with from and to", "[server]") {
  const TempFolder folder;
  constexpr int64_t kLong = 80'000;
  const Metadata meta = metadata_of(unit_grid({1, 1, kLong}), 2, 2);
  std::vector<Label> cells(kLong);
  for (size_t i = 0; i < cells.size(); ++i) cells[i] = i % 2;
  store_cells(folder / "g.tcell", meta, cells);
  Service service({.named = {folder.path()}});
  const auto get = [&](const std::string& query) { return handle(service, {.target = "/api/v1/grids/g/column/z/0_0" + query}); };
  const json part = json::parse(*get("?from=12345&to=12347").body);
  CHECK(part["runs"] == json::array({{{"from", 12345}, {"to", 12346}, {"min", 12345.0}, {"max", 12346.0}, {"material", 1}, {"name", "m1"}},
                                     {{"from", 12346}, {"to", 12347}, {"min", 12346.0}, {"max", 12347.0}, {"material", 0}, {"name", "m0"}}}));
  CHECK(json::parse(*get("?from=79999").body)["runs"].size() == 1);
  for (const char* bad : {"?from=80000", "?from=-1", "?from=5&to=5", "?to=0", "?to=80001", "?from=x", "?from=1&from=2"})
    CHECK(get(bad).status == 400);
}

TEST_CASE("JSON is ASCII, whatever the names", "[server]") {
  Served s;
  s.rename("\xc3\xbcn\xff.tcell");
  const Response list = s.get("/api/v1/grids");
  REQUIRE(list.status == 200);
  CHECK(std::ranges::all_of(*list.body, [](char c) { return static_cast<unsigned char>(c) < 0x80; }));
  CHECK(json::parse(*list.body)["grids"][0]["id"] == "\xc3\xbcn\xef\xbf\xbd");
}

TEST_CASE("The list of grids tells other programs where they find each, whatever its name", "[server]") {
  Served s;
  s.rename("a b%.tcell");
  CHECK(s.parsed("/api/v1/grids")["grids"][0]["protocols"] == json({{{"title", "Zarr 3, OME-Zarr"}, {"path", "/zarr/a%20b%25"}},
                                                                    {{"title", "Zarr 2"}, {"path", "/zarr2/a%20b%25"}},
                                                                    {{"title", "xarray"}, {"path", "/xarray/a%20b%25/0"}},
                                                                    {{"title", "Neuroglancer"}, {"path", "/precomputed/a%20b%25"}},
                                                                    {{"title", "Deep Zoom"}, {"path", "/dzi/a%20b%25/z/10.dzi"}},
                                                                    {{"title", "IIIF"}, {"path", "/iiif/a%20b%25-z-10/info.json"}}}));
}

TEST_CASE("Files that can't be read are listed beside the grids and on the plain start page", "[server]") {
  Served s;
  std::ofstream(s.folder / "a<b>.tcell") << "nothing of a grid";
  s.service->grids().look();
  const json list = s.parsed("/api/v1/grids");
  CHECK(list["grids"].size() == 1);
  REQUIRE(list["unreadable"].size() == 1);
  CHECK(list["unreadable"][0] == json({{"id", "a<b>"}, {"error", s.error("/api/v1/grids/a%3Cb%3E")}}));
  CHECK_THAT(*s.get("/").body, Catch::Contains("<h2>a&lt;b&gt;</h2><p>This file can't be read: a&lt;b&gt;.tcell: "));
}

TEST_CASE("A line that begins and ends far outside passes the cells of its part in the grid, and one from too far is refused", "[server]") {
  Served s;
  const auto materials = [&](const char* ends) {
    std::vector<std::pair<uint32_t, uint32_t>> out;
    const json answer = s.parsed(std::string("/api/v1/grids/g/line?") + ends);
    for (const json& run : answer["runs"]) out.emplace_back(run["material"], run["cells"]);
    return out;
  };
  const auto inside = materials("from=3.1,2,5.5&to=3.1,134.5,5.5");
  REQUIRE(inside.size() > 5);
  CHECK(materials("from=3.1,-1e8,5.5&to=3.1,1e8,5.5") == inside);
  for (const char* far : {"1e9", "1e18", "1e75", "1e308"})
    CHECK(s.error(std::string("/api/v1/grids/g/line?from=0,0,0&to=") + far + ",0,0").starts_with("to: expected three numbers up to 1.345e+08"));
}

TEST_CASE("Statistics and pictures of whole slices are dear, however their addresses are written", "[server]") {
  const Served s;
  const Handler handler = handler_of(*s.service);
  const auto cost_of = [&](const char* target) { return handler.cost_of(Request{.target = target}); };
  for (const char* dear : {"/api/v1/grids/g/stats", "/api/v1/grids/g/%73tats?region=0,0,0,1,1,1", "/%61pi/v1/grids/g/slice/z/0.png",
                           "/api/v1/grids/g/diff?with=h", "/api/v1/grids/g/view.png?size=9,9", "/api/v1/grids/g/view.bin?size=2896,2896",
                           "/api/v1/grids/g/view.bin?window=-9000000000000000000,-9000000000000000000,9000000000000000000,9000000000000000000",
                           "/api/v1/grids/g/view.bin", "/%69iif/g-z-0/info.json", "/dzi/g/z/0.dzi"})
    CHECK(cost_of(dear) == Cost::kDear);
  for (const char* cheap : {"/", "/api/v1/grids", "/api/v1/grids/stats", "/api/v1/grids/g/tile/z/0/0/0_0.png", "/zarr/g/0/c/0/0/0", "/%", "/api/%"})
    CHECK(cost_of(cheap) == Cost::kCheap);
  for (const char* seen :
       {"/api/v1/grids/g/column/z/0_0", "/api/v1/grids/g/line?from=0,0,0&to=1,1,1", "/api/v1/grids/g/view.bin?quick=1&size=337,237",
        "/api/v1/grids/g/view.bin?size=2896,2896&window=0,0,384,384", "/api/v1/grids/g/view.json?pixel=1,1"})
    CHECK(cost_of(seen) == Cost::kSeen);
}

TEST_CASE("The start page names the grids and escapes what is in their names", "[server]") {
  Served s;
  s.rename("<script>alert('x')&\".tcell");
  const Response page = s.get("/");
  REQUIRE(page.status == 200);
  CHECK(page.content_type == "text/html; charset=utf-8");
  CHECK(page.body->find("<script>") == std::string::npos);
  CHECK(page.body->find("&lt;script&gt;") != std::string::npos);
}

TEST_CASE("Whatever the address, the answer has one of the expected statuses and a body", "[server]") {
  Served s;
  std::mt19937_64 random(11);
  const std::vector<std::string> words = {"api",
                                          "v1",
                                          "grids",
                                          "g",
                                          "tile",
                                          "slice",
                                          "cell",
                                          "column",
                                          "stats",
                                          "z",
                                          "0",
                                          "1",
                                          "-1",
                                          "99999999999999999999",
                                          "0_0.png",
                                          "0_0.bin",
                                          "0.png",
                                          "..",
                                          "",
                                          "%00",
                                          "zarr",
                                          "zarr2",
                                          "xarray",
                                          "precomputed",
                                          "dzi",
                                          "iiif",
                                          "zarr.json",
                                          ".zarray",
                                          "info",
                                          "c",
                                          "0.dzi",
                                          "g-z-0",
                                          "full",
                                          "max",
                                          "s0",
                                          "0-64_0-64_0-1",
                                          "?level=1",
                                          "?v=x",
                                          "&i=1",
                                          "diff?with=g",
                                          "diff?with=%00"};
  for (int i = 0; i < 5000; ++i) {
    std::string target;
    for (auto n = random() % 8; n > 0; --n) target += "/" + words[random() % words.size()];
    const Response r = s.get(target);
    INFO(target);
    REQUIRE((r.status == 200 || r.status == 302 || r.status == 303 || r.status == 400 || r.status == 404));
    REQUIRE(r.body);
  }
  CHECK(s.service->counters().damaged == 0);
}

}  // namespace
}  // namespace teracell::server
