// Files that are opened again when they are read.
#include "server/service/open_files.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include "tests/support/descriptors.hpp"
#include "tests/support/meshed.hpp"

namespace teracell::server {
namespace {

using namespace testing;

void write(const std::filesystem::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

std::string read(const ByteSource& file) {
  std::string text(file.size(), '\0');
  file.read(0, {reinterpret_cast<uint8_t*>(text.data()), text.size()});
  return text;
}

TEST_CASE("Any number of files can be read with few descriptors, and those used last stay open", "[server]") {
  const TempFolder folder;
  const size_t before = open_descriptors();
  {
    const auto open = std::make_shared<OpenFiles>(3);
    std::vector<std::unique_ptr<ReopenedFile>> files;
    for (int i = 0; i < 20; ++i) {
      write(folder / std::to_string(i), fmt::format("file {}", i));
      files.push_back(std::make_unique<ReopenedFile>(folder / std::to_string(i), open));
      CHECK(open_descriptors() <= before + 3);
    }
    for (int turn = 0; turn < 2; ++turn)
      for (int i = 0; i < 20; ++i) {
        CHECK(read(*files[i]) == fmt::format("file {}", i));
        CHECK(open_descriptors() == before + 3);
      }
    std::filesystem::remove(folder / "19");  // the last that was read
    CHECK(read(*files[19]) == "file 19");
    files.resize(18);  // closes what nobody reads any more
    CHECK(open_descriptors() == before + 1);
  }
  CHECK(open_descriptors() == before);
}

TEST_CASE("A file that must be opened again and is another one, or has changed, is an error that names it", "[server]") {
  const TempFolder folder;
  const auto path = folder / "g", other = folder / "other";
  write(path, "first");
  write(other, "other");
  const auto open = std::make_shared<OpenFiles>(1);
  const ReopenedFile file(path, open), pushes_it_out(other, open);
  struct stat first {};
  REQUIRE(stat(path.c_str(), &first) == 0);
  const auto set_time = [&](int64_t seconds) {
    const timespec times[2] = {first.st_atim, {first.st_mtim.tv_sec + seconds, first.st_mtim.tv_nsec}};
    REQUIRE(utimensat(AT_FDCWD, path.c_str(), times, 0) == 0);
  };
  const auto refused = [&] {
    CHECK(read(pushes_it_out) == "other");
    CHECK_THROWS_AS(read(file), Replaced);
    CHECK_THROWS_WITH(read(file), Catch::StartsWith(path.string() + ": "));
  };
  SECTION("a later time") {
    set_time(1);
    refused();
    set_time(0);
    CHECK(read(file) == "first");
  }
  SECTION("another size") {
    write(path, "second");
    set_time(0);
    refused();
  }
  SECTION("another file of the same size and time") {
    write(folder / "new", "again");
    std::filesystem::rename(folder / "new", path);
    set_time(0);
    refused();
  }
  SECTION("no file") {
    std::filesystem::remove(path);
    refused();
  }
}

TEST_CASE("Threads read more files than are kept open", "[server][threads]") {
  const TempFolder folder;
  const auto open = std::make_shared<OpenFiles>(2);
  std::vector<std::unique_ptr<ReopenedFile>> files;
  for (int i = 0; i < 6; ++i) {
    write(folder / std::to_string(i), fmt::format("file {}", i));
    files.push_back(std::make_unique<ReopenedFile>(folder / std::to_string(i), open));
  }
  std::atomic<int> wrong = 0;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t)
      threads.emplace_back([&, t] {
        for (int n = 0; n < 1000; ++n) {
          const int i = (n * (t + 1)) % 6;
          wrong += read(*files[i]) != fmt::format("file {}", i);
        }
      });
  }
  CHECK(wrong == 0);
}

}  // namespace
}  // namespace teracell::server
