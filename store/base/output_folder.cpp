#include "store/base/output_folder.hpp"

#include <cerrno>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include "store/base/error.hpp"
#include "store/base/partial.hpp"
#include "store/base/system/system.hpp"

namespace teracell::inline store {
namespace {

using std::filesystem::path;

// Makes all files and folders below `folder` durable, and then the folder itself.
void sync_all(const path& folder) {
  std::error_code error;
  for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (at->symlink_status().type() == std::filesystem::file_type::directory) {
      sync_all(at->path());
      continue;
    }
    const Descriptor file(::open(at->path().c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
    if (!file || ::fsync(file.get()) != 0) fail_at(at->path(), "can't make durable (fsync)", errno);
  }
  if (error) fail_at(folder, "can't list", error.value());
  if (const int failed = sync_folder(folder)) fail_at(folder, "can't make durable (fsync)", failed);
}

}  // namespace

OutputFolder::OutputFolder(const std::filesystem::path& target, std::string mark)
    : target_(target.has_filename() ? target : target.parent_path()), partial_(target_.string() + ".partial"), mark_(std::move(mark)) {
  expect_replaceable();
  if (::mkdir(partial_.c_str(), 0777) != 0 && errno != EEXIST) fail_to_create(partial_, target_, errno);
  Descriptor folder(::open(partial_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW));
  if (!folder && (errno == ENOTDIR || errno == ELOOP))
    throw IoError(fmt::format("{}: expected no file, or a folder that a killed run has left; found something else: remove it", partial_.string()));
  if (!folder) fail_to_create(partial_, target_, errno);
  lock(folder, partial_, target_, "folder");
  expect_still_there(folder, partial_, target_, "folder");
  std::error_code error;
  for (std::filesystem::directory_iterator at(partial_, error), end; !error && at != end;) {
    std::filesystem::remove_all(at->path(), error);
    if (!error) at.increment(error);
  }
  if (error) fail_at(partial_, "can't empty", error.value());
  lock_ = std::move(folder);
}

OutputFolder::~OutputFolder() {
  if (!lock_) return;
  std::error_code ignored;
  std::filesystem::remove_all(partial_, ignored);
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
  const Descriptor out(::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666));
  if (!out) fail_at(file, "can't create", errno);
  if (!out.append(bytes)) fail_at(file, "can't write", errno);
}

void OutputFolder::commit() {
  sync_all(partial_);
  expect_replaceable();  // once more, since a run may take hours
  // The older folder takes the temporary name before it is removed, so its lock keeps other writers away from it.
  std::error_code ignored;
  const bool replaces = std::filesystem::exists(std::filesystem::symlink_status(target_, ignored));
  const Descriptor old(replaces ? ::open(target_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1);
  if (old) lock(old, target_, target_, "folder");
  if (const int error = system::rename_folder(partial_, target_, replaces); error != 0) fail_at(partial_, "can't rename to its final name", error);
  lock_.close();
  const int unsynced = sync_name(target_);  // before the older folder goes
  std::error_code error;
  if (replaces) std::filesystem::remove_all(partial_, error);
  if (unsynced != 0) fail_in_place(target_, "folder", unsynced);
  if (error)
    throw IoError(fmt::format("{}: the folder is complete and in place, but the older one is left as {}: can't remove it: {}", target_.string(),
                              partial_.string(), error.message()));
}

}  // namespace teracell::store
