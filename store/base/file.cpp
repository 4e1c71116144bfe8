#include "store/base/file.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace teracell::inline store {
namespace {

constexpr size_t kBuffer = 1 << 20;

using std::filesystem::path;

[[noreturn]] void fail_at(const path& where, const char* what, int error) {
  throw IoError(fmt::format("{}: {}: {}", where.string(), what, std::strerror(error)), error);
}

[[noreturn]] void fail_to_create(const path& partial, const path& target, int error) {
  std::error_code ignored;
  const path folder = target.parent_path();
  if (error == ENOENT && !folder.empty() && !std::filesystem::exists(folder, ignored))
    throw IoError(fmt::format("{}: can't create: there is no folder '{}'", partial.string(), folder.string()));
  fail_at(partial, "can't create", error);
}

// Closes `fd` and throws when another writer has the lock, or when the file system has none to give, as Lustre without the option `flock`.
void lock(int fd, const path& partial, const path& target, const char* kind) {
  if (::flock(fd, LOCK_EX | LOCK_NB) == 0) return;
  const int error = errno;
  ::close(fd);
  if (error != EWOULDBLOCK) fail_at(partial, "can't lock", error);
  throw IoError(fmt::format("{}: another process is writing this {} (it holds the lock on {})", target.string(), kind, partial.string()));
}

// Between open and flock the former owner may have renamed or removed what is open as `fd`: then the lock is on another inode.
void expect_still_there(int fd, const path& partial, const path& target, const char* kind) {
  struct stat ours, there;
  if (::fstat(fd, &ours) == 0 && ::stat(partial.c_str(), &there) == 0 && ours.st_ino == there.st_ino) return;
  ::close(fd);
  throw IoError(fmt::format("{}: another process has just written this {}: try again", target.string(), kind));
}

bool write_all(int fd, std::span<const uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    bytes = bytes.subspan(static_cast<size_t>(n));
  }
  return true;
}

void pwrite_all(int fd, const path& partial, uint64_t offset, std::span<const uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::pwrite(fd, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw IoError(fmt::format("{}: byte {}: can't write: {}", partial.string(), offset, std::strerror(errno)));
    offset += static_cast<uint64_t>(n);
    bytes = bytes.subspan(static_cast<size_t>(n));
  }
}

// Makes the names in a folder durable. Returns the error, or 0.
int sync_folder(const path& folder) {
  const int dir = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const int error = dir >= 0 && ::fsync(dir) == 0 ? 0 : errno;
  if (dir >= 0) ::close(dir);
  // A folder may forbid reading, and not every file system can sync one: nothing more can be done there.
  return (dir < 0 && error == EACCES) || error == EINVAL || error == EOPNOTSUPP ? 0 : error;
}

// Makes the name `target` durable. Returns the error, or 0.
int sync_name(const path& target) { return sync_folder(target.has_parent_path() ? target.parent_path() : "."); }

[[noreturn]] void fail_in_place(const path& target, const char* kind, int error) {
  throw IoError(fmt::format("{}: the {} is complete and in place, but may not outlive a power failure: can't make its folder durable: {}",
                            target.string(), kind, std::strerror(error)));
}

// Makes all files and folders below `folder` durable, and then the folder itself.
void sync_all(const path& folder) {
  std::error_code error;
  for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (at->symlink_status().type() == std::filesystem::file_type::directory) {
      sync_all(at->path());
      continue;
    }
    const int fd = ::open(at->path().c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    const int failed = fd >= 0 && ::fsync(fd) == 0 ? 0 : errno;
    if (fd >= 0) ::close(fd);
    if (failed != 0) fail_at(at->path(), "can't make durable (fsync)", failed);
  }
  if (error) fail_at(folder, "can't list", error.value());
  if (const int failed = sync_folder(folder)) fail_at(folder, "can't make durable (fsync)", failed);
}

// Makes the temporary file, or opens one that is `left` there, and locks it. Returns its descriptor. What is opened for reading as well may
// lose what others write (FileRoom): a network file system would read the page around what is written, and write all of it back.
int open_partial(const path& partial, const path& target, bool reads, bool& left) {
  const int flags = (reads ? O_RDWR : O_WRONLY) | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;
  int fd = ::open(partial.c_str(), flags | O_EXCL, 0666);
  left = fd < 0 && errno == EEXIST;
  if (left) fd = ::open(partial.c_str(), flags, 0666);
  // Anything else under this name belongs to someone: a pipe, or a file that has another name as well.
  const auto refuse = [&] {
    throw IoError(fmt::format("{}: expected no file, or one that a killed run has left; found something else: remove it", partial.string()));
  };
  if (fd < 0 && errno == ENXIO) refuse();  // a pipe that nobody reads
  if (fd < 0) fail_to_create(partial, target, errno);
  lock(fd, partial, target, "file");
  struct stat found;
  if (::fstat(fd, &found) != 0 || !S_ISREG(found.st_mode) || found.st_nlink > 1) {
    ::close(fd);
    refuse();
  }
  expect_still_there(fd, partial, target, "file");
  return fd;
}

const char* kind_of(const std::filesystem::file_status& found) {
  if (std::filesystem::is_directory(found)) return "a folder";
  return std::filesystem::is_regular_file(found) ? "a file" : "a device or a pipe";
}

}  // namespace

FileState state_of(const struct stat& s) {
  return {s.st_dev, s.st_ino, static_cast<uint64_t>(s.st_size), int64_t{s.st_mtim.tv_sec} * 1'000'000'000 + s.st_mtim.tv_nsec};
}

// O_NONBLOCK: a pipe is refused, not waited for.
InputFile::InputFile(const std::filesystem::path& path) : name_(path.string()), fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
  if (fd_ < 0) fail_at(name_, "can't open", errno);
  struct stat st;
  if (::fstat(fd_, &st) != 0 || !S_ISREG(st.st_mode)) {
    ::close(fd_);
    throw IoError(fmt::format("{}: expected a file, found {}", name_, S_ISDIR(st.st_mode) ? "a folder" : "a device or a pipe"));
  }
  state_ = state_of(st);
}

InputFile::~InputFile() { ::close(fd_); }

void InputFile::read(uint64_t offset, std::span<uint8_t> out) const {
  for (size_t done = 0; done < out.size();) {
    const ssize_t n = ::pread(fd_, out.data() + done, out.size() - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail_at(name_, fmt::format("byte {}: can't read", offset + done).c_str(), errno);
    if (n == 0) throw IoError(fmt::format("{}: byte {}: expected {} more bytes, found the end of the file", name_, offset + done, out.size() - done));
    done += static_cast<size_t>(n);
  }
}

// The rename would replace a device by a file: root must not lose /dev/null. /dev/stdout is a link to what a process has open, which may be
// a file: the rename would replace the link.
void expect_file_name(const std::filesystem::path& target) {
  std::error_code ignored;  // open() will tell what else is wrong with the target
  if (const auto found = std::filesystem::status(target, ignored); std::filesystem::exists(found) && !std::filesystem::is_regular_file(found))
    throw IoError(fmt::format("{}: expected the name of a file, found {}", target.string(), kind_of(found)));
  if (std::filesystem::read_symlink(target, ignored).string().starts_with("/proc/"))
    throw IoError(fmt::format("{}: expected the name of a file, found a link to what a process has open", target.string()));
}

OutputFile::OutputFile(const std::filesystem::path& target, uint64_t keep, bool reads) : target_(target), partial_(target.string() + ".partial") {
  expect_file_name(target_);
  reads = reads || keep > 0;
  bool left;
  fd_ = open_partial(partial_, target_, reads, left);
  if (left && keep == 0) {
    // Processes of a killed job may still write to its file by way of a FileRoom, so it is not used again.
    const int error = ::unlink(partial_.c_str()) == 0 ? 0 : errno;
    ::close(fd_);
    if (error != 0) fail_at(partial_, "can't remove what a killed run has left", error);
    fd_ = open_partial(partial_, target_, reads, left);
  }
  struct stat ours;
  if (::fstat(fd_, &ours) != 0) ours.st_size = 0;
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
  if (bytes.size() >= kBuffer) {  // copying them would double the memory
    flush();
    if (!write_all(fd_, bytes)) fail("can't write");
    size_ += bytes.size();
    begin_write_back();
    return;
  }
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  size_ += bytes.size();
  if (buffer_.size() >= kBuffer) flush();
}

void OutputFile::write_at(uint64_t offset, std::span<const uint8_t> bytes) {
  if (bytes.empty()) return;
  pwrite_all(fd_, partial_, offset, bytes);
  size_ = std::max(size_, offset + bytes.size());
}

void OutputFile::skip(uint64_t bytes) {
  flush();
  if (::lseek(fd_, static_cast<off_t>(bytes), SEEK_CUR) < 0) fail("can't write");
  size_ += bytes;
}

void OutputFile::flush() {
  if (!write_all(fd_, buffer_)) fail("can't write");
  buffer_.clear();
  begin_write_back();
}

// The disk begins to write while the rest is made, so there is less to wait for at the end. It is only a hint.
void OutputFile::begin_write_back() {
#ifdef __linux__
  constexpr uint64_t kStretch = uint64_t{8} << 20;
  const uint64_t written = size_ - buffer_.size();
  if (written - written_back_ < kStretch) return;
  ::sync_file_range(fd_, static_cast<off_t>(written_back_), static_cast<off_t>(written - written_back_), SYNC_FILE_RANGE_WRITE);
  written_back_ = written;
#endif
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

void OutputFile::commit(bool durable) {
  flush();
  if (durable && ::fsync(fd_) != 0) fail("can't make durable (fsync)");
  struct stat ours, there;
  if (::fstat(fd_, &ours) != 0 || ::stat(partial_.c_str(), &there) != 0 || ours.st_ino != there.st_ino) {
    ::close(std::exchange(fd_, -1));  // what has the name now belongs to another process
    throw IoError(fmt::format("{}: another process has removed what this one was writing to it", partial_.string()));
  }
  if (::rename(partial_.c_str(), target_.c_str()) != 0) fail("can't rename to its final name");
  ::close(fd_);
  fd_ = -1;
  if (const int error = durable ? sync_name(target_) : 0) fail_in_place(target_, "file", error);
}

// Not for reading as well, as in open_partial().
FileRoom::FileRoom(const std::filesystem::path& target)
    : partial_(target.string() + ".partial"), fd_(::open(partial_.c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW)) {
  if (fd_ < 0) fail_at(partial_, "can't open", errno);
}

FileRoom::~FileRoom() { ::close(fd_); }

void FileRoom::write_at(uint64_t offset, std::span<const uint8_t> bytes) const { pwrite_all(fd_, partial_, offset, bytes); }

void FileRoom::sync() const {
  if (::fsync(fd_) != 0) fail_at(partial_, "can't make durable (fsync)", errno);
}

OutputFolder::OutputFolder(const std::filesystem::path& target, std::string mark)
    : target_(target.has_filename() ? target : target.parent_path()), partial_(target_.string() + ".partial"), mark_(std::move(mark)) {
  expect_replaceable();
  if (::mkdir(partial_.c_str(), 0777) != 0 && errno != EEXIST) fail_to_create(partial_, target_, errno);
  fd_ = ::open(partial_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
  if (fd_ < 0 && (errno == ENOTDIR || errno == ELOOP))
    throw IoError(fmt::format("{}: expected no file, or a folder that a killed run has left; found something else: remove it", partial_.string()));
  if (fd_ < 0) fail_to_create(partial_, target_, errno);
  lock(fd_, partial_, target_, "folder");
  expect_still_there(fd_, partial_, target_, "folder");
  std::error_code error;
  for (std::filesystem::directory_iterator at(partial_, error), end; !error && at != end;) {
    std::filesystem::remove_all(at->path(), error);
    if (!error) at.increment(error);
  }
  if (!error) return;
  ::close(fd_);
  fail_at(partial_, "can't empty", error.value());
}

OutputFolder::~OutputFolder() {
  if (fd_ < 0) return;
  std::error_code ignored;
  std::filesystem::remove_all(partial_, ignored);
  ::close(fd_);
}

void OutputFolder::expect_replaceable() const {
  std::error_code ignored;  // making the folder will tell
  const auto found = std::filesystem::status(target_, ignored);
  if (!std::filesystem::exists(found)) return;
  if (!std::filesystem::is_directory(found))
    throw IoError(fmt::format("{}: expected the name of a folder, found {}", target_.string(), kind_of(found)));
  if (!std::filesystem::is_empty(target_, ignored) && !std::filesystem::is_regular_file(target_ / mark_, ignored))
    throw IoError(fmt::format("{}: expected a new name, or a folder that may be replaced because it holds a file '{}'; found another folder",
                              target_.string(), mark_));
}

void OutputFolder::write(const std::filesystem::path& name, std::span<const uint8_t> bytes) const {
  const std::filesystem::path file = partial_ / name;
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  if (error) fail_at(file.parent_path(), "can't create", error.value());
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (fd < 0) fail_at(file, "can't create", errno);
  const int failed = write_all(fd, bytes) ? 0 : errno;
  ::close(fd);
  if (failed != 0) fail_at(file, "can't write", failed);
}

void OutputFolder::commit() {
  sync_all(partial_);
  expect_replaceable();  // once more, since a run may take hours
  // The older folder takes the temporary name before it is removed, so its lock keeps other writers away from it.
  std::error_code ignored;
  const bool replaces = std::filesystem::exists(std::filesystem::symlink_status(target_, ignored));
  const int old = replaces ? ::open(target_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;
  if (old >= 0) lock(old, target_, target_, "folder");
  if (::renameat2(AT_FDCWD, partial_.c_str(), AT_FDCWD, target_.c_str(), replaces ? RENAME_EXCHANGE : 0) != 0) {
    const int error = errno;
    if (old >= 0) ::close(old);
    fail_at(partial_, "can't rename to its final name", error);
  }
  ::close(fd_);
  fd_ = -1;
  const int unsynced = sync_name(target_);  // before the older folder goes
  std::error_code error;
  if (replaces) std::filesystem::remove_all(partial_, error);
  if (old >= 0) ::close(old);
  if (unsynced != 0) fail_in_place(target_, "folder", unsynced);
  if (error)
    throw IoError(fmt::format("{}: the folder is complete and in place, but the older one is left as {}: can't remove it: {}", target_.string(),
                              partial_.string(), error.message()));
}

}  // namespace teracell::store
