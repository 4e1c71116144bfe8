#include "store/base/output_file.hpp"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "store/base/error.hpp"
#include "store/base/partial.hpp"
#include "store/base/system/system.hpp"

namespace teracell::inline store {
namespace {

constexpr size_t kBuffer = 1 << 20;

using std::filesystem::path;

void write_or_fail(const Descriptor& file, const path& partial, uint64_t offset, std::span<const uint8_t> bytes) {
  if (const size_t done = file.write(offset, bytes); done < bytes.size())
    throw IoError(fmt::format("{}: byte {}: can't write: {}", partial.string(), offset + done, std::strerror(errno)));
}

// Makes the temporary file, or opens one that is `left` there, and locks it. What is opened for reading as well may
// lose what others write (FileRoom): a network file system would read the page around what is written, and write all of it back.
Descriptor open_partial(const path& partial, const path& target, bool reads, bool& left) {
  const int flags = (reads ? O_RDWR : O_WRONLY) | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;
  Descriptor file(::open(partial.c_str(), flags | O_EXCL, 0666));
  left = !file && errno == EEXIST;
  if (left) file = Descriptor(::open(partial.c_str(), flags, 0666));
  // Anything else under this name belongs to someone: a pipe, or a file that has another name as well.
  const auto refuse = [&] {
    throw IoError(fmt::format("{}: expected no file, or one that a killed run has left; found something else: remove it", partial.string()));
  };
  if (!file && errno == ENXIO) refuse();  // a pipe that nobody reads
  if (!file) fail_to_create(partial, target, errno);
  lock(file, partial, target, "file");
  struct stat found;
  if (::fstat(file.get(), &found) != 0 || !S_ISREG(found.st_mode) || found.st_nlink > 1) refuse();
  expect_still_there(file, partial, target, "file");
  return file;
}

}  // namespace

// The rename would replace a device by a file: root must not lose /dev/null. /dev/stdout is a link to what a process has open, which may be
// a file: the rename would replace the link.
void expect_file_name(const std::filesystem::path& target) {
  std::error_code ignored;  // open() will tell what else is wrong with the target
  if (const auto found = std::filesystem::status(target, ignored); std::filesystem::exists(found) && !std::filesystem::is_regular_file(found))
    throw IoError(fmt::format("{}: expected the name of a file, found {}", target.string(), kind_of(found)));
  if (std::filesystem::read_symlink(target, ignored).string().starts_with("/proc/"))
    throw IoError(fmt::format("{}: expected the name of a file, found a link to what a process has open", target.string()));
}

bool left_behind(const std::filesystem::path& target) {
  const path partial = target.string() + ".partial";
  const Descriptor file(::open(partial.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  struct stat found;
  return file && ::fstat(file.get(), &found) == 0 && S_ISREG(found.st_mode) && ::flock(file.get(), LOCK_SH | LOCK_NB) == 0;
}

OutputFile::OutputFile(const std::filesystem::path& target, uint64_t keep, bool reads) : target_(target), partial_(target.string() + ".partial") {
  expect_file_name(target_);
  reads = reads || keep > 0;
  bool left;
  file_ = open_partial(partial_, target_, reads, left);
  if (left && keep == 0) {
    // Processes of a killed job may still write to its file by way of a FileRoom, so it is not used again.
    if (::unlink(partial_.c_str()) != 0) fail_at(partial_, "can't remove what a killed run has left", errno);
    file_ = open_partial(partial_, target_, reads, left);
  }
  struct stat ours;
  if (::fstat(file_.get(), &ours) != 0) ours.st_size = 0;
  if (keep > static_cast<uint64_t>(ours.st_size))
    throw IoError(fmt::format("{}: expected the first {} bytes of a run to resume, found {}", partial_.string(), keep, ours.st_size));
  if (::ftruncate(file_.get(), static_cast<off_t>(keep)) != 0 || ::lseek(file_.get(), static_cast<off_t>(keep), SEEK_SET) < 0)
    throw IoError(fmt::format("{}: can't empty: {}", partial_.string(), std::strerror(errno)));
  size_ = keep;
  buffer_.reserve(kBuffer);
}

OutputFile::~OutputFile() {
  if (file_) ::unlink(partial_.c_str());
}

void OutputFile::fail(const char* what) const {
  throw IoError(fmt::format("{}: byte {}: {}: {}", partial_.string(), size_ - buffer_.size(), what, std::strerror(errno)));
}

void OutputFile::append(std::span<const uint8_t> bytes) {
  if (bytes.size() >= kBuffer) {  // copying them would double the memory
    flush();
    if (!file_.append(bytes)) fail("can't write");
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
  write_or_fail(file_, partial_, offset, bytes);
  size_ = std::max(size_, offset + bytes.size());
}

void OutputFile::skip(uint64_t bytes) {
  flush();
  if (::lseek(file_.get(), static_cast<off_t>(bytes), SEEK_CUR) < 0) fail("can't write");
  size_ += bytes;
}

void OutputFile::flush() {
  if (!file_.append(buffer_)) fail("can't write");
  buffer_.clear();
  begin_write_back();
}

// The disk begins to write while the rest is made, so there is less to wait for at the end. It is only a hint.
void OutputFile::begin_write_back() {
  constexpr uint64_t kStretch = uint64_t{8} << 20;
  const uint64_t written = size_ - buffer_.size();
  if (written - written_back_ < kStretch) return;
  system::begin_write_back(file_.get(), written_back_, written - written_back_);
  written_back_ = written;
}

void OutputFile::read_kept(uint64_t offset, std::span<uint8_t> out) const {
  if (const size_t done = file_.read(offset, out); done < out.size())
    throw IoError(fmt::format("{}: byte {}: can't read: {}", partial_.string(), offset + done, errno != 0 ? std::strerror(errno) : "end of file"));
}

void OutputFile::abandon() { file_.close(); }

void OutputFile::sync() {
  flush();
  if (::fsync(file_.get()) != 0) fail("can't make durable (fsync)");
}

void OutputFile::commit(bool durable) {
  flush();
  if (durable && ::fsync(file_.get()) != 0) fail("can't make durable (fsync)");
  if (!is_still_there(file_, partial_)) {
    file_.close();  // what has the name now belongs to another process
    throw IoError(fmt::format("{}: another process has removed what this one was writing to it", partial_.string()));
  }
  if (::rename(partial_.c_str(), target_.c_str()) != 0) fail("can't rename to its final name");
  file_.close();
  if (const int error = durable ? sync_name(target_) : 0) fail_in_place(target_, "file", error);
}

// Not for reading as well, as in open_partial().
FileRoom::FileRoom(const std::filesystem::path& target)
    : partial_(target.string() + ".partial"), file_(::open(partial_.c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW)) {
  if (!file_) fail_at(partial_, "can't open", errno);
}

void FileRoom::write_at(uint64_t offset, std::span<const uint8_t> bytes) const { write_or_fail(file_, partial_, offset, bytes); }

void FileRoom::sync() const {
  if (::fsync(file_.get()) != 0) fail_at(partial_, "can't make durable (fsync)", errno);
}

}  // namespace teracell::store
