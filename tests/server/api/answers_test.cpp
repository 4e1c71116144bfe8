// Which bytes an answer has, how long it is kept, and what damage does to it.
#include "tests/server/served.hpp"
#include "tests/support/served_cells.hpp"
#include "tests/support/small_files.hpp"

namespace teracell::server {
namespace {

using namespace testing;

TEST_CASE("ETags come from the grid's content; an answer to an address with a version may be cached for ever", "[server]") {
  Served s;
  const std::string tile = "/api/v1/grids/g/tile/z/0/0/0_0.png";
  const Response first = s.get(tile), versioned = s.get(tile + "?v=" + s.hash());
  CHECK(first.cache_control == "no-cache");
  CHECK(versioned.cache_control == "public, max-age=31536000, immutable");
  CHECK(first.etag == versioned.etag);
  CHECK(first.etag.front() == '"');
  Request again{.target = tile};
  for (const std::string& match : {first.etag, "\"x\", " + first.etag, "W/" + first.etag, std::string("*")}) {
    again.if_none_match = match;
    const Response r = handle(*s.service, again);
    CHECK(r.status == 304);
    CHECK(r.etag == first.etag);
  }
  again.if_none_match = "\"other\"";
  CHECK(handle(*s.service, again).status == 200);
  Request json_request{.target = "/api/v1/grids/g"};
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
  const Request request{.target = "/api/v1/grids/g/tile/z/3/0/0_0.bin"};
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
  const auto entry = s.service->grids().find("g")->reader().entry({0, 0, 0, 0});
  REQUIRE(entry->size > 0);
  damage(s.path, entry->offset + entry->size / 2);
  Service service({.named = {s.path}, .complain = [&](const std::string& message) { complaints.push_back(message); }});
  const auto status = [&](const std::string& target) { return handle(service, {.target = target}).status; };
  for (int i = 0; i < 3; ++i) CHECK(status("/api/v1/grids/g/tile/z/0/0/0_0.png") == 500);
  CHECK(status("/api/v1/grids/g/tile/z/0/0/0_1.png") == 200);
  CHECK(status("/api/v1/grids/g/stats") == 200);
  CHECK(service.counters().damaged == 3);
  REQUIRE(complaints.size() == 1);
  CHECK(json::parse(*handle(service, {.target = "/api/v1/grids"}).body)["grids"][0]["damage"] == complaints[0]);
  CHECK_THAT(complaints[0], Catch::StartsWith("g.tcell: level 0 chunk (0, 0, 0), cells x 0 to ") &&
                                Catch::Contains(": its frame at byte "));  // the place is named once, without a folder
}

// The set of each cell of a tile with sets.
std::vector<std::vector<uint16_t>> sets_of_cells(const std::string& tile, size_t cells) {
  size_t at = 0;
  const auto next = [&] {
    at += 2;
    return static_cast<uint16_t>(static_cast<uint8_t>(tile[at - 2]) | static_cast<uint8_t>(tile[at - 1]) << 8);
  };
  std::vector<std::vector<uint16_t>> sets(next()), out;
  next();  // flags
  for (auto& set : sets) {
    set.resize(next());
    for (uint16_t& member : set) member = next();
  }
  for (size_t i = 0; i < cells; ++i) out.push_back(sets[static_cast<uint8_t>(tile[at + i])]);
  REQUIRE(at + cells == tile.size());
  return out;
}

TEST_CASE("Of a damaged tile all is there but what can't be read, which has a set without members", "[server]") {
  for (int n = 0; n < 6; ++n) {
    const int ray_axis = n % 3, level = n / 3;  // level 1 is derived
    Served s(ray_axis);
    const RayFrame rays = RayFrame::along(ray_axis);
    const Metadata& meta = s.service->grids().find("g")->meta();
    const auto entry = s.service->grids().find("g")->reader().entry({0, 0, 0, 0});
    const LevelShape shape(meta, 0);
    REQUIRE(entry->size > 0);
    REQUIRE(!s.service->grids().find("g")->reader().stored(1));
    std::map<std::string, std::string> sound;
    const auto targets = [&](int axis) { return fmt::format("/api/v1/grids/g/tile/{}/0/{}/0_0.bin?sets=1", axis_name(axis), level); };
    for (int axis = 0; axis < 3; ++axis) sound[targets(axis)] = *s.get(targets(axis)).body;
    damage(s.path, entry->offset + entry->size / 2);
    Service service({.named = {s.path}});
    for (int axis = 0; axis < 3; ++axis) {
      const RayFrame slice = RayFrame::along(axis);
      const Index3 size = meta.grid.cells(level);
      const auto width = static_cast<size_t>(std::min<int64_t>(size[slice.u], 512)),
                 cells = width * static_cast<size_t>(std::min<int64_t>(size[slice.v], 512));
      CHECK(handle(service, {.target = targets(axis)}).status == 500);
      const Response rest = handle(service, {.target = targets(axis) + "&damage=1"});
      REQUIRE(rest.status == 200);
      const auto found = sets_of_cells(*rest.body, cells), expected = sets_of_cells(sound[targets(axis)], cells);
      size_t lost = 0, wrong = 0;
      for (size_t i = 0; i < cells; ++i) {
        Index3 cell;
        cell[axis] = 0, cell[slice.u] = static_cast<int64_t>(i % width), cell[slice.v] = static_cast<int64_t>(i / width);
        const bool is_lost =
            cell[rays.u] << level < shape.chunk_rays && cell[rays.v] << level < shape.chunk_rays && cell[rays.w] << level < shape.chunk_cells;
        lost += is_lost;
        wrong += is_lost ? !found[i].empty() : found[i] != expected[i];
      }
      CHECK(lost > 0);
      CHECK(wrong == 0);
    }
    CHECK(handle(service, {.target = targets(0) + "&damage=1&shares=1"}).status == 400);
    CHECK(handle(service, {.target = "/api/v1/grids/g/tile/z/0/0/0_0.bin?damage=1"}).status == 400);
  }
}

TEST_CASE("A grid that was replaced or removed while its file was closed is looked at when it is asked for", "[server]") {
  const TempFolder folder;
  const auto store = [&](const char* name, Label label) {
    store_cells(folder / name, metadata_of(cube_grid_of(0, 1, 8), 2, 3), std::vector<Label>(512, label));
  };
  store("a.tcell", 1);
  store("b.tcell", 1);
  ServiceOptions options{.named = {folder.path()}, .open_files = 1};
  options.cache_bytes = 0;  // so that each answer reads the file
  Service service(options);
  const auto get = [&](const std::string& target) { return handle(service, Request{.target = target}); };
  const std::string cell = "/cell?i=1&j=1&k=1";
  CHECK(json::parse(*get("/api/v1/grids/b" + cell).body)["materials"][0]["id"] == 1);  // closes a
  store("new", 2);
  std::filesystem::rename(folder / "new", folder / "a.tcell");
  const Response replaced = get("/api/v1/grids/a" + cell);
  REQUIRE(replaced.status == 200);
  CHECK(json::parse(*replaced.body)["materials"][0]["id"] == 2);
  std::filesystem::remove(folder / "b.tcell");
  CHECK(get("/api/v1/grids/b/cell?i=2&j=1&k=1").status == 404);
  CHECK(service.counters().damaged == 0);
}

// What a service answers for a file.
Response answer_of(const Bytes& file, const std::string& target) {
  const TempFolder folder;
  write_bytes(folder / "g.tcell", file);
  Service service({.named = {folder.path()}});
  return handle(service, {.target = target});
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
    const Bytes forged = forge(file, {.bytes = [&](FilePart part, Bytes& body) {
                                 if (part == FilePart::kReport) body.assign(report.begin(), report.end());
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
                             m.labels_hash.clear();  // it is of other names
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

// A service over a column of `cells` runs with long names, in chunks of 4096 cells.
struct LongColumn {
  TempFolder folder;
  std::filesystem::path path = folder / "g.tcell";
  std::unique_ptr<Service> service;
  std::vector<std::string> complaints;
  explicit LongColumn(int64_t cells) {
    Metadata meta = metadata_of(unit_grid({1, 1, cells}), 2, 2);
    meta.chunk_cells = 4096;
    meta.materials[1].name = std::string(256, '"');
    std::vector<Label> labels(static_cast<size_t>(cells));
    for (size_t i = 0; i < labels.size(); ++i) labels[i] = i % 2;
    store_cells(path, meta, labels);
    service =
        std::make_unique<Service>(ServiceOptions{.named = {path}, .complain = [&](const std::string& message) { complaints.push_back(message); }});
  }
  Request request{.target = "/api/v1/grids/g/column/z/0_0"};
  Response get() const { return handle(*service, request); }
};

std::string with_rest(const Response& r) {
  std::string all = *r.body;
  while (r.rest->append(all)) {
  }
  return all;
}

TEST_CASE("A large answer comes in parts, is not kept, and its ETag spares it; a small one of the same kind is kept", "[server]") {
  LongColumn s(30'000);
  const Response first = s.get(), second = s.get();
  REQUIRE(first.status == 200);
  REQUIRE(first.rest);
  CHECK(first.rest != second.rest);
  CHECK(first.body->size() < Service::kWhole + 2 * Parts::kEnough);
  const std::string all = with_rest(first);
  CHECK(all == with_rest(second));
  CHECK(json::parse(all)["runs"].size() == 30'000);
  CHECK_FALSE(handle_at_once(*s.service, s.request));
  CHECK(s.service->answers().counts().bytes == 0);
  s.request.if_none_match = first.etag;
  CHECK(s.get().status == 304);
  s.request.accepts_gzip = true;
  const Response gzip = s.get();
  CHECK(gzip.content_encoding == "gzip");
  REQUIRE(gzip.rest);
  CHECK(inflated(with_rest(gzip), all.size()) == all);
  LongColumn small(300);
  const Response whole = small.get();
  CHECK_FALSE(whole.rest);
  CHECK(handle_at_once(*small.service, small.request)->body == whole.body);
}

TEST_CASE("The parts of an answer go on when their grid is replaced or gone", "[server]") {
  LongColumn s(30'000);
  const std::string all = with_rest(s.get());
  const Response r = s.get();
  std::filesystem::remove(s.path);
  s.service->grids().look();
  CHECK(s.get().status == 404);
  CHECK(with_rest(r) == all);
}

TEST_CASE("Damage behind the first parts of an answer ends it, and is counted and complained of", "[server]") {
  LongColumn s(30'000);
  const auto entry = s.service->grids().find("g")->reader().entry({0, 0, 0, 6});
  damage(s.path, entry->offset + entry->size / 2);
  s.service->grids().look();
  const Response r = s.get();
  REQUIRE(r.status == 200);
  REQUIRE(r.rest);
  CHECK(s.service->counters().damaged == 0);
  CHECK_THROWS_AS(with_rest(r), FormatError);
  CHECK(s.service->counters().damaged == 1);
  REQUIRE(s.complaints.size() == 1);
  CHECK_THAT(s.complaints[0], Catch::Contains("level 0 chunk (0, 0, 6)"));
}

TEST_CASE("A client that accepts gzip gets it, whatever other clients asked for before, and the cache keeps it", "[server]") {
  Served s;
  Request request{.target = "/api/v1/grids/g/tile/z/3/0/0_0.bin"};
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
  Served s(2, {.anybody = false});
  CHECK(s.get("/api/v1/grids/g/tile/z/0/0/0_0.png?v=" + s.hash()).cache_control == "private, max-age=31536000, immutable");
}

TEST_CASE("The caches stay within their limit", "[server]") {
  Served s(1, {.cache_bytes = 200000});
  for (int z = 0; z < 21; ++z)
    for (const char* kind : {"png", "bin"}) REQUIRE(s.get(fmt::format("/api/v1/grids/g/tile/z/{}/0/0_0.{}", z, kind)).status == 200);
  CHECK(s.service->chunks().counts().bytes <= 200000);
  CHECK(s.service->answers().counts().bytes <= 25000);
  CHECK(s.service->chunks().counts().hits > 0);
}

TEST_CASE("The pages of all grids share the cache", "[server]") {
  Served s(1, {.cache_bytes = 128000});
  for (int i = 0; i < 40; ++i) std::filesystem::copy_file(s.path, s.folder / ("copy" + std::to_string(i) + ".tcell"));
  s.service->grids().look();
  for (int i = 0; i < 40; ++i) REQUIRE(s.get("/api/v1/grids/copy" + std::to_string(i) + "/stats?region=0,0,0,2,2,2").status == 200);
  const CacheCounts index = s.service->index().counts(), chunks = s.service->chunks().counts();
  CHECK(index.limit + chunks.limit == 128000);
  CHECK(index.bytes > index.limit / 2);
  std::set<std::string> named;
  for (const CacheState& cache : s.service->caches()) named.insert(cache.name);
  CHECK(named == std::set<std::string>{"chunks", "index", "answers", "fractions", "views", "refined"});  // and "blocks", where serve has addresses
  CHECK(index.bytes <= index.limit);
}

TEST_CASE("Neither a look before prefetching nor waiting for an answer counts as a hit", "[server]") {
  Served s;
  Request request{.target = "/api/v1/grids/g/tile/z/3/0/0_0.bin"};
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

}  // namespace
}  // namespace teracell::server
