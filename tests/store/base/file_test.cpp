// Files and folders: a name appears only for what is complete, and nothing else is left behind.
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "store/base/file.hpp"
#include "store/base/output_file.hpp"
#include "store/base/output_folder.hpp"
#include "tests/support/disk.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

static int folder_error = 0;                 // what fsync of a folder fails with
static std::filesystem::path failing_folder;  // only this one, unless it is empty

// Takes the place of libc's for the whole program.
extern "C" int fsync(int fd) {
  struct stat st;
  struct stat failing;
  const bool fails = folder_error != 0 && fstat(fd, &st) == 0 && S_ISDIR(st.st_mode) &&
                     (failing_folder.empty() || (stat(failing_folder.c_str(), &failing) == 0 && st.st_ino == failing.st_ino));
  if (!fails) return static_cast<int>(syscall(SYS_fsync, fd));
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

TEST_CASE("What a process of a killed job still writes does not reach the next job's file") {
  const TempFolder folder;
  OutputFile killed(folder / "g.tcell");
  killed.skip(100);
  const FileRoom still_writing(folder / "g.tcell");
  killed.abandon();
  OutputFile next(folder / "g.tcell");
  next.append(some_bytes(100));
  still_writing.write_at(0, Bytes(100, 0xee));
  next.commit();
  still_writing.write_at(0, Bytes(100, 0xee));
  REQUIRE(file_bytes(folder / "g.tcell") == some_bytes(100));
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

// ---- OutputFolder

constexpr const char* kMark = "zarr.json";

// All files below `folder`, by their names.
std::map<std::string, Bytes> files_in(const fs::path& folder) {
  std::map<std::string, Bytes> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (!entry.is_directory()) out[entry.path().lexically_relative(folder)] = file_bytes(entry.path());
  return out;
}

// What an export might write; its files hold `size` bytes.
std::map<std::string, Bytes> write_some(const OutputFolder& out, size_t size) {
  std::map<std::string, Bytes> files = {{kMark, some_bytes(7)}, {"0/c/0", some_bytes(size)}, {"0/c/1", {}}, {"1/c/0", some_bytes(size / 2)}};
  for (const auto& [name, bytes] : files) out.write(name, bytes);
  return files;
}

TEST_CASE("An output folder has no name before commit and every file after it") {
  const TempFolder folder;
  const size_t descriptors = open_descriptors();
  for (const char* name : {"g.zarr", "g.zarr/"}) {
    {
      OutputFolder out(folder / name, kMark);
      const auto files = write_some(out, 100'000);
      REQUIRE_FALSE(fs::exists(folder / "g.zarr"));
      out.commit();
      REQUIRE((files_in(folder / "g.zarr") == files));
      REQUIRE_FALSE(fs::exists(folder / "g.zarr.partial"));
    }
    REQUIRE(fs::is_directory(folder / "g.zarr"));  // also when the writer is gone
    fs::remove_all(folder / "g.zarr");
  }
  REQUIRE(open_descriptors() == descriptors);
}

TEST_CASE("An output folder that is not committed leaves nothing, and an older one stays as it was") {
  const TempFolder folder;
  const size_t descriptors = open_descriptors();
  { write_some(OutputFolder(folder / "g.zarr", kMark), 100); }
  REQUIRE(fs::is_empty(folder.path()));
  OutputFolder first(folder / "g.zarr", kMark);
  const auto files = write_some(first, 1000);
  first.commit();
  { write_some(OutputFolder(folder / "g.zarr", kMark), 10); }
  REQUIRE((files_in(folder / "g.zarr") == files));
  REQUIRE_FALSE(fs::exists(folder / "g.zarr.partial"));
  REQUIRE_THROWS_AS(
      [&] {
        const OutputFolder out(folder / "g.zarr", kMark);
        write_some(out, 10);
        throw Interrupted("stop");
      }(),
      Interrupted);
  REQUIRE((files_in(folder.path()).size() == files.size()));
  REQUIRE(open_descriptors() == descriptors);
}

TEST_CASE("A committed folder replaces an older one at once, with all that was in it: who has its files open keeps reading them") {
  const TempFolder folder;
  const size_t descriptors = open_descriptors();
  {
    OutputFolder first(folder / "g.zarr", kMark);
    first.write("only/the/first", some_bytes(10));
    write_some(first, 1000);
    first.commit();
    const InputFile before(folder / "g.zarr" / "only" / "the" / "first");
    OutputFolder second(folder / "g.zarr", kMark);
    const auto files = write_some(second, 10);
    second.commit();
    REQUIRE((files_in(folder / "g.zarr") == files));
    REQUIRE_FALSE(fs::exists(folder / "g.zarr.partial"));
    Bytes bytes(10);
    before.read(0, bytes);
    REQUIRE(bytes == some_bytes(10));
  }
  fs::remove_all(folder / "g.zarr");
  fs::create_directory(folder / "g.zarr");  // an empty one is replaced as well
  OutputFolder third(folder / "g.zarr", kMark);
  const auto files = write_some(third, 10);
  third.commit();
  REQUIRE((files_in(folder / "g.zarr") == files));
  REQUIRE(open_descriptors() == descriptors);
}

TEST_CASE("A folder without the mark is refused and not touched, even when it came after the writer") {
  const TempFolder folder;
  const size_t descriptors = open_descriptors();
  fs::create_directories(folder / "home" / kMark);  // a folder of that name is no mark
  std::ofstream(folder / "home" / "letter") << "dear";
  REQUIRE_THROWS_WITH(OutputFolder(folder / "home", kMark), Catch::Contains("home") && Catch::Contains("'zarr.json'"));
  {
    OutputFolder out(folder / "late", kMark);
    write_some(out, 10);
    fs::create_directory(folder / "late");
    std::ofstream(folder / "late" / "letter") << "dear";
    REQUIRE_THROWS_AS(out.commit(), IoError);
  }
  REQUIRE(bytes_of(folder / "home" / "letter") == "dear");
  REQUIRE(bytes_of(folder / "late" / "letter") == "dear");
  REQUIRE(files_in(folder.path()).size() == 2);
  REQUIRE(open_descriptors() == descriptors);
}

TEST_CASE("A second writer of a folder is refused while the first writes, and does not disturb it") {
  const TempFolder folder;
  const size_t descriptors = open_descriptors();
  {
    OutputFolder first(folder / "g.zarr", kMark);
    first.write("a", some_bytes(10));
    REQUIRE_THROWS_WITH(OutputFolder(folder / "g.zarr", kMark), Catch::Contains("g.zarr") && Catch::Contains("lock"));
    first.write("b", some_bytes(20));
    first.commit();
  }
  REQUIRE(files_in(folder / "g.zarr").size() == 2);
  REQUIRE(open_descriptors() == descriptors);
}

TEST_CASE("What a killed writer of a folder left is removed by the next one") {
  const TempFolder folder;
  fs::create_directories(folder / "g.zarr.partial" / "9" / "c");
  std::ofstream(folder / "g.zarr.partial" / "9" / "c" / "0") << std::string(1000, 'x');
  OutputFolder out(folder / "g.zarr", kMark);
  const auto files = write_some(out, 10);
  out.commit();
  REQUIRE((files_in(folder / "g.zarr") == files));
  REQUIRE_FALSE(fs::exists(folder / "g.zarr" / "9"));
  REQUIRE_FALSE(fs::exists(folder / "g.zarr.partial"));
}

// With stand-ins: nothing that a test does may reach the machine's own.
TEST_CASE("A pipe, or a link to one or to what a process has open, as /dev/stdout is, is no place for a file and stays what it is") {
  const TempFolder folder;
  std::ofstream(folder / "redirected") << "x";
  const InputFile open(folder / "redirected");
  std::string opened;
  for (const auto& fd : fs::directory_iterator("/proc/self/fd"))
    if (std::error_code gone; fs::read_symlink(fd, gone) == fs::canonical(folder / "redirected")) opened = fd.path();
  REQUIRE_FALSE(opened.empty());
  REQUIRE(mkfifo((folder / "null").c_str(), 0600) == 0);
  fs::create_symlink("null", folder / "link");
  fs::create_symlink(opened, folder / "stdout");
  for (const char* name : {"null", "link"}) {
    CHECK_THROWS_WITH(OutputFile(folder / name), Catch::Contains(name) && Catch::Contains("expected the name of a file, found a device or a pipe"));
    CHECK_THROWS_WITH(OutputFolder(folder / name, kMark), Catch::Contains("expected the name of a folder, found a device or a pipe"));
  }
  CHECK_THROWS_WITH(OutputFile(folder / "stdout"), Catch::Contains("stdout") && Catch::Contains("found a link to what a process has open"));
  CHECK(fs::is_fifo(folder / "null"));
  CHECK(fs::is_symlink(folder / "link"));
  CHECK(fs::is_symlink(folder / "stdout"));
  CHECK(bytes_of(folder / "redirected") == "x");
}

TEST_CASE("A place where no folder can be written is an IoError that names it") {
  const TempFolder folder;
  const size_t descriptors = open_descriptors();
  std::ofstream(folder / "file") << "x";
  std::ofstream(folder / "taken.partial") << "x";
  REQUIRE_THROWS_WITH(OutputFolder(folder / "missing" / "g.zarr", kMark), Catch::Contains("there is no folder") && Catch::Contains("missing"));
  REQUIRE_THROWS_WITH(OutputFolder(folder / "file", kMark), Catch::Contains("found a file"));
  REQUIRE_THROWS_WITH(OutputFolder(folder / "taken", kMark), Catch::Contains("taken.partial") && Catch::Contains("remove it"));
  for (const fs::path& path : {folder / "file" / "g.zarr", fs::path("/proc/nowhere/g.zarr"), folder / std::string(300, 'n')}) {
    INFO(path);
    REQUIRE_THROWS_AS(OutputFolder(path, kMark), IoError);
  }
  REQUIRE(bytes_of(folder / "taken.partial") == "x");
  OutputFolder out(folder / "g.zarr", kMark);
  out.write("a", some_bytes(1));
  REQUIRE_THROWS_AS(out.write("a/b", some_bytes(1)), IoError);  // "a" is a file
  REQUIRE(open_descriptors() == descriptors + 1);
}

TEST_CASE("A disk that is full while a folder is written is an IoError that names the file, and leaves no debris") {
  const TempFolder folder;
  const size_t descriptors = open_descriptors();
  const FileSizeLimit limit(64 << 10);
  const auto write = [&] {
    OutputFolder out(folder / "g.zarr", kMark);
    write_some(out, 100 << 10);
    out.commit();
  };
  REQUIRE_THROWS_AS(write(), IoError);
  REQUIRE_THROWS_WITH(write(), Catch::Contains("0/c/0") && Catch::Contains("too large"));
  REQUIRE(fs::is_empty(folder.path()));
  REQUIRE(open_descriptors() == descriptors);
}

TEST_CASE("A folder whose files can't be made durable does not appear; one whose name can't be is reported in place") {
  const TempFolder folder;
  const size_t descriptors = open_descriptors();
  for (const bool older : {false, true})
    for (const int error : {EIO, EINVAL, EOPNOTSUPP, ENOSPC, 0})
      for (const bool name_only : {false, true}) {
        INFO("error " << error << " of " << (name_only ? "the name" : "what is in it") << ", older " << older);
        if (older) {
          OutputFolder before(folder / "g.zarr", kMark);
          before.write(kMark, {});
          before.commit();
        }
        bool in_place = true;
        {
          OutputFolder out(folder / "g.zarr", kMark);
          write_some(out, 1000);
          failing_folder = name_only ? folder.path() : out.path() / "0" / "c";
          folder_error = error;
          const bool reported = error == EIO || error == ENOSPC;
          in_place = !reported || name_only;
          if (reported && name_only) CHECK_THROWS_WITH(out.commit(), Catch::Contains("g.zarr") && Catch::Contains("in place"));
          else if (reported) CHECK_THROWS_WITH(out.commit(), Catch::Contains("durable") && !Catch::Contains("in place"));
          else CHECK_NOTHROW(out.commit());
          folder_error = 0;
          failing_folder.clear();
        }
        if (in_place) REQUIRE(files_in(folder / "g.zarr").size() == 4);
        else REQUIRE(fs::exists(folder / "g.zarr") == older);
        if (older && !in_place) REQUIRE(files_in(folder / "g.zarr").size() == 1);
        REQUIRE_FALSE(fs::exists(folder / "g.zarr.partial"));
        fs::remove_all(folder / "g.zarr");
      }
  REQUIRE(open_descriptors() == descriptors);
}

TEST_CASE("Meshing onto a full disk is an IoError and leaves no debris") {
  const TempFolder folder, output;
  const Axis axis = Axis::uniform(-1.1, 2.2 / 40, 0, 40, 0.5);
  const mesher::Scene scene = scene_of(folder, {{shapes::sphere({0, 0, 0}, 1, 4)}}, {{axis, axis, axis}});
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
