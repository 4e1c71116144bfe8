#include "store/base/file.hpp"

#include <cerrno>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

namespace teracell::inline store {

FileState state_of(const struct stat& s) {
  return {s.st_dev, s.st_ino, static_cast<uint64_t>(s.st_size), int64_t{s.st_mtim.tv_sec} * 1'000'000'000 + s.st_mtim.tv_nsec};
}

// O_NONBLOCK: a pipe is refused, not waited for.
InputFile::InputFile(const std::filesystem::path& path) : name_(path.string()), file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
  if (!file_) fail_at(name_, "can't open", errno);
  struct stat st;
  if (::fstat(file_.get(), &st) != 0) fail_at(name_, "can't open", errno);
  if (S_ISDIR(st.st_mode)) throw IoError(fmt::format("{}: expected a file, found a folder", name_), EISDIR);
  if (!S_ISREG(st.st_mode)) throw IoError(fmt::format("{}: expected a file, found a device or a pipe", name_));
  state_ = state_of(st);
}

void InputFile::read(uint64_t offset, std::span<uint8_t> out) const {
  const size_t done = file_.read(offset, out);
  if (done == out.size()) return;
  if (errno != 0) fail_at(name_, fmt::format("byte {}: can't read", offset + done).c_str(), errno);
  throw IoError(fmt::format("{}: byte {}: expected {} more bytes, found the end of the file", name_, offset + done, out.size() - done));
}

}  // namespace teracell::store
