// Files: a name appears only for a complete file, and nothing else is left behind.
#include "store/file.hpp"

#include <cerrno>
#include <csignal>
#include <fstream>

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

static int folder_error = 0;  // what fsync of a folder fails with

// Takes the place of libc's for the whole program.
extern "C" int fsync(int fd) {
  struct stat st;
  if (folder_error == 0 || fstat(fd, &st) != 0 || !S_ISDIR(st.st_mode)) return static_cast<int>(syscall(SYS_fsync, fd));
  errno = folder_error;
  return -1;
}

namespace teracell {
namespace {

using namespace testing;
namespace fs = std::filesystem;

Bytes some_bytes(size_t n) {
  Bytes bytes(n);
  for (size_t i = 0; i < n; ++i) bytes[i] = static_cast<uint8_t>(i * i >> 3);
  return bytes;
}

// Files may not pass `limit` bytes while it lives: the nearest thing to a full disk that needs no disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t limit) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit now = before_;
    now.rlim_cur = limit;
    setrlimit(RLIMIT_FSIZE, &now);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;

 private:
  rlimit before_;
  void (*handler_)(int);
};

TEST_CASE("An output file has no name before commit and every byte after it") {
  const TempFolder folder;
  const size_t descriptors = open_descriptors();
  for (const size_t size : {size_t{0}, size_t{1}, size_t{1} << 20, (size_t{5} << 20) + 7}) {
    const Bytes bytes = some_bytes(size);
    OutputFile out(folder / "g.tcell");
    for (size_t at = 0; at < size; at += 777'777) out.append(std::span(bytes).subspan(at, std::min<size_t>(777'777, size - at)));
    REQUIRE(out.size() == size);
    REQUIRE_FALSE(fs::exists(folder / "g.tcell"));
    out.commit();
    REQUIRE(file_bytes(folder / "g.tcell") == bytes);
    REQUIRE_FALSE(fs::exists(folder / "g.tcell.partial"));
    fs::remove(folder / "g.tcell");
  }
  REQUIRE(open_descriptors() == descriptors);
}

TEST_CASE("An output file that is not committed leaves nothing, and an older file stays as it was") {
  const TempFolder folder;
  const size_t descriptors = open_descriptors();
  {
    OutputFile out(folder / "new.tcell");
    out.append(some_bytes(3 << 20));
  }
  REQUIRE(fs::is_empty(folder.path()));
  std::ofstream(folder / "old.tcell") << "old";
  {
    OutputFile out(folder / "old.tcell");
    out.append(some_bytes(3 << 20));
    REQUIRE(bytes_of(folder / "old.tcell") == "old");
  }
  REQUIRE(bytes_of(folder / "old.tcell") == "old");
  REQUIRE_FALSE(fs::exists(folder / "old.tcell.partial"));
  REQUIRE(open_descriptors() == descriptors);
}

TEST_CASE("A committed file replaces an older one at once: who has the old one open keeps reading it") {
  const TempFolder folder;
  std::ofstream(folder / "g.tcell") << "old";
  const InputFile before(folder / "g.tcell");
  OutputFile out(folder / "g.tcell");
  out.append(some_bytes(100));
  out.commit();
  Bytes old(3);
  before.read(0, old);
  REQUIRE(old == Bytes{'o', 'l', 'd'});
  REQUIRE(file_bytes(folder / "g.tcell") == some_bytes(100));
}

TEST_CASE("A second writer is refused while the first writes, and does not disturb it") {
  const TempFolder folder;
  const size_t descriptors = open_descriptors();
  {
    OutputFile first(folder / "g.tcell");
    first.append(some_bytes(2 << 20));
    REQUIRE_THROWS_AS(OutputFile(folder / "g.tcell"), IoError);
    REQUIRE_THROWS_WITH(OutputFile(folder / "g.tcell"), Catch::Contains("g.tcell") && Catch::Contains("lock"));
    first.append(some_bytes(10));
    first.commit();
  }
  REQUIRE(fs::file_size(folder / "g.tcell") == (2 << 20) + 10);
  OutputFile after(folder / "g.tcell");
  after.commit();
  REQUIRE(fs::file_size(folder / "g.tcell") == 0);
  REQUIRE(open_descriptors() == descriptors);
}

TEST_CASE("A partial file that a killed writer left is overwritten") {
  const TempFolder folder;
  std::ofstream(folder / "g.tcell.partial") << std::string(1000, 'x');
  OutputFile out(folder / "g.tcell");
  out.append(some_bytes(10));
  out.commit();
  REQUIRE(file_bytes(folder / "g.tcell") == some_bytes(10));
  REQUIRE_FALSE(fs::exists(folder / "g.tcell.partial"));
}

TEST_CASE("A place that can't be written is an IoError that names it") {
  const TempFolder folder;
  const size_t descriptors = open_descriptors();
  std::ofstream(folder / "file") << "x";
  fs::create_directory(folder / "sub");
  REQUIRE_THROWS_WITH(OutputFile(folder / "missing" / "g.tcell"), Catch::Contains("missing"));
  for (const fs::path& path : {folder / "missing" / "g.tcell", folder / "file" / "g.tcell", folder / "sub", fs::path("/proc/nowhere/g.tcell"),
                               folder / std::string(300, 'n')}) {
    INFO(path);
    REQUIRE_THROWS_AS(OutputFile(path), IoError);
  }
  REQUIRE(open_descriptors() == descriptors);
}

TEST_CASE("A folder that may not be written is an IoError") {
  if (geteuid() == 0) return;  // root may write anywhere
  const TempFolder folder;
  fs::create_directory(folder / "sub");
  fs::permissions(folder / "sub", fs::perms::owner_read | fs::perms::owner_exec);
  REQUIRE_THROWS_AS(OutputFile(folder / "sub" / "g.tcell"), IoError);
  fs::permissions(folder / "sub", fs::perms::none);
  REQUIRE_THROWS_AS(OutputFile(folder / "sub" / "g.tcell"), IoError);
  fs::permissions(folder / "sub", fs::perms::owner_all);
}

TEST_CASE("A disk that is full is an IoError that names the file, in append or in commit, and leaves no debris") {
  const TempFolder folder;
  const size_t descriptors = open_descriptors();
  for (const size_t size : {size_t{100} << 10, size_t{3} << 20}) {  // it fits the buffer, or it doesn't
    const FileSizeLimit limit(64 << 10);
    const auto write = [&] {
      OutputFile out(folder / "g.tcell");
      out.append(some_bytes(size));
      out.commit();
    };
    REQUIRE_THROWS_AS(write(), IoError);
    REQUIRE_THROWS_WITH(write(), Catch::Contains("g.tcell") && Catch::Contains("too large"));
    REQUIRE(fs::is_empty(folder.path()));
  }
  REQUIRE(open_descriptors() == descriptors);
}

TEST_CASE("A folder that can't be made durable is reported with the file in place, one that never can be is not") {
  const TempFolder folder;
  const size_t descriptors = open_descriptors();
  for (const int error : {EIO, EINVAL, EOPNOTSUPP, ENOSPC, 0}) {
    OutputFile out(folder / "g.tcell");
    out.append(some_bytes(1000));
    folder_error = error;
    const bool reported = error == EIO || error == ENOSPC;
    if (reported) CHECK_THROWS_WITH(out.commit(), Catch::Contains("g.tcell") && Catch::Contains("in place"));
    else CHECK_NOTHROW(out.commit());
    folder_error = 0;
    REQUIRE(file_bytes(folder / "g.tcell") == some_bytes(1000));
    REQUIRE_FALSE(fs::exists(folder / "g.tcell.partial"));
    fs::remove(folder / "g.tcell");
  }
  REQUIRE(open_descriptors() == descriptors);
}

TEST_CASE("Meshing onto a full disk is an IoError and leaves no debris") {
  const TempFolder folder, output;
  const Axis axis = Axis::uniform(-1.1, 2.2 / 40, 0, 40, 0.5);
  const Scene scene = scene_of(folder, {{shapes::sphere({0, 0, 0}, 1, 4)}}, {{axis, axis, axis}});
  const FileSizeLimit limit(1 << 10);
  REQUIRE_THROWS_AS(mesh_quietly(scene, output / "g.tcell"), IoError);
  REQUIRE(fs::is_empty(output.path()));
}

TEST_CASE("An input file gives the bytes at any offset, and an IoError beyond its end") {
  const TempFolder folder;
  const Bytes bytes = some_bytes(100'000);
  OutputFile out(folder / "in");
  out.append(bytes);
  out.commit();
  const InputFile in(folder / "in");
  REQUIRE(in.size() == bytes.size());
  REQUIRE(in.name() == (folder / "in").string());
  for (const size_t offset : {0, 1, 4095, 99'999, 100'000}) {
    Bytes part(bytes.size() - offset);
    in.read(offset, part);
    REQUIRE(std::equal(part.begin(), part.end(), bytes.begin() + static_cast<ptrdiff_t>(offset)));
    Bytes beyond(part.size() + 1);
    REQUIRE_THROWS_AS(in.read(offset, beyond), IoError);
  }
  Bytes one(1);
  REQUIRE_THROWS_AS(in.read(uint64_t{1} << 40, one), IoError);
  REQUIRE_THROWS_AS(in.read(~uint64_t{0}, one), IoError);
}

TEST_CASE("What is not there or no regular file is an IoError that names it, and no descriptor is lost") {
  const TempFolder folder;
  const size_t descriptors = open_descriptors();
  REQUIRE(mkfifo((folder / "pipe").c_str(), 0600) == 0);
  REQUIRE_THROWS_WITH(InputFile(folder / "missing"), Catch::Contains("missing"));
  REQUIRE_THROWS_AS(InputFile(folder / "missing"), IoError);
  REQUIRE_THROWS_AS(InputFile(folder.path()), IoError);
  REQUIRE_THROWS_AS(InputFile("/dev/null"), IoError);
  REQUIRE(open_descriptors() == descriptors);
}

}  // namespace
}  // namespace teracell
