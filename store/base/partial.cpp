#include "store/base/partial.hpp"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "store/base/error.hpp"

namespace teracell::inline store {
namespace {

using std::filesystem::path;

}  // namespace

void fail_to_create(const path& partial, const path& target, int error) {
  std::error_code ignored;
  const path folder = target.parent_path();
  if (error == ENOENT && !folder.empty() && !std::filesystem::exists(folder, ignored))
    throw IoError(fmt::format("{}: can't create: there is no folder '{}'", partial.string(), folder.string()));
  fail_at(partial, "can't create", error);
}

void lock(const Descriptor& file, const path& partial, const path& target, const char* kind) {
  if (::flock(file.get(), LOCK_EX | LOCK_NB) == 0) return;
  if (errno != EWOULDBLOCK) fail_at(partial, "can't lock", errno);
  throw IoError(fmt::format("{}: another process is writing this {} (it holds the lock on {})", target.string(), kind, partial.string()));
}

bool is_still_there(const Descriptor& file, const path& partial) {
  struct stat ours, there;
  return ::fstat(file.get(), &ours) == 0 && ::stat(partial.c_str(), &there) == 0 && ours.st_ino == there.st_ino;
}

void expect_still_there(const Descriptor& file, const path& partial, const path& target, const char* kind) {
  if (is_still_there(file, partial)) return;
  throw IoError(fmt::format("{}: another process has just written this {}: try again", target.string(), kind));
}

int sync_folder(const path& folder) {
  const Descriptor dir(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  const int error = dir && ::fsync(dir.get()) == 0 ? 0 : errno;
  // A folder may forbid reading, and not every file system can sync one: nothing more can be done there.
  return (!dir && error == EACCES) || error == EINVAL || error == EOPNOTSUPP ? 0 : error;
}

int sync_name(const path& target) { return sync_folder(target.has_parent_path() ? target.parent_path() : "."); }

void fail_in_place(const path& target, const char* kind, int error) {
  throw IoError(fmt::format("{}: the {} is complete and in place, but may not outlive a power failure: can't make its folder durable: {}",
                            target.string(), kind, std::strerror(error)));
}

const char* kind_of(const std::filesystem::file_status& found) {
  if (std::filesystem::is_directory(found)) return "a folder";
  return std::filesystem::is_regular_file(found) ? "a file" : "a device or a pipe";
}

}  // namespace teracell::store
