// What the CAD kernel made is found again, whole, by any process, within a limit.
#include "mesher/cad/facet_cache.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "store/base/error.hpp"
#include "tests/support/descriptors.hpp"
#include "tests/support/meshed.hpp"

namespace teracell::mesher {
namespace {

namespace fs = std::filesystem;
using testing::TempFolder;

struct CacheFolder : TempFolder {
  fs::path folder = path() / "cad";
  Budget budget{.folder = path()};
  FacetCache cache() const { return FacetCache(folder, budget); }
  fs::path entry(const std::string& key) const { return folder / (key + ".cad"); }
  std::set<std::string> names() const {
    std::set<std::string> out;
    for (const auto& e : fs::directory_iterator(folder)) out.insert(e.path().filename().string());
    return out;
  }
};

std::function<void(const std::string&)> writes(const std::string& text) {
  return [text](const std::string& path) { std::ofstream(path, std::ios::binary) << text; };
}

std::string text_of(const FacetCache::Entry& entry) {
  std::string out(entry.size, '\0');
  REQUIRE(entry.file.read(0, {reinterpret_cast<uint8_t*>(out.data()), out.size()}) == out.size());
  return out;
}

void set_used(const fs::path& path, int seconds_ago) {
  const timespec when{::time(nullptr) - seconds_ago, 0}, both[2] = {when, when};
  REQUIRE(::utimensat(AT_FDCWD, path.c_str(), both, 0) == 0);
}

// A file of so many bytes, which takes no room on the disk, last used so many seconds ago.
void add_sparse(const fs::path& path, off_t bytes, int seconds_ago) {
  std::ofstream(path).put('x');
  REQUIRE(::truncate(path.c_str(), bytes) == 0);
  set_used(path, seconds_ago);
}

constexpr off_t kGigabyte = off_t{1} << 30;
constexpr int kDay = 24 * 3600;

TEST_CASE("An entry is found under its key, by this cache and by others of the folder", "[cad]") {
  const CacheFolder folder;
  const FacetCache one = folder.cache(), other = folder.cache();
  CHECK_FALSE(one.find("a"));
  CHECK(text_of(one.add("a", writes("facets"))) == "facets");
  for (const FacetCache* cache : {&one, &other}) {
    const auto found = cache->find("a");
    REQUIRE(found);
    CHECK(text_of(*found) == "facets");
    CHECK(found->hash.size() == 32);
    CHECK(cache->find_text("a") == "facets");
    CHECK_FALSE(cache->find("b"));
    CHECK_FALSE(cache->find_text("b"));
  }
  other.add_text("a", "others");
  CHECK(one.find_text("a") == "others");
  other.add_text("nothing", "");
  CHECK(one.find_text("nothing") == "");
  CHECK(folder.names() == std::set<std::string>{"a.cad", "nothing.cad"});
  fs::remove(folder.folder / "a.cad");
  CHECK_FALSE(other.find("a"));
}

TEST_CASE("An entry under another name counts as missing", "[cad]") {
  const CacheFolder folder;
  const FacetCache cache = folder.cache();
  cache.add_text("a", "facets");
  cache.add_text("b", "others");
  fs::copy_file(folder.entry("a"), folder.entry("b"), fs::copy_options::overwrite_existing);
  CHECK_FALSE(cache.find("b"));
  CHECK(cache.find_text("a") == "facets");
}

TEST_CASE("An entry that is open outlives its removal", "[cad]") {
  const CacheFolder folder;
  const FacetCache cache = folder.cache();
  const auto entry = cache.add("a", writes("facets"));
  fs::remove(folder.folder / "a.cad");
  CHECK(text_of(entry) == "facets");
}

TEST_CASE("A text of which a byte is damaged or missing counts as none", "[cad]") {
  const CacheFolder folder;
  const FacetCache cache = folder.cache();
  const std::string text = R"({"outline": {}})";
  cache.add_text("a", text);
  const std::string bytes = testing::bytes_of(folder.entry("a"));
  REQUIRE(bytes.size() == text.size() + 16);
  for (size_t i = 0; i < bytes.size(); ++i) {
    INFO(i);
    std::string damaged = bytes;
    damaged[i] ^= 4;
    writes(damaged)(folder.entry("a"));
    REQUIRE_FALSE(cache.find_text("a"));
    writes(bytes.substr(0, i))(folder.entry("a"));
    REQUIRE_FALSE(cache.find_text("a"));
  }
  writes(bytes + "x")(folder.entry("a"));
  CHECK_FALSE(cache.find_text("a"));
  cache.add_text("a", text);
  CHECK(cache.find_text("a") == text);
}

TEST_CASE("Only files are entries: folders, links and pipes of such a name are not followed, nor waited for", "[cad]") {
  const CacheFolder folder;
  const FacetCache cache = folder.cache();
  cache.add_text("a", "text");
  fs::create_directory(folder.entry("folder"));
  fs::create_symlink(folder.entry("a"), folder.entry("link"));
  REQUIRE(::mkfifo(folder.entry("pipe").c_str(), 0600) == 0);
  for (const char* key : {"folder", "link", "pipe"}) {
    CHECK_FALSE(cache.find(key));
    CHECK_FALSE(cache.find_text(key));
  }
}

TEST_CASE("Where an entry can't be made, the reason passes through and nothing is left, not even an open file", "[cad]") {
  const CacheFolder folder;
  const FacetCache cache = folder.cache();
  const size_t open = testing::open_descriptors();
  CHECK_THROWS_WITH(cache.add("a",
                              [](const std::string& path) {
                                writes("half")(path);
                                throw InputError("the kernel gave up");
                              }),
                    "the kernel gave up");
  CHECK(folder.names().empty());
  CHECK_FALSE(cache.find("a"));
  CHECK(testing::open_descriptors() == open);
}

TEST_CASE("An entry isn't there before it is complete, and two that make it make one", "[cad]") {
  const CacheFolder folder;
  const FacetCache one = folder.cache(), other = folder.cache();
  one.add("a", [&](const std::string& path) {
    CHECK_FALSE(other.find("a"));
    writes("the same")(path);
    CHECK_FALSE(other.find("a"));
    CHECK(text_of(other.add("a", writes("the same"))) == "the same");
  });
  CHECK(other.find_text("a") == "the same");
  CHECK(folder.names() == std::set<std::string>{"a.cad"});
}

TEST_CASE("Whoever makes an entry holds its lock: others wait, and may stop waiting", "[cad]") {
  const CacheFolder folder;
  const FacetCache one = folder.cache(), other = folder.cache();
  std::optional<Descriptor> held = one.lock("a", 60, [] {});
  CHECK_FALSE(static_cast<bool>(other.lock("a", 0, [] {})));
  CHECK(static_cast<bool>(*held));
  CHECK(static_cast<bool>(other.lock("b", 60, [] { FAIL("another key"); })));
  CHECK_THROWS_WITH(other.lock("a", 60, [] { throw InputError("interrupted"); }), "interrupted");
  int waited = 0;
  const Descriptor later = other.lock("a", 60, [&] {
    if (++waited == 2) held.reset();
  });
  CHECK(static_cast<bool>(later));
  CHECK(waited == 2);
}

TEST_CASE("When there are more than two gigabytes, those go first that were not used for longest", "[cad]") {
  const CacheFolder folder;
  const FacetCache cache = folder.cache();
  cache.add_text("used", "text");
  set_used(folder.entry("used"), 500);
  cache.find("used");
  add_sparse(folder.entry("oldest"), kGigabyte, 400);
  add_sparse(folder.entry("old"), kGigabyte / 2, 300);
  add_sparse(folder.entry("young"), kGigabyte / 4 * 3, 100);
  cache.add("new", writes("facets"));
  CHECK(folder.names() == std::set<std::string>{"used.cad", "old.cad", "young.cad", "new.cad"});
  add_sparse(folder.entry("big"), kGigabyte, 50);
  cache.add("newer", writes("facets"));
  CHECK(folder.names() == std::set<std::string>{"used.cad", "young.cad", "big.cad", "new.cad", "newer.cad"});
}

TEST_CASE("What is made now stays, even where it alone is more than the limit", "[cad]") {
  const CacheFolder folder;
  const FacetCache cache = folder.cache();
  cache.add_text("old", "text");
  // Longer than the limit would take seconds to hash, so another entry has the bytes.
  add_sparse(folder.entry("large"), 3 * kGigabyte, 10);
  const auto entry = cache.add("new", writes("facets"));
  CHECK(text_of(entry) == "facets");
  CHECK(cache.find_text("new") == "facets");
  CHECK_FALSE(fs::exists(folder.entry("large")));
}

TEST_CASE("Nothing but what the cache made is ever removed; what runs that have ended left unfinished goes, and locks after a day", "[cad]") {
  const CacheFolder folder;
  const FacetCache cache = folder.cache();
  for (const char* name : {"model.step", "notes.txt", "a.cad.bak", "cad"}) add_sparse(folder.folder / name, 3 * kGigabyte, 30 * kDay);
  fs::create_directory(folder.entry("folder"));
  fs::create_symlink("notes.txt", folder.entry("link"));
  for (const int days : {0, 2}) add_sparse(folder.folder / (std::to_string(days) + ".cad-lock"), 1, days * kDay + 10);
  for (const int minutes : {0, 2}) add_sparse(folder.folder / (std::to_string(minutes) + "-Abc123.cad-unfinished"), 1, minutes * 60 + 10);
  cache.add("slow", [&](const std::string& path) {
    writes("facets")(path);
    set_used(path, 2 * kDay);
    cache.add("new", writes("facets"));
  });
  CHECK(folder.names() == std::set<std::string>{"model.step", "notes.txt", "a.cad.bak", "cad", "folder.cad", "link.cad", "0.cad-lock",
                                                "0-Abc123.cad-unfinished", "new.cad", "slow.cad"});
}

TEST_CASE("A folder that can't be used keeps nothing, and entries live as long as they are open", "[cad]") {
  const CacheFolder folder;
  writes("a file")(folder.path() / "file");
  const size_t open = testing::open_descriptors();
  {
    const FacetCache cache(folder.path() / "file" / "cad", folder.budget);
    const auto entry = cache.add("a", writes("facets"));
    CHECK(text_of(entry) == "facets");
    CHECK(entry.hash.size() == 32);
    CHECK_FALSE(cache.find("a"));
    cache.add_text("b", "text");
    CHECK_FALSE(cache.find_text("b"));
    CHECK_FALSE(static_cast<bool>(cache.lock("a", 60, [] {})));
    CHECK_THROWS_WITH(cache.add("a", [](const std::string&) { throw InputError("the kernel gave up"); }), "the kernel gave up");
  }
  CHECK(testing::open_descriptors() == open);
  CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 1);  // the file
}

TEST_CASE("The folder is for its user alone, and so is what is in it", "[cad]") {
  const CacheFolder folder;
  const FacetCache cache = folder.cache();
  cache.add_text("a", "text");
  for (const fs::path& path : {folder.folder, folder.entry("a")}) CHECK((fs::status(path).permissions() & fs::perms(077)) == fs::perms::none);
}

}  // namespace
}  // namespace teracell::mesher
