#include "store/base/spill.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include <fmt/format.h>
#include <sys/statvfs.h>

#include "store/base/error.hpp"
#include "store/base/system/system.hpp"

namespace teracell::inline store {

std::filesystem::path temporary_folder() {
  const char* const named = std::getenv("TMPDIR");
  return named != nullptr && *named != '\0' ? named : "/tmp";
}

SpillFile::SpillFile(const std::filesystem::path& folder, uint64_t expected, bool in_memory) : folder_(folder.string()) {
  if (in_memory) file_ = Descriptor(system::file_in_memory());
  in_memory_ = bool{file_};
  if (in_memory_) {
    folder_ = "memory";  // for messages
    return;
  }
  struct statvfs disk;
  if (::statvfs(folder_.c_str(), &disk) != 0)
    throw IoError(fmt::format("{}: no folder for temporary files: {}", folder_, std::strerror(errno)), Remedy::kOtherFolder);
  if (const uint64_t room = uint64_t{disk.f_bavail} * disk.f_frsize; room < expected)
    throw IoError(fmt::format("{}: expected {} bytes of free space for temporary files, found {}", folder_, expected, room),
                  Remedy::kOtherFolderOrMoreMemory);
  file_ = Descriptor(system::file_without_name(folder));
  if (!file_) throw IoError(fmt::format("{}: can't create a temporary file: {}", folder_, std::strerror(errno)), Remedy::kOtherFolder);
}

void SpillFile::write(uint64_t offset, std::span<const uint8_t> bytes) {
  if (const size_t done = file_.write(offset, bytes); done < bytes.size())
    throw IoError(fmt::format("{}: can't write byte {} of a temporary file: {}", folder_, offset + done, std::strerror(errno)),
                  Remedy::kOtherFolderOrMoreMemory);
}

void SpillFile::read(uint64_t offset, std::span<uint8_t> out) const {
  if (const size_t done = file_.read(offset, out); done < out.size())
    throw IoError(fmt::format("{}: can't read byte {} of a temporary file: {}", folder_, offset + done,
                              errno != 0 ? std::strerror(errno) : "it has become shorter"));
}

}  // namespace teracell::store
