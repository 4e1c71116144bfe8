#include "store/base/system/linux_only.hpp"

#ifdef __linux__
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>

#include <fcntl.h>
#include <malloc.h>
#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

namespace teracell::inline store::linux_only {

std::string core_set() {
  cpu_set_t allowed;
  return ::sched_getaffinity(0, sizeof allowed, &allowed) == 0 ? std::string(reinterpret_cast<const char*>(&allowed), sizeof allowed) : "";
}

int cores() {
  cpu_set_t allowed;  // a rank that is bound to one core takes one
  return ::sched_getaffinity(0, sizeof allowed, &allowed) == 0 ? std::max(1, CPU_COUNT(&allowed)) : portable::cores();
}

// Less than the machine's where a batch system or a container limits the process's control group or one above it.
uint64_t memory() {
  uint64_t out = portable::memory();
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    if (!line.starts_with("0::/")) continue;  // version 2
    for (std::filesystem::path group = line.substr(4);; group = group.parent_path()) {
      uint64_t limit = 0;  // stays 0 for "max"
      if (std::ifstream("/sys/fs/cgroup" / group / "memory.max") >> limit && limit > 0) out = std::min(out, limit);
      if (group.empty()) break;
    }
  }
  return out;
}

uint64_t resident_bytes() {
  uint64_t total = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return resident * static_cast<uint64_t>(::sysconf(_SC_PAGESIZE));
}

// getrusage() has the peak of the program that launched this one, if that was larger.
uint64_t peak_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (uint64_t kib; word == "VmHWM:" && status >> kib) return kib * 1024;
  return 0;
}

uint64_t open_descriptors() {
  std::error_code ignored;
  const std::filesystem::directory_iterator all("/proc/self/fd", ignored);
  return static_cast<uint64_t>(std::distance(begin(all), end(all)));
}

std::filesystem::path own_program() {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  return error ? std::filesystem::path() : self;
}

void limit_heaps([[maybe_unused]] int heaps) {
#ifdef __GLIBC__
  ::mallopt(M_ARENA_MAX, heaps);
#endif
}

void make_heap([[maybe_unused]] size_t bytes) {
#ifdef __GLIBC__
  constexpr size_t kMost = size_t{32} << 20;  // glibc takes no greater threshold
  bytes = std::min(bytes, kMost - kHugePage);
  // A freed block goes back to the system only if it is greater than this, and the free end of a heap only if it is.
  const int threshold = static_cast<int>(bytes + kHugePage);
  ::mallopt(M_MMAP_THRESHOLD, threshold);
  ::mallopt(M_TRIM_THRESHOLD, threshold);
  const auto end = [] { return reinterpret_cast<uintptr_t>(::sbrk(0)); };
  const uintptr_t first = (end() + kHugePage - 1) / kHugePage * kHugePage;
  void* volatile block = std::malloc(bytes);  // volatile: else compilers leave it out
  std::free(block);
  if (const uintptr_t last = end() / kHugePage * kHugePage; last > first)
    prefer_huge_pages(reinterpret_cast<void*>(first), last - first);  // NOLINT(performance-no-int-to-ptr)
#endif
}

void give_back_memory([[maybe_unused]] uint64_t most) {
#ifdef __GLIBC__
  if (resident_bytes() > most) ::malloc_trim(0);
#endif
}

void begin_write_back(int file, uint64_t offset, uint64_t bytes) {
  ::sync_file_range(file, static_cast<off_t>(offset), static_cast<off_t>(bytes), SYNC_FILE_RANGE_WRITE);
}

// Before Linux 5.14 the kernel can't do this, and pages come one by one.
void populate([[maybe_unused]] void* memory, [[maybe_unused]] size_t bytes) {
#ifdef MADV_POPULATE_WRITE
  const auto page = static_cast<uintptr_t>(::sysconf(_SC_PAGESIZE));
  const uintptr_t first = (reinterpret_cast<uintptr_t>(memory) + page - 1) / page * page,
                  last = (reinterpret_cast<uintptr_t>(memory) + bytes) / page * page;
  if (last > first) ::madvise(reinterpret_cast<void*>(first), last - first, MADV_POPULATE_WRITE);  // NOLINT(performance-no-int-to-ptr)
#endif
}

namespace {

// Bytes of free memory in pieces of a huge page or more. 0: not known.
uint64_t free_huge_pages() {
  constexpr uint64_t kPage = 4096;  // other machines have huge pages of other sizes
  if (::sysconf(_SC_PAGESIZE) != kPage) return 0;
  const int file = ::open("/proc/buddyinfo", O_RDONLY | O_CLOEXEC);  // "Node 0, zone   Normal    6008  53011 ..."
  if (file < 0) return 0;
  char text[4096];
  const ssize_t length = ::read(file, text, sizeof text - 1);
  ::close(file);
  text[std::max<ssize_t>(length, 0)] = 0;
  uint64_t bytes = 0;
  for (const char* line = std::strstr(text, "zone"); line != nullptr; line = std::strstr(line, "zone")) {
    line += std::strcspn(line, " ");
    line += std::strspn(line, " ");
    line += std::strcspn(line, " \n");  // behind the zone's name: how many pieces of one page are free, of two pages, of four
    char* rest = nullptr;
    for (uint64_t size = kPage; *line == ' ' && size <= kPage << 20; size *= 2, line = rest) {
      const unsigned long long pieces = std::strtoull(line, &rest, 10);
      if (rest == line) break;
      if (size >= kHugePage) bytes += pieces * size;
    }
  }
  return bytes;
}

}  // namespace

void prefer_huge_pages([[maybe_unused]] void* memory, [[maybe_unused]] size_t bytes) {
#ifdef MADV_HUGEPAGE
  constexpr uint64_t kOthers = uint64_t{1} << 27;  // for whoever else asks at the same time
  if (free_huge_pages() >= bytes + kOthers) ::madvise(memory, bytes, MADV_HUGEPAGE);
#endif
}

int file_without_name(const std::filesystem::path& folder) {
  const int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  return file >= 0 ? file : portable::file_without_name(folder);  // not every file system can
}

int file_in_memory() { return ::memfd_create("teracell", MFD_CLOEXEC); }

int rename_folder(const std::filesystem::path& from, const std::filesystem::path& to, bool exchange) {
  return ::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), exchange ? RENAME_EXCHANGE : 0) == 0 ? 0 : errno;
}

}  // namespace teracell::store::linux_only
#endif
