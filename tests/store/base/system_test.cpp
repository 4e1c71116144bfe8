// What Linux has, and what stands in for it elsewhere: both do what is said of them.
#include "store/base/system/system.hpp"

#include <fcntl.h>
#include <unistd.h>

#include "store/base/descriptor.hpp"
#include "tests/support/descriptors.hpp"
#include "tests/support/meshed.hpp"

namespace teracell {
namespace {

using namespace testing;

// The functions of one of the two.
struct System {
  const char* name;
  int (*cores)();
  uint64_t (*memory)();
  uint64_t (*resident_bytes)();
  uint64_t (*peak_bytes)();
  uint64_t (*open_descriptors)();
  int (*file_without_name)(const std::filesystem::path&);
  int (*rename_folder)(const std::filesystem::path&, const std::filesystem::path&, bool);
};
#define SYSTEM(name)                                                                                                                               \
  System {                                                                                                                                         \
    #name, name::cores, name::memory, name::resident_bytes, name::peak_bytes, name::open_descriptors, name::file_without_name, name::rename_folder \
  }
const System kSystems[] = {
    SYSTEM(portable),
#ifdef __linux__
    SYSTEM(linux_only),
#endif
};

void write(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

TEST_CASE("A system says what this process has and takes") {
  for (const System& s : kSystems) {
    CAPTURE(s.name);
    CHECK(s.cores() >= 1);
    CHECK(s.memory() > uint64_t{1} << 26);
    CHECK(s.resident_bytes() > uint64_t{1} << 20);
    CHECK(s.peak_bytes() >= s.resident_bytes() / 2);
    const uint64_t before = s.open_descriptors();
    const Descriptor one(::open("/dev/null", O_RDONLY | O_CLOEXEC)), two(::open("/dev/null", O_RDONLY | O_CLOEXEC));
    CHECK(s.open_descriptors() == before + 2);
  }
}

TEST_CASE("A file without a name can be written and read, and leaves nothing in its folder") {
  const TempFolder folder;
  for (const System& s : kSystems) {
    CAPTURE(s.name);
    const Descriptor file(s.file_without_name(folder.path()));
    REQUIRE(file);
    CHECK(std::filesystem::is_empty(folder.path()));
    CHECK((::fcntl(file.get(), F_GETFD) & FD_CLOEXEC) != 0);
    const Bytes bytes = {1, 2, 3};
    CHECK(file.write(5, bytes) == 3);
    Bytes found(3);
    CHECK(file.read(5, found) == 3);
    CHECK(found == bytes);
    CHECK(s.file_without_name(folder / "nowhere") < 0);
    CHECK(errno == ENOENT);
  }
  CHECK(portable::file_in_memory() < 0);
}

TEST_CASE("A folder takes another name, or changes names with the one that has it") {
  for (const System& s : kSystems) {
    CAPTURE(s.name);
    const TempFolder folder;
    write(folder / "new/file", "new");
    CHECK(s.rename_folder(folder / "new", folder / "name", false) == 0);
    CHECK(bytes_of(folder / "name/file") == "new");
    write(folder / "newer/file", "newer");
    CHECK(s.rename_folder(folder / "newer", folder / "name", true) == 0);
    CHECK(bytes_of(folder / "name/file") == "newer");
    CHECK(bytes_of(folder / "newer/file") == "new");
    CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 2);
    CHECK(s.rename_folder(folder / "nothing", folder / "name", true) == ENOENT);
    CHECK(bytes_of(folder / "name/file") == "newer");
    CHECK(s.rename_folder(folder / "nothing", folder / "other", false) == ENOENT);
  }
}

}  // namespace
}  // namespace teracell
