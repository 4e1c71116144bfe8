#include "store/file.hpp"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace teracell {
namespace {

constexpr size_t kBuffer = 1 << 20;

}  // namespace

InputFile::InputFile(const std::filesystem::path& path) : name_(path.string()), fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (fd_ < 0) throw IoError(fmt::format("{}: can't open: {}", name_, std::strerror(errno)));
  struct stat st;
  if (::fstat(fd_, &st) != 0 || !S_ISREG(st.st_mode)) {
    ::close(fd_);
    throw IoError(fmt::format("{}: expected a file, found {}", name_, S_ISDIR(st.st_mode) ? "a folder" : "a device or a pipe"));
  }
  size_ = static_cast<uint64_t>(st.st_size);
}

InputFile::~InputFile() { ::close(fd_); }

void InputFile::read(uint64_t offset, std::span<uint8_t> out) const {
  for (size_t done = 0; done < out.size();) {
    const ssize_t n = ::pread(fd_, out.data() + done, out.size() - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw IoError(fmt::format("{}: byte {}: can't read: {}", name_, offset + done, std::strerror(errno)));
    if (n == 0) throw IoError(fmt::format("{}: byte {}: expected {} more bytes, found the end of the file", name_, offset + done, out.size() - done));
    done += static_cast<size_t>(n);
  }
}

OutputFile::OutputFile(const std::filesystem::path& target, uint64_t keep) : target_(target), partial_(target.string() + ".partial") {
  std::error_code ignored;  // open() will tell what else is wrong with the target
  // The rename would replace a device by a file: root must not lose /dev/null.
  if (const auto found = std::filesystem::status(target_, ignored); std::filesystem::exists(found) && !std::filesystem::is_regular_file(found))
    throw IoError(fmt::format("{}: expected the name of a file, found {}", target_.string(),
                              std::filesystem::is_directory(found) ? "a folder" : "a device or a pipe"));
  fd_ = ::open(partial_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
  if (fd_ < 0) {
    const int error = errno;
    const std::filesystem::path folder = target_.parent_path();
    const bool no_folder = error == ENOENT && !folder.empty() && !std::filesystem::exists(folder, ignored);
    throw IoError(fmt::format("{}: can't create: {}", partial_.string(),
                              no_folder ? fmt::format("there is no folder '{}'", folder.string()) : std::strerror(error)));
  }
  if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    ::close(fd_);
    throw IoError(fmt::format("{}: another process is writing this file (it holds the lock on {})", target_.string(), partial_.string()));
  }
  // Anything else under this name belongs to someone: a pipe, or a file that has another name as well.
  struct stat ours;
  if (::fstat(fd_, &ours) != 0 || !S_ISREG(ours.st_mode) || ours.st_nlink > 1) {
    ::close(fd_);
    throw IoError(fmt::format("{}: expected no file, or one that a killed run has left; found something else: remove it", partial_.string()));
  }
  // Between open and flock the former owner may have renamed or removed the file: then the lock is on another file's inode.
  struct stat there;
  if (::stat(partial_.c_str(), &there) != 0 || ours.st_ino != there.st_ino) {
    ::close(fd_);
    throw IoError(fmt::format("{}: another process has just written this file: try again", target_.string()));
  }
  if (keep > static_cast<uint64_t>(ours.st_size)) {
    ::close(fd_);
    throw IoError(fmt::format("{}: expected the first {} bytes of a run to resume, found {}", partial_.string(), keep, ours.st_size));
  }
  if (::ftruncate(fd_, static_cast<off_t>(keep)) != 0 || ::lseek(fd_, static_cast<off_t>(keep), SEEK_SET) < 0) {
    ::close(fd_);
    throw IoError(fmt::format("{}: can't empty: {}", partial_.string(), std::strerror(errno)));
  }
  size_ = keep;
  buffer_.reserve(kBuffer);
}

OutputFile::~OutputFile() {
  if (fd_ < 0) return;
  ::unlink(partial_.c_str());
  ::close(fd_);
}

void OutputFile::fail(const char* what) const {
  throw IoError(fmt::format("{}: byte {}: {}: {}", partial_.string(), size_ - buffer_.size(), what, std::strerror(errno)));
}

void OutputFile::append(std::span<const uint8_t> bytes) {
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  size_ += bytes.size();
  if (buffer_.size() >= kBuffer) flush();
}

void OutputFile::flush() {
  for (size_t done = 0; done < buffer_.size();) {
    const ssize_t n = ::write(fd_, buffer_.data() + done, buffer_.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("can't write");
    done += static_cast<size_t>(n);
  }
  buffer_.clear();
}

void OutputFile::read_kept(uint64_t offset, std::span<uint8_t> out) const {
  while (!out.empty()) {
    const ssize_t n = ::pread(fd_, out.data(), out.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw IoError(fmt::format("{}: byte {}: can't read: {}", partial_.string(), offset, n < 0 ? std::strerror(errno) : "end of file"));
    offset += static_cast<uint64_t>(n);
    out = out.subspan(static_cast<size_t>(n));
  }
}

void OutputFile::abandon() {
  ::close(fd_);
  fd_ = -1;
}

void OutputFile::sync() {
  flush();
  if (::fsync(fd_) != 0) fail("can't make durable (fsync)");
}

void OutputFile::commit() {
  flush();
  if (::fsync(fd_) != 0) fail("can't make durable (fsync)");
  if (::rename(partial_.c_str(), target_.c_str()) != 0) fail("can't rename to its final name");
  ::close(fd_);
  fd_ = -1;
  const std::filesystem::path folder = target_.has_parent_path() ? target_.parent_path() : ".";
  const int dir = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const int error = dir >= 0 && ::fsync(dir) == 0 ? 0 : errno;
  if (dir >= 0) ::close(dir);
  // A folder may forbid reading, and not every file system can sync one: nothing more can be done there.
  if (error == 0 || (dir < 0 && error == EACCES) || error == EINVAL || error == EOPNOTSUPP) return;
  throw IoError(fmt::format("{}: the file is complete and in place, but may not outlive a power failure: can't make its folder durable: {}",
                            target_.string(), std::strerror(error)));
}

}  // namespace teracell
