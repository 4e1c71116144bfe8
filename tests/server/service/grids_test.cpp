// Which grids are served, and what happens when files are added, removed and replaced.
#include "server/service/grids_watch.hpp"

#include "server/service/message.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

namespace teracell::server {
namespace {

using namespace testing;

const Grid kGrid = unit_grid({5, 6, 7});

void store(const std::filesystem::path& path, Label filling) { store_cells(path, metadata_of(kGrid, 2, 3), std::vector<Label>(5 * 6 * 7, filling)); }

// Grids and their complaints.
struct Watched {
  explicit Watched(const std::vector<std::filesystem::path>& named)
      : grids(
            named, [](const std::filesystem::path& path, uint64_t) { return std::make_unique<const GridReader>(path); },
            [this](const std::string& message) { complaints.push_back(message); }) {}
  std::vector<std::string> complaints;
  Grids grids;
};

std::vector<std::string> ids(const Grids& grids) {
  std::vector<std::string> out;
  for (const auto& grid : grids.all()) out.push_back(grid->id);
  return out;
}

using Ids = std::vector<std::string>;

TEST_CASE("Ids have at most 256 bytes, and so have those of files whose names are not UTF-8", "[server]") {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "other");
  const std::string name = std::string(200, '\xff') + ".tcell";
  store(folder / name, 0);
  store(folder / "other" / name, 0);
  const Watched w({folder / name, folder / "other"});
  std::string id;
  for (int i = 0; i < 80; ++i) id += "\xef\xbf\xbd";
  CHECK(ids(w.grids) == Ids{id, id + "-2"});
}

TEST_CASE("Ids are stems, numbered when repeated; only named files and the *.tcell of named folders are served", "[server]") {
  TempFolder folder;
  for (const char* sub : {"a", "b", "b/deep"}) std::filesystem::create_directory(folder / sub);
  store(folder / "a" / "g.tcell", 0);
  store(folder / "b" / "g.tcell", 1);
  store(folder / "b" / "h.tcell", 1);
  store(folder / "b" / "deep" / "x.tcell", 1);
  store(folder / "other.tcell", 1);
  std::ofstream(folder / "b" / "notes.txt") << "no grid";
  const Watched w({folder / "a" / "g.tcell", folder / "b"});
  const Grids& grids = w.grids;
  CHECK(ids(grids) == Ids{"g", "g-2", "h"});
  CHECK(grids.find("g")->hash != grids.find("g-2")->hash);
  for (const char* unknown : {"other", "x", "notes", "", ".", "..", "a/g", "../other", "g.tcell"}) {
    INFO(unknown);
    CHECK_THROWS_AS(grids.find(unknown), HttpError);
  }
}

TEST_CASE("What can't be served is refused at the start, with the folder in the message", "[server]") {
  TempFolder folder;
  CHECK_THROWS_AS(Watched({folder / "missing.tcell"}), UsageError);
  std::ofstream(folder / "bad.tcell") << "not a grid";
  CHECK_THROWS_AS(Watched({folder / "bad.tcell"}), FormatError);
  CHECK_THROWS_WITH(Watched({folder / "bad.tcell"}), Catch::StartsWith((folder / "bad.tcell").string() + ": "));
  const auto here = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  CHECK_THROWS_WITH(Watched({"bad.tcell"}), Catch::StartsWith("bad.tcell: "));
  std::filesystem::current_path(here);
}

TEST_CASE("A bad file in a folder is an error of that grid alone, complained of once when it has stopped changing", "[server]") {
  TempFolder folder;
  const auto bad = folder / "bad.tcell";
  std::ofstream(bad) << "not a grid";
  store(folder / "good.tcell", 1);
  Watched w({folder.path()});
  Grids& grids = w.grids;
  CHECK(ids(grids) == Ids{"good"});
  try {
    grids.find("bad");
    FAIL("found");
  } catch (const HttpError& e) {
    CHECK(e.status == 500);
    CHECK(std::string(e.what()).find(folder.path().string()) == std::string::npos);  // clients must not see folders
    REQUIRE(grids.unreadable().size() == 1);
    CHECK(grids.unreadable()[0].id == "bad");
    CHECK(grids.unreadable()[0].error == e.what());
  }
  for (int i = 0; i < 3; ++i) grids.look();
  REQUIRE(w.complaints.size() == 1);
  CHECK(w.complaints[0].starts_with(bad.string() + ": "));
  std::filesystem::remove(bad);
  store(bad, 1);
  const uint64_t epoch = grids.epoch();
  grids.look();
  CHECK(ids(grids) == Ids{"bad", "good"});
  CHECK(grids.unreadable().empty());
  CHECK(grids.epoch() != epoch);
  CHECK(w.complaints.size() == 1);
}

TEST_CASE("A file that is replaced, added or removed is noticed; a caller that holds the old grid can go on reading", "[server]") {
  TempFolder folder;
  const auto path = folder / "g.tcell";
  store(path, 0);
  Watched w({folder.path()});
  Grids& grids = w.grids;
  const auto old = grids.find("g");
  const uint64_t epoch = grids.epoch();
  store(path, 2);
  store(folder / "new.tcell", 1);
  grids.look();
  CHECK(grids.epoch() != epoch);
  const auto fresh = grids.find("g");
  CHECK(fresh->hash != old->hash);
  CHECK(fresh->number != old->number);
  CHECK(all_cells(old->reader()) == std::vector<uint32_t>(210, 0));
  CHECK(all_cells(fresh->reader()) == std::vector<uint32_t>(210, 2));
  CHECK(ids(grids) == Ids{"g", "new"});
  std::filesystem::remove(path);
  grids.look();
  CHECK(ids(grids) == Ids{"new"});
  CHECK_THROWS_AS(grids.find("g"), HttpError);
  store(path, 1);
  grids.look();
  CHECK(ids(grids) == Ids{"g", "new"});
}

TEST_CASE("A watch notices changes without a call of look()", "[server][threads]") {
  TempFolder folder;
  store(folder / "g.tcell", 0);
  Watched w({folder.path()});
  const GridsWatch watch(w.grids);
  const uint64_t epoch = w.grids.epoch();
  store(folder / "new.tcell", 1);
  for (int i = 0; i < 1000 && w.grids.epoch() == epoch; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  CHECK(ids(w.grids) == Ids{"g", "new"});
}

// The grid g of a folder, whose file can't be opened.
struct Failing {
  enum State { kUnreadable, kBroken, kReadable };
  explicit Failing(State first)
      : state(first),
        grids(
            {folder_with_grid()},
            [this](const std::filesystem::path& file, uint64_t) {
              ++tries;
              if (state == kUnreadable) throw IoError(file.string() + ": can't open: Too many open files");
              if (state == kBroken) throw FormatError(file.string() + ": " + std::string(1 << 20, 'x') + " is wrong");
              return std::make_unique<const GridReader>(file);
            },
            [this](const std::string& message) { complaints.push_back(message); }) {}
  std::filesystem::path folder_with_grid() const {
    store(path, 0);
    return folder.path();
  }
  void look(int times) {
    for (int i = 0; i < times; ++i) grids.look();
  }
  const TempFolder folder;
  const std::filesystem::path path = folder / "g.tcell";
  std::atomic<State> state;
  std::atomic<int> tries = 0;
  std::vector<std::string> complaints;
  Grids grids;
};

TEST_CASE("A file that breaks the format is tried twice, and then not until it changes", "[server]") {
  Failing f(Failing::kBroken);
  f.look(200);
  CHECK(f.tries == 2);
  CHECK(f.complaints.size() == 1);
  f.state = Failing::kReadable;
  f.look(200);
  CHECK(ids(f.grids).empty());
  std::filesystem::last_write_time(f.path, std::filesystem::file_time_type::clock::now() + std::chrono::hours(1));
  f.look(1);
  CHECK(ids(f.grids) == Ids{"g"});
}

TEST_CASE("A file that can't be read is tried again after ever longer pauses of at most a minute", "[server]") {
  Failing f(Failing::kUnreadable);
  f.look(1200);  // ten minutes
  CHECK(f.tries >= 12);
  CHECK(f.tries <= 20);
  CHECK(f.complaints.size() == 1);
  f.state = Failing::kReadable;
  f.look(120);
  CHECK(ids(f.grids) == Ids{"g"});
}

TEST_CASE("A look anew tries files that are not due", "[server]") {
  Failing f(GENERATE(Failing::kUnreadable, Failing::kBroken));
  f.look(200);
  f.state = Failing::kReadable;
  SECTION("by hand") { f.grids.look(true); }
  SECTION("by a watch") {
    GridsWatch watch(f.grids);
    watch.look_soon();
    for (int i = 0; i < 1000 && ids(f.grids).empty(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  CHECK(ids(f.grids) == Ids{"g"});
}

TEST_CASE("However long an error is, what clients and the log get of it is short", "[server]") {
  Failing f(Failing::kBroken);
  f.look(2);
  REQUIRE(f.grids.unreadable().size() == 1);
  const std::string error = f.grids.unreadable()[0].error;
  CHECK(error.size() <= 1024);
  CHECK(error.starts_with("g.tcell: xxx"));
  CHECK(error.ends_with(" is wrong"));
  REQUIRE(f.complaints.size() == 1);
  CHECK(f.complaints[0].size() <= 1024 + f.path.string().size());
}

TEST_CASE("The same answers have the same epoch", "[server]") {
  TempFolder folder;
  store(folder / "g.tcell", 0);
  std::ofstream(folder / "bad.tcell") << "not a grid";
  Watched w({folder.path()});
  const uint64_t epoch = w.grids.epoch();
  const auto grid = w.grids.find("g");
  CHECK(w.grids.epoch_of(*grid) == epoch);
  for (int i = 0; i < 3; ++i) w.grids.look();
  CHECK(w.grids.epoch() == epoch);
  store(folder / "g.tcell", 1);
  w.grids.look();
  CHECK(w.grids.epoch() != epoch);
  CHECK_FALSE(w.grids.epoch_of(*grid));
}

TEST_CASE("A file that becomes a folder is gone, a folder that can't be read keeps its files", "[server]") {
  TempFolder folder;
  for (const char* sub : {"a", "b"}) std::filesystem::create_directory(folder / sub);
  for (const char* file : {"a/g.tcell", "b/h.tcell", "named.tcell"}) store(folder / file, 0);
  Watched w({folder / "a", folder / "b", folder / "named.tcell"});
  CHECK(ids(w.grids) == Ids{"g", "h", "named"});
  for (const char* file : {"a/g.tcell", "named.tcell"}) {
    std::filesystem::remove(folder / file);
    std::filesystem::create_directory(folder / file);
  }
  store(folder / "named.tcell" / "inside.tcell", 1);
  w.grids.look();
  CHECK(ids(w.grids) == Ids{"h"});
  CHECK_THROWS_AS(w.grids.find("g"), HttpError);
  CHECK(w.complaints.empty());
  std::filesystem::rename(folder / "b", folder / "c");
  std::ofstream(folder / "b") << "no folder";
  for (int i = 0; i < 2; ++i) w.grids.look();
  CHECK(ids(w.grids).empty());  // its files are gone
  REQUIRE(w.complaints.size() == 1);
  CHECK(w.complaints[0].starts_with((folder / "b").string() + ": can't be read: "));
}

TEST_CASE("Every name has an id that an address can hold", "[server]") {
  TempFolder folder;
  for (const char* name : {"..tcell", "...tcell", "a\nb.tcell",
                           "a\x7f"
                           "b.tcell",
                           "\xff.tcell", "\xc3\xbc %?#.tcell"})
    store(folder / name, 0);
  const Watched w({folder.path()});
  CHECK(ids(w.grids) == Ids{"__", "_", "a_b", "a_b-2", "\xc3\xbc %?#", "\xef\xbf\xbd"});
}

TEST_CASE("A file that comes back has its id again; files that have been gone for long are forgotten", "[server]") {
  TempFolder folder;
  for (const char* sub : {"a", "b"}) std::filesystem::create_directory(folder / sub);
  const auto a = folder / "a" / "g.tcell", b = folder / "b" / "g.tcell";
  store(a, 0);
  Watched w({folder / "a", folder / "b"});
  std::filesystem::remove(a);
  store(b, 1);
  w.grids.look();
  CHECK(ids(w.grids) == Ids{"g-2"});  // "g" is reserved for the other file
  store(a, 0);
  w.grids.look();
  CHECK(ids(w.grids) == Ids{"g", "g-2"});
  for (const auto& path : {a, b}) std::filesystem::remove(path);
  w.grids.look();
  const auto other = [&](int i) { return folder / "b" / fmt::format("x{}.tcell", i); };
  for (int i = 0; i < 1000; ++i) std::ofstream(other(i)) << "not a grid";
  w.grids.look();
  for (int i = 0; i < 1000; ++i) std::filesystem::remove(other(i));
  w.grids.look();
  store(b, 1);
  w.grids.look();
  CHECK(ids(w.grids) == Ids{"g"});
}

}  // namespace
}  // namespace teracell::server
