#include "store/base/system/portable.hpp"

#include <algorithm>
#include <cerrno>
#include <string>
#include <thread>

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

namespace teracell::inline store::portable {

int cores() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

std::string core_set() { return {}; }

uint64_t memory() { return static_cast<uint64_t>(::sysconf(_SC_PHYS_PAGES)) * static_cast<uint64_t>(::sysconf(_SC_PAGESIZE)); }

uint64_t peak_bytes() {
  rusage used{};
  if (::getrusage(RUSAGE_SELF, &used) != 0) return 0;
#ifdef __APPLE__
  return static_cast<uint64_t>(used.ru_maxrss);
#else
  return static_cast<uint64_t>(used.ru_maxrss) * 1024;
#endif
}

uint64_t resident_bytes() { return peak_bytes(); }

uint64_t open_descriptors() {
  rlimit limit{};
  ::getrlimit(RLIMIT_NOFILE, &limit);
  uint64_t open = 0;
  const auto most = static_cast<int>(std::min<uint64_t>(limit.rlim_cur, 1 << 16));
  for (int fd = 0; fd < most; ++fd)
    if (::fcntl(fd, F_GETFD) >= 0) ++open;
  return open;
}

std::filesystem::path own_program() { return {}; }

void limit_heaps(int) {}
void make_heap(size_t) {}
void give_back_memory(uint64_t) {}
void begin_write_back(int, uint64_t, uint64_t) {}
void populate(void*, size_t) {}

void prefer_huge_pages(void*, size_t) {}

int file_without_name(const std::filesystem::path& folder) {
  std::string name = (folder / "teracell-XXXXXX").string();
  const int file = ::mkstemp(name.data());
  if (file < 0) return file;
  ::fcntl(file, F_SETFD, FD_CLOEXEC);
  ::unlink(name.c_str());
  return file;
}

int file_in_memory() { return -1; }

// Between the two renames there is no folder of this name, for a moment.
int rename_folder(const std::filesystem::path& from, const std::filesystem::path& to, bool exchange) {
  if (!exchange) return ::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
  const std::filesystem::path aside = from.string() + ".older";
  if (::rename(to.c_str(), aside.c_str()) != 0) return errno;
  if (::rename(from.c_str(), to.c_str()) != 0) {
    const int error = errno;
    ::rename(aside.c_str(), to.c_str());
    return error;
  }
  return ::rename(aside.c_str(), from.c_str()) == 0 ? 0 : errno;
}

}  // namespace teracell::store::portable
