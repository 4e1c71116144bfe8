// What all protocols promise: answers that can be cached, and no invented cells.
#include "server/api/routes.hpp"
#include "server/protocols/protocols.hpp"
#include "tests/support/served_cells.hpp"

namespace teracell::server {

using namespace testing;
namespace {

const std::vector<std::string> kAddresses = {"/zarr/g/zarr.json",
                                             "/zarr/g/1/zarr.json",
                                             "/zarr/g/labels/material/0/c/1/2/1",
                                             "/zarr/g/0/c/1/2/1",
                                             "/zarr2/g/.zattrs",
                                             "/zarr2/g/.zmetadata",
                                             "/zarr2/g/0/0/1/1",
                                             "/xarray/g/0/.zmetadata",
                                             "/xarray/g/1/label/0/1/0",
                                             "/xarray/g/0/y/0",
                                             "/precomputed/g/info",
                                             "/precomputed/g/segprops/info",
                                             "/precomputed/g/s1/0-35_0-65_3-4",
                                             "/dzi/g/z/12.dzi",
                                             "/dzi/g/z/12_files/7/0_0.png",
                                             "/iiif/g-y-3/info.json",
                                             "/iiif/g-y-3/0,0,70,67/70,67/0/default.png"};

TEST_CASE("Protocols: an answer has a strong ETag and is not sent twice; with a version in its address it may be cached for ever", "[server]") {
  ServedCells served(odd_grid(), 2, 4);
  const std::string hash = GridReader(served.file()).hash();
  for (const std::string& address : kAddresses) {
    INFO(address);
    server::Request request{.target = address, .origin = "http://host:8080"};
    const Response first = served.get(request);
    REQUIRE(first.status == 200);
    REQUIRE(first.etag.starts_with('"'));
    REQUIRE(first.cache_control == "no-cache");
    request.if_none_match = first.etag;
    REQUIRE(served.get(request).status == 304);
    request.if_none_match = "\"other\"";
    REQUIRE(served.get(request).status == 200);
    const std::string kept = served.get(address + "?v=" + hash).cache_control;
    if (address.ends_with("info.json")) REQUIRE(kept == "no-cache");  // the document holds its own address
    else REQUIRE_THAT(kept, Catch::Contains("immutable"));
    require_missing(served.get(address + "?v=0123"));
    REQUIRE(*served.get(address + "?whatever=1").body == *first.body);
  }
}

TEST_CASE("Protocols: what does not exist stays missing when a client claims to have it", "[server]") {
  ServedCells served(odd_grid(), 2, 4);
  server::Request request{.if_none_match = "*"};
  for (const char* address : {"/zarr/g/0/c/9/9/9", "/zarr2/g/0/9/9/9", "/xarray/g/0/x/9", "/precomputed/g/s0/0-1_0-1_0-1",
                              "/dzi/g/z/0_files/99/0_0.png", "/iiif/g-y-3/1,1,1,1/1,1/0/default.png"}) {
    request.target = address;
    require_missing(served.get(request));
  }
}

TEST_CASE("Protocols: HTTP compresses what the protocol does not", "[server]") {
  ServedCells served(odd_grid(), 2, 4);
  server::Request request{.target = "/precomputed/g/s0/0-70_0-130_5-6", .accepts_gzip = true};
  const Response r = served.get(request);
  REQUIRE(r.content_encoding == "gzip");
  REQUIRE(inflated(*r.body, 70 * 130) == *served.get(request.target).body);
  request.target = "/zarr/g/0/c/0/0/0";
  REQUIRE(served.get(request).content_encoding.empty());
}

TEST_CASE("Protocols: where a damaged chunk is needed the answer is an error, never 404 and never a fill value", "[server]") {
  ServedCells served(odd_grid(), 2, 4);
  const auto expected = [&](const std::string& address) { return *served.get(address).body; };
  std::vector<std::pair<std::string, std::string>> sound;
  for (int z = 0; z < 2; ++z)
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 2; ++x)
        for (const std::string& address : {fmt::format("/zarr/g/0/c/{}/{}/{}", z, y, x), fmt::format("/zarr2/g/0/{}/{}/{}", z, y, x),
                                           fmt::format("/xarray/g/0/label/{}/{}/{}", z, y, x)})
          sound.emplace_back(address, expected(address));
  for (int z = 0; z < 67; ++z)
    sound.emplace_back(fmt::format("/precomputed/g/s0/0-70_0-130_{}-{}", z, z + 1),
                       expected(fmt::format("/precomputed/g/s0/0-70_0-130_{}-{}", z, z + 1)));
  sound.emplace_back("/dzi/g/z/3_files/8/0_0.png", expected("/dzi/g/z/3_files/8/0_0.png"));
  damage(served.file(), 32 + 100);  // in the first frame after the header: a chunk at the origin
  server::Service service({.named = {served.file()}});
  std::set<std::string> broken;
  for (const auto& [address, bytes] : sound) {
    const Response r = handle(service, {.target = address});
    if (r.status != 200) {
      REQUIRE(r.status == 500);
      REQUIRE_FALSE(r.body->empty());
      broken.insert(address);
    } else {
      REQUIRE(*r.body == bytes);
    }
  }
  REQUIRE(broken.count("/zarr/g/0/c/0/0/0") == 1);
  REQUIRE(broken.count("/zarr2/g/0/0/0/0") == 1);
  REQUIRE(broken.count("/xarray/g/0/label/0/0/0") == 1);
  REQUIRE(broken.size() < sound.size() / 2);
  const server::Request request{.target = "/zarr/g/zarr.json"};
  REQUIRE(server::handle(service, request).status == 200);
}

TEST_CASE("Protocols: whatever the address, the answer is 200, 303, 400 or 404, and a 404 below their prefixes is empty", "[server]") {
  ServedCells served(odd_grid(), 2, 4);
  std::mt19937_64 random(5);
  const std::string alphabet = "0123456789-_,./%?&=vczyxs";
  std::map<int, int> met;
  for (int i = 0; i < 20000; ++i) {
    std::string target = kAddresses[random() % kAddresses.size()];
    for (int edits = random_int(random, 1, 4); edits > 0; --edits) {
      const size_t at = 1 + random() % (target.size() - 1);
      const std::string& other = kAddresses[random() % kAddresses.size()];
      switch (random() % 5) {
        case 0: target.erase(at, 1 + random() % 3); break;
        case 1: target.insert(at, 1, alphabet[random() % alphabet.size()]); break;
        case 2: target[at] = alphabet[random() % alphabet.size()]; break;
        case 3: target.insert(at, target.substr(at, random() % 8)); break;
        default: target = target.substr(0, at) + other.substr(random() % other.size());
      }
      if (target.size() < 2) target = "/z";
    }
    INFO(target);
    const Response r = served.get(target);
    ++met[r.status];
    REQUIRE((r.status == 200 || r.status == 303 || r.status == 400 || r.status == 404));
    REQUIRE(r.body);
    for (const char* prefix : {"/zarr/", "/zarr2/", "/xarray/", "/precomputed/", "/dzi/", "/iiif/"})
      if (r.status == 404 && target.starts_with(prefix)) REQUIRE(r.body->empty());
  }
  REQUIRE(met[200] > 100);
  REQUIRE(met[400] > 100);
  REQUIRE(met[404] > 1000);
}

TEST_CASE("Protocols: each has a prefix of its own, and the list of grids gives an address of each that exists", "[server]") {
  ServedCells served(odd_grid(), 2, 4);
  const auto listed = nlohmann::json::parse(*served.get("/api/v1/grids").body)["grids"][0]["protocols"];
  REQUIRE(listed.size() == server::protocols().size());
  std::set<std::string> prefixes;
  for (const Protocol& p : protocols()) {
    INFO(p.prefix);
    CHECK(prefixes.insert(p.prefix).second);
    const auto& entry = listed[prefixes.size() - 1];
    const std::string path = entry["path"];
    CHECK(entry["title"] == p.title);
    CHECK(path.starts_with(fmt::format("/{}/g", p.prefix)));
    const Response r = served.get(path + p.document);
    CHECK(r.status == 200);
    CHECK(r.route == std::string(p.route));
    CHECK(served.get(fmt::format("/{}/nowhere/x", p.prefix)).route == std::string(p.route));
  }
  CHECK(prefixes.size() == 6);
}

}  // namespace
}  // namespace teracell::server
