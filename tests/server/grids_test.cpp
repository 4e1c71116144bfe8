// What is served, and what happens when files come, go and change.
#include "server/grids.hpp"

#include <fstream>
#include <thread>

#include <catch2/catch.hpp>

#include "server/http.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

namespace teracell {
namespace {

using namespace testing;

const Grid kGrid{{Axis::uniform(0, 1, 0, 5, 0.5), Axis::uniform(0, 1, 0, 6, 0.5), Axis::uniform(0, 1, 0, 7, 0.5)}};

void store(const std::filesystem::path& path, Label filling) {
  store_cells(path, metadata_of(kGrid, 2, 3), std::vector<Label>(5 * 6 * 7, filling));
}

Grids grids_of(std::vector<std::filesystem::path> named) {
  return {std::move(named), [](const std::filesystem::path& path, uint64_t) { return std::make_unique<const GridReader>(path); }};
}

std::vector<std::string> ids(Grids& grids) {
  std::vector<std::string> out;
  for (const auto& grid : grids.all()) out.push_back(grid->id);
  return out;
}

// Files are looked at once a second.
void wait_for_a_look() { std::this_thread::sleep_for(std::chrono::milliseconds(1100)); }

using Ids = std::vector<std::string>;

TEST_CASE("Ids are stems, numbered when repeated; only what was named and *.tcell in named folders is served", "[server]") {
  TempFolder folder;
  for (const char* sub : {"a", "b", "b/deep"}) std::filesystem::create_directory(folder / sub);
  store(folder / "a" / "g.tcell", 0);
  store(folder / "b" / "g.tcell", 1);
  store(folder / "b" / "h.tcell", 1);
  store(folder / "b" / "deep" / "x.tcell", 1);
  store(folder / "other.tcell", 1);
  std::ofstream(folder / "b" / "notes.txt") << "no grid";
  Grids grids = grids_of({folder / "a" / "g.tcell", folder / "b"});
  CHECK(ids(grids) == Ids{"g", "g-2", "h"});
  CHECK(grids.find("g")->hash != grids.find("g-2")->hash);
  for (const char* unknown : {"other", "x", "notes", "", ".", "..", "a/g", "../other", "g.tcell"}) {
    INFO(unknown);
    CHECK_THROWS_AS(grids.find(unknown), HttpError);
  }
}

TEST_CASE("What can't be served is refused at the start", "[server]") {
  TempFolder folder;
  CHECK_THROWS_AS(grids_of({folder / "missing.tcell"}), UsageError);
  std::ofstream(folder / "bad.tcell") << "not a grid";
  CHECK_THROWS_AS(grids_of({folder / "bad.tcell"}), FormatError);
  Grids grids = grids_of({folder.path()});  // in a folder it is an error of that grid alone
  CHECK(ids(grids).empty());
  try {
    grids.find("bad");
    FAIL("found");
  } catch (const HttpError& e) {
    CHECK(e.status == 500);
    CHECK(std::string(e.what()).find(folder.path().string()) == std::string::npos);  // clients learn no folder
  }
  std::filesystem::remove(folder / "bad.tcell");
  store(folder / "bad.tcell", 1);
  wait_for_a_look();
  CHECK(ids(grids) == Ids{"bad"});
}

TEST_CASE("A file that is replaced, added or removed is noticed; who holds the old one reads on", "[server]") {
  TempFolder folder;
  const auto path = folder / "g.tcell";
  store(path, 0);
  Grids grids = grids_of({folder.path()});
  const auto old = grids.find("g");
  const uint64_t epoch = grids.epoch();
  store(path, 2);
  store(folder / "new.tcell", 1);
  wait_for_a_look();
  CHECK(grids.epoch() != epoch);
  const auto fresh = grids.find("g");
  CHECK(fresh->hash != old->hash);
  CHECK(fresh->number != old->number);
  CHECK(all_cells(old->reader()) == std::vector<uint32_t>(210, 0));
  CHECK(all_cells(fresh->reader()) == std::vector<uint32_t>(210, 2));
  CHECK(ids(grids) == Ids{"g", "new"});
  std::filesystem::remove(path);
  wait_for_a_look();
  CHECK(ids(grids) == Ids{"new"});
  CHECK_THROWS_AS(grids.find("g"), HttpError);
  store(path, 1);
  wait_for_a_look();
  CHECK(ids(grids) == Ids{"g", "new"});
}

}  // namespace
}  // namespace teracell
