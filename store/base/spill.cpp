#include "store/base/spill.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "store/base/error.hpp"

namespace teracell::inline store {

SpillFile::SpillFile(const std::filesystem::path& folder, uint64_t expected, bool in_memory) : folder_(folder.string()) {
  if (in_memory) fd_ = ::memfd_create("teracell", MFD_CLOEXEC);
  in_memory_ = fd_ >= 0;
  if (in_memory_) return;
  struct statvfs disk;
  if (::statvfs(folder_.c_str(), &disk) != 0)
    throw IoError(fmt::format("{}: no folder for temporary files: {}", folder_, std::strerror(errno)), Remedy::kOtherFolder);
  if (const uint64_t room = uint64_t{disk.f_bavail} * disk.f_frsize; room < expected)
    throw IoError(fmt::format("{}: expected {} bytes of free space for temporary files, found {}", folder_, expected, room),
                  Remedy::kOtherFolderOrMoreMemory);
  fd_ = ::open(folder_.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (fd_ < 0) {  // not every file system supports files without names
    std::string name = (folder / "teracell-XXXXXX").string();
    fd_ = ::mkostemp(name.data(), O_CLOEXEC);
    if (fd_ < 0) throw IoError(fmt::format("{}: can't create a temporary file: {}", folder_, std::strerror(errno)), Remedy::kOtherFolder);
    ::unlink(name.c_str());
  }
}

SpillFile::~SpillFile() { ::close(fd_); }

void SpillFile::write(uint64_t offset, std::span<const uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::pwrite(fd_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0)
      throw IoError(fmt::format("{}: can't write byte {} of a temporary file: {}", folder_, offset, std::strerror(errno)),
                    Remedy::kOtherFolderOrMoreMemory);
    offset += static_cast<uint64_t>(n);
    bytes = bytes.subspan(static_cast<size_t>(n));
  }
}

void SpillFile::read(uint64_t offset, std::span<uint8_t> out) const {
  while (!out.empty()) {
    const ssize_t n = ::pread(fd_, out.data(), out.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0)
      throw IoError(
          fmt::format("{}: can't read byte {} of a temporary file: {}", folder_, offset, n < 0 ? std::strerror(errno) : "it has become shorter"));
    offset += static_cast<uint64_t>(n);
    out = out.subspan(static_cast<size_t>(n));
  }
}

}  // namespace teracell::store
