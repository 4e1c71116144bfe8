// What output files and folders have in common: they are written under the name "<target>.partial" by one process, which holds a lock on it,
// and names that are durable. Private to them. Throws IoError.
#pragma once
#include <filesystem>

#include "store/base/descriptor.hpp"

namespace teracell::inline store {

[[noreturn]] void fail_to_create(const std::filesystem::path& partial, const std::filesystem::path& target, int error);
// Throws when another writer has the lock, or when the file system has none to give, as Lustre without the option `flock`.
void lock(const Descriptor& file, const std::filesystem::path& partial, const std::filesystem::path& target, const char* kind);
// Between open and flock the former owner may have renamed or removed what is open: then the lock is on another inode.
void expect_still_there(const Descriptor& file, const std::filesystem::path& partial, const std::filesystem::path& target, const char* kind);
// Whether `partial` is the name of the open file.
bool is_still_there(const Descriptor& file, const std::filesystem::path& partial);
// Make the names in a folder, or the name `target`, durable. They return the error, or 0.
int sync_folder(const std::filesystem::path& folder);
int sync_name(const std::filesystem::path& target);
[[noreturn]] void fail_in_place(const std::filesystem::path& target, const char* kind, int error);
const char* kind_of(const std::filesystem::file_status& found);  // "a folder"

}  // namespace teracell::store
