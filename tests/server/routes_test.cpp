// Requests made by hand, and answers compared with the cells.
#include "server/routes.hpp"

#include <fstream>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/meshed.hpp"
#include "tests/support/png.hpp"
#include "tests/support/served_cells.hpp"
#include "tests/support/small_files.hpp"
#include "tests/support/stored.hpp"

namespace teracell {
namespace {

using namespace testing;
using nlohmann::json;

const Index3 kCells = {37, 530, 21};
constexpr uint32_t kMaterials = 5;

Grid grid() {
  return {{Axis::uniform(-1, 0.5, 0, kCells[0], 0.5), Axis::uniform(2, 0.25, 0, kCells[1], 0.5), Axis::uniform(0, 1, 0, kCells[2], 0.5)}};
}

// A service over one grid "g" of random cells.
struct Served {
  TempFolder folder;
  std::vector<Label> cells;
  std::filesystem::path path = folder / "g.tcell";
  std::unique_ptr<Service> service;

  explicit Served(int ray_axis = 2, ServiceOptions options = {}) {
    std::mt19937_64 random(7);
    cells = random_cells(random, kCells, kMaterials);
    store_cells(path, metadata_of(grid(), ray_axis, kMaterials), cells);
    options.named = {folder.path()};
    service = std::make_unique<Service>(options);
  }
  Label at(int64_t x, int64_t y, int64_t z) const { return cells[static_cast<size_t>((z * kCells[1] + y) * kCells[0] + x)]; }
  Response get(const std::string& target) {
    Request r;
    r.target = target;
    return handle(*service, r);
  }
  json parsed(const std::string& target) {
    const Response r = get(target);
    INFO(target << ": " << (r.body ? *r.body : ""));
    REQUIRE(r.status == 200);
    REQUIRE(r.content_type == "application/json");
    return json::parse(*r.body);
  }
  std::string error(const std::string& target) { return json::parse(*get(target).body)["error"]["message"]; }
  std::string hash() { return service->grids().find("g")->hash; }
  void rename(const std::string& file) {
    std::filesystem::rename(path, folder / file);
    service->grids().look();
  }
};

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
                                                                   "/%",
                                                                   g + "/stats?a%00=1"}) {
    INFO(bad);
    const Response r = s.get(bad);
    REQUIRE(r.status == 400);
    REQUIRE(json::parse(*r.body)["error"]["code"] == "bad_request");
  }
  for (const std::string& missing :
       std::initializer_list<std::string>{"/nothing", "/api", "/api/v2/grids", "/api/v1/grids/h", "/api/v1/grids/..", "/api/v1/grids/g.tcell",
                                          "/api/v1/grids/%2e%2e%2fg", g + "/tile/z/0/0/1_0.png", g + "/tile/z/0/0/0_2.png", g + "/tile/z/0/0/0_0.jpg",
                                          g + "/slice/z/0.jpg", g + "/nothing", g + "/", g + "?v=0123", "/index.html"}) {
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
  ServiceOptions options;
  options.max_pixels = 10000;
  Served s(2, options);
  CHECK(s.get("/api/v1/grids/g/slice/z/0.png").status == 400);
  CHECK(s.get("/api/v1/grids/g/slice/z/0.png?region=0,0,37,270").status == 200);
  CHECK(s.get("/api/v1/grids/g/slice/z/0.png?level=1").status == 200);
}

TEST_CASE("ETags come from the grid's content; an answer to an address with a version may be cached for ever", "[server]") {
  Served s;
  const std::string tile = "/api/v1/grids/g/tile/z/0/0/0_0.png";
  const Response first = s.get(tile), versioned = s.get(tile + "?v=" + s.hash());
  CHECK(first.cache_control == "no-cache");
  CHECK(versioned.cache_control == "public, max-age=31536000, immutable");
  CHECK(first.etag == versioned.etag);
  CHECK(first.etag.front() == '"');
  Request again;
  again.target = tile;
  for (const std::string& match : {first.etag, "\"x\", " + first.etag, "W/" + first.etag, std::string("*")}) {
    again.if_none_match = match;
    const Response r = handle(*s.service, again);
    CHECK(r.status == 304);
    CHECK(r.etag == first.etag);
  }
  again.if_none_match = "\"other\"";
  CHECK(handle(*s.service, again).status == 200);
  Request json_request;
  json_request.target = "/api/v1/grids/g";
  const Response raw = handle(*s.service, json_request);
  json_request.accepts_gzip = true;
  const Response gzipped = handle(*s.service, json_request);
  CHECK(gzipped.content_encoding == "gzip");
  CHECK(raw.content_encoding.empty());
  CHECK(gzipped.etag != raw.etag);  // the ETag is strong: other bytes need another one
}

TEST_CASE("The handler of a service answers at once what the cache has", "[server]") {
  Served s;
  const Handler handler = handler_of(*s.service);
  const Request request{.target = "/api/v1/grids/g/tile/z/3/0/0_0.bin"};
  CHECK_FALSE(handler.at_once(request));
  const Response made = handler.handle(request);
  CHECK(made.status == 200);
  CHECK(handler.at_once(request)->body == made.body);
  CHECK(handler.handle({.target = "/nowhere"}).status == 404);
  CHECK_FALSE(handler.is_open);
}

TEST_CASE("A repeated request is answered at once, until the file is replaced", "[server]") {
  Served s;
  Request request;
  request.target = "/api/v1/grids/g/tile/z/3/0/0_0.bin";
  CHECK_FALSE(handle_at_once(*s.service, request));
  const Response made = handle(*s.service, request);
  const auto again = handle_at_once(*s.service, request);
  REQUIRE(again);
  CHECK(again->body == made.body);
  store_cells(s.path, metadata_of(grid(), 2, kMaterials), std::vector<Label>(s.cells.size(), 1));
  s.service->grids().look();
  CHECK_FALSE(handle_at_once(*s.service, request));
  const Response fresh = handle(*s.service, request);
  CHECK(fresh.etag != made.etag);
  CHECK(fresh.body->find_first_not_of('\1') == std::string::npos);
}

TEST_CASE("Answers that need a damaged chunk are 500; each is counted, there is one complaint, and other answers are unaffected", "[server]") {
  Served s;
  std::vector<std::string> complaints;
  ServiceOptions options;
  options.named = {s.path};
  options.complain = [&](const std::string& message) { complaints.push_back(message); };
  const auto entry = s.service->grids().find("g")->reader().entry({0, 0, 0, 0});
  REQUIRE(entry->size > 0);
  std::fstream file(s.path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(entry->offset + entry->size / 2));
  file.put('\x55').put('\xaa').put('\x55');
  file.close();
  Service service(options);
  const auto status = [&](const std::string& target) {
    Request r;
    r.target = target;
    return handle(service, r).status;
  };
  for (int i = 0; i < 3; ++i) CHECK(status("/api/v1/grids/g/tile/z/0/0/0_0.png") == 500);
  CHECK(status("/api/v1/grids/g/tile/z/0/0/0_1.png") == 200);
  CHECK(status("/api/v1/grids/g/stats") == 200);
  CHECK(service.counters().damaged == 3);
  REQUIRE(complaints.size() == 1);
  CHECK_THAT(complaints[0], Catch::StartsWith("g.tcell: level 0 chunk (0, 0, 0): its frame at byte "));  // the place is named once, without a folder
}

// What a service answers for a file.
Response answer_of(const Bytes& file, const std::string& target) {
  const TempFolder folder;
  std::ofstream(folder / "g.tcell", std::ios::binary).write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
  Service service({.named = {folder.path()}});
  Request request;
  request.target = target;
  return handle(service, request);
}

TEST_CASE("The description of a grid is answered if and only if verify passes its report", "[server]") {
  const Bytes file = chunked_file();
  size_t sound = 0;
  for (const std::string& report :
       {std::string("{}"), std::string(R"({"schema":1,"bodies":[{"name":"t\u00fcr\ud83d\ude00"}]} )"), std::string("null"),
        std::string("[1,2.50,1e2]"), std::string(64, '[') + std::string(64, ']'), std::string(""), std::string("{"), std::string("{\"a\":1,\"a\":1}"),
        std::string("{\"a\":\"\xc3\xbc\"}"), std::string("{\"a\":\"\xff\"}"), std::string("{\"a\":01}"), std::string("{\"a\":1e999}"),
        std::string("\"\\ud800\""), std::string(65, '['), std::string(65, '[') + std::string(65, ']')}) {
    INFO(report);
    const Bytes forged = forge(file, {.bytes = [&](Part part, Bytes& body) {
                                 if (part == Part::kReport) body.assign(report.begin(), report.end());
                               }});
    bool passes = true;
    try {
      verify_quietly(reader_of(forged));
    } catch (const FormatError&) {
      passes = false;
    }
    sound += passes;
    const Response answer = answer_of(forged, "/api/v1/grids/g");
    REQUIRE(answer.status == (passes ? 200 : 500));
    const json j = json::parse(*answer.body);
    if (passes) CHECK(j["report"] == json::parse(report));
    else CHECK(j["error"]["code"] == "damaged");
  }
  CHECK(sound == 5);
}

TEST_CASE("A file that verify passes serves all of its answers, however strange its names are", "[server]") {
  std::string umlauts;
  for (int i = 0; i < 128; ++i) umlauts += "\xc3\xbc";
  const Bytes file = forge(chunked_file(), {.metadata = [&](Metadata& m) {
                             m.units = std::string(128, '"') + std::string(128, '\n');
                             m.materials[0].name = std::string(256, '\0');
                             m.materials[1].name = umlauts;
                             m.materials[2].name = "";
                             m.labels[1].body = "</script>";
                           }});
  REQUIRE_NOTHROW(verify_quietly(reader_of(file)));
  const std::string g = "/api/v1/grids/g";
  for (const std::string& target :
       {std::string("/api/v1/grids"), g, g + "/cell?i=1&j=1&k=1", g + "/cell?i=0&j=0&k=0&level=3", g + "/column/x/1_1", g + "/column/y/1_1",
        g + "/column/z/1_1?from=1&to=3", g + "/stats", g + "/stats?region=0,0,0,1,2,3", std::string("/zarr/g/zarr.json"),
        std::string("/zarr/g/labels/material/zarr.json"), std::string("/zarr2/g/.zmetadata"), std::string("/xarray/g/0/.zmetadata"),
        std::string("/precomputed/g/info"), std::string("/precomputed/g/segprops/info")}) {
    INFO(target);
    const Response answer = answer_of(file, target);
    REQUIRE(answer.status == 200);
    CHECK(json::accept(*answer.body));
  }
  for (const std::string& target : {g + "/slice/z/0.png", g + "/tile/z/0/0/0_0.png", g + "/tile/x/0/1/0_0.bin?sets=1", std::string("/")})
    CHECK(answer_of(file, target).status == 200);
}

TEST_CASE("A part of a column is asked for with from and to; a column of too many runs is refused with that advice", "[server]") {
  const TempFolder folder;
  std::string name;  // 6 characters of JSON for each 2 bytes
  for (int i = 0; i < 128; ++i) name += "\xc3\xbc";
  constexpr int64_t kLong = 80'000;
  const auto axis = [](int64_t n) { return Axis::uniform(0, 1, 0, n, 0.5); };
  Metadata meta = metadata_of({{axis(1), axis(1), axis(kLong)}}, 2, 2);
  meta.materials[1].name = name;
  std::vector<Label> cells(kLong);
  for (size_t i = 0; i < cells.size(); ++i) cells[i] = i % 2;
  store_cells(folder / "g.tcell", meta, cells);
  Service service({.named = {folder.path()}});
  const auto get = [&](const std::string& query) {
    Request request;
    request.target = "/api/v1/grids/g/column/z/0_0" + query;
    return handle(service, request);
  };
  const Response whole = get("");
  CHECK(whole.status == 400);
  CHECK_THAT(*whole.body, Catch::Contains("has more than 72") && Catch::Contains("runs from cell 0 to 80000: ask for a shorter part (from, to)"));
  CHECK(get("?from=0&to=80000").status == 400);
  const Response most = get("?to=70000");
  REQUIRE(most.status == 200);
  CHECK(most.body->size() < size_t{1} << 26);
  CHECK(json::parse(*most.body)["runs"].size() == 70'000);
  const json part = json::parse(*get("?from=12345&to=12347").body);
  CHECK(part["runs"] == json::array({{{"from", 12345}, {"to", 12346}, {"min", 12345.0}, {"max", 12346.0}, {"material", 1}, {"name", name}},
                                     {{"from", 12346}, {"to", 12347}, {"min", 12346.0}, {"max", 12347.0}, {"material", 0}, {"name", "m0"}}}));
  CHECK(json::parse(*get("?from=79999").body)["runs"].size() == 1);
  for (const char* bad : {"?from=80000", "?from=-1", "?from=5&to=5", "?to=0", "?to=80001", "?from=x", "?from=1&from=2"})
    CHECK(get(bad).status == 400);
}

TEST_CASE("A client that accepts gzip gets it, whatever other clients asked for before, and the cache keeps it", "[server]") {
  Served s;
  Request request;
  request.target = "/api/v1/grids/g/tile/z/3/0/0_0.bin";
  const Response plain = handle(*s.service, request);
  CHECK(plain.content_encoding.empty());
  request.accepts_gzip = true;
  CHECK_FALSE(handle_at_once(*s.service, request));
  const Response gzip = handle(*s.service, request);
  CHECK(gzip.content_encoding == "gzip");
  CHECK(gzip.body->size() < plain.body->size());
  REQUIRE(handle_at_once(*s.service, request));
  CHECK(handle_at_once(*s.service, request)->body == gzip.body);
  request.if_none_match = gzip.etag;
  CHECK(handle_at_once(*s.service, request)->status == 304);
}

TEST_CASE("With a token, proxies may not keep answers for others", "[server]") {
  ServiceOptions options;
  options.anybody = false;
  Served s(2, options);
  CHECK(s.get("/api/v1/grids/g/tile/z/0/0/0_0.png?v=" + s.hash()).cache_control == "private, max-age=31536000, immutable");
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

TEST_CASE("The caches stay within their limit", "[server]") {
  ServiceOptions options;
  options.cache_bytes = 200000;
  Served s(1, options);
  for (int z = 0; z < 21; ++z)
    for (const char* kind : {"png", "bin"}) REQUIRE(s.get(fmt::format("/api/v1/grids/g/tile/z/{}/0/0_0.{}", z, kind)).status == 200);
  CHECK(s.service->chunks().counts().bytes <= 200000);
  CHECK(s.service->answers().counts().bytes <= 25000);
  CHECK(s.service->chunks().counts().hits > 0);
}

TEST_CASE("The pages of all grids share the cache", "[server]") {
  ServiceOptions options;
  options.cache_bytes = 128000;
  Served s(1, options);
  for (int i = 0; i < 40; ++i) std::filesystem::copy_file(s.path, s.folder / ("copy" + std::to_string(i) + ".tcell"));
  s.service->grids().look();
  for (int i = 0; i < 40; ++i) REQUIRE(s.get("/api/v1/grids/copy" + std::to_string(i) + "/stats").status == 200);
  const CacheCounts index = s.service->index().counts(), chunks = s.service->chunks().counts();
  CHECK(index.limit + chunks.limit == 128000);
  CHECK(index.bytes > index.limit / 2);
  CHECK(index.bytes <= index.limit);
}

TEST_CASE("Neither a look before prefetching nor waiting for an answer counts as a hit", "[server]") {
  Served s;
  Request request;
  request.target = "/api/v1/grids/g/tile/z/3/0/0_0.bin";
  CHECK_FALSE(s.service->is_cached(request));
  handle(*s.service, request);
  CHECK(s.service->is_cached(request));
  CHECK(s.service->answers().counts().hits == 0);
  CHECK(s.service->answers().counts().misses == 1);
  request.accepts_gzip = true;
  CHECK_FALSE(s.service->is_cached(request));  // it would get another answer
  CHECK_FALSE(handle_at_once(*s.service, request));
  CHECK(s.service->answers().counts().hits == 0);
  request.accepts_gzip = false;
  CHECK(handle_at_once(*s.service, request));
  CHECK(s.service->answers().counts().hits == 1);
}

// ---- the description is compared with the answers

// Whether a value has the shape that a schema of openapi.json gives it.
std::string mismatch(const json& schema, const json& value, const json& all, const std::string& where) {
  if (schema.contains("$ref")) return mismatch(all["components"]["schemas"][schema["$ref"].get<std::string>().substr(21)], value, all, where);
  if (!schema.contains("type")) return "";
  const auto is = [&](const std::string& type) {
    return (type == "object" && value.is_object()) || (type == "array" && value.is_array()) || (type == "string" && value.is_string()) ||
           (type == "number" && value.is_number()) || (type == "integer" && value.is_number_integer()) || (type == "boolean" && value.is_boolean()) ||
           (type == "null" && value.is_null());
  };
  bool good = false;
  for (const json& type : schema["type"].is_array() ? schema["type"] : json::array({schema["type"]})) good |= is(type);
  if (!good) return where + " is no " + schema["type"].dump();
  if (value.is_object())
    for (const json& key : schema.value("required", json::array())) {
      if (!value.contains(key)) return where + " has no " + key.get<std::string>();
      if (const auto wrong =
              mismatch(schema["properties"][key.get<std::string>()], value[key.get<std::string>()], all, where + "." + key.get<std::string>());
          !wrong.empty())
        return wrong;
    }
  if (value.is_array()) {
    if (value.size() < schema.value("minItems", size_t{0}) || value.size() > schema.value("maxItems", ~size_t{0}))
      return where + " has " + std::to_string(value.size()) + " items";
    for (const json& item : value)
      if (const auto wrong = mismatch(schema.value("items", json::object()), item, all, where + "[]"); !wrong.empty()) return wrong;
  }
  return "";
}

TEST_CASE("Statistics, columns and pictures of whole slices are dear, however their addresses are written", "[server]") {
  const Served s;
  const Handler handler = handler_of(*s.service);
  const auto is_dear = [&](const char* target) { return handler.is_dear(Request{.target = target}); };
  for (const char* dear : {"/api/v1/grids/g/stats", "/api/v1/grids/g/%73tats?region=0,0,0,1,1,1", "/%61pi/v1/grids/g/slice/z/0.png",
                           "/api/v1/grids/g/column/z/0_0", "/%69iif/g-z-0/info.json", "/dzi/g/z/0.dzi"})
    CHECK(is_dear(dear));
  for (const char* cheap : {"/", "/api/v1/grids", "/api/v1/grids/stats", "/api/v1/grids/g/tile/z/0/0/0_0.png", "/zarr/g/0/c/0/0/0", "/%", "/api/%"})
    CHECK_FALSE(is_dear(cheap));
}

TEST_CASE("Every address of the description answers as the description says", "[server]") {
  Served s;
  std::ofstream(s.folder / "bad.tcell") << "nothing of a grid";
  s.service->grids().look();
  const json api = s.parsed("/openapi.json");
  CHECK(api["openapi"] == "3.1.0");
  const std::map<std::string, std::string> values = {{"id", "g"}, {"axis", "z"}, {"index", "4"}, {"level", "1"}, {"col", "0"}, {"row", "0"},
                                                     {"a", "3"},  {"b", "4"},    {"i", "1"},     {"j", "2"},     {"k", "3"}};
  int seen = 0;
  for (const auto& [path, operations] : api["paths"].items()) {
    const json& responses = operations["get"]["responses"];
    CHECK(responses.contains("405"));
    CHECK(responses.contains("401") == (path != "/healthz" && path != "/NOTICE"));
    const bool of_routes = path != "/healthz" && path != "/metrics" && path != "/NOTICE";  // other handlers answer these
    CHECK(responses.contains("503") == of_routes);
    if (!of_routes) continue;
    INFO(path);
    std::string target = path, query;
    for (const json& p : operations["get"]["parameters"]) {
      const std::string name = p["name"];
      if (p["in"] == "path") {
        REQUIRE(p["required"] == true);
        const std::string place = "{" + name + "}";
        REQUIRE(target.find(place) != std::string::npos);
        target.replace(target.find(place), place.size(), values.at(name));
      } else if (p["required"] == true) {
        query += (query.empty() ? "?" : "&") + name + "=" + values.at(name);
      }
    }
    REQUIRE(target.find('{') == std::string::npos);
    const Response r = s.get(target + query);
    REQUIRE(r.status == 200);
    const json& content = operations["get"]["responses"]["200"]["content"];
    REQUIRE(content.size() == 1);
    REQUIRE(r.content_type == content.begin().key());
    if (content.begin().value().contains("schema")) {
      const std::string wrong = mismatch(content.begin().value()["schema"], json::parse(*r.body), api, path);
      INFO(wrong);
      REQUIRE(wrong.empty());
    }
    const Response error = s.get(target + query + (query.empty() ? "?" : "&") + "no_such_parameter=1");
    if (path != "/openapi.json") {
      REQUIRE(error.status == 400);
      REQUIRE(mismatch(operations["get"]["responses"]["400"]["content"]["application/json"]["schema"], json::parse(*error.body), api, path).empty());
    }
    ++seen;
  }
  CHECK(seen >= 9);
  CHECK(api["paths"].contains("/NOTICE"));
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
  const std::vector<std::string> words = {"api",           "v1",       "grids",       "g",     "tile", "slice",     "cell",
                                          "column",        "stats",    "z",           "0",     "1",    "-1",        "99999999999999999999",
                                          "0_0.png",       "0_0.bin",  "0.png",       "..",    "",     "%00",       "zarr",
                                          "zarr2",         "xarray",   "precomputed", "dzi",   "iiif", "zarr.json", ".zarray",
                                          "info",          "c",        "0.dzi",       "g-z-0", "full", "max",       "s0",
                                          "0-64_0-64_0-1", "?level=1", "?v=x",        "&i=1"};
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
}  // namespace teracell
