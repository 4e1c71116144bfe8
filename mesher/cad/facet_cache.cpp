#include "mesher/cad/facet_cache.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/format/format.hpp"

namespace teracell::mesher {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMostBytes = uint64_t{2} << 30;
constexpr size_t kHash = 16;
constexpr const char *kEnding = ".cad", *kUnfinished = ".cad-unfinished", *kLock = ".cad-lock";

fs::path users_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache == '/') return fs::path(cache) / "teracell" / "cad";
  if (const char* home = std::getenv("HOME"); home && *home == '/') return fs::path(home) / ".cache" / "teracell" / "cad";
  return {};
}

Descriptor opened(const fs::path& path, int flags) { return Descriptor(::open(path.c_str(), flags | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0600)); }

template <class F>
void for_each_block(const Descriptor& file, uint64_t size, F&& f) {
  Bytes block(std::min<uint64_t>(size, 1 << 20));
  for (uint64_t at = 0; at < size; at += block.size()) {
    block.resize(std::min<uint64_t>(size - at, block.size()));
    if (file.read(at, block) < block.size()) throw IoError(fmt::format("can't read facets from the cache: {}", std::strerror(errno)), errno);
    f(std::span<const uint8_t>(block));
  }
}

struct EntryHashes {
  std::array<uint8_t, kHash> content, with_key;  // the second stands behind the content, so an entry under another name counts as damaged, too
};

EntryHashes hashes_of(const Descriptor& file, uint64_t size, const std::string& key) {
  ContentHash hash;
  for_each_block(file, size, [&](std::span<const uint8_t> block) { hash.add(block); });
  const auto content = hash.digest();
  hash.add({reinterpret_cast<const uint8_t*>(key.data()), key.size()});
  return {content, hash.digest()};
}

// What a killed run has left unfinished: nobody holds its lock, which runs take when they have created the file.
bool is_left(const fs::path& path, const struct stat& s) {
  constexpr int64_t kSeconds = 60;
  if (s.st_mtim.tv_sec >= int64_t{::time(nullptr)} - kSeconds) return false;
  const Descriptor file = opened(path, O_RDONLY);
  return file && ::flock(file.get(), LOCK_EX | LOCK_NB) == 0;
}

}  // namespace

FacetCache::FacetCache(fs::path folder, const Budget& budget) : folder_(folder.empty() ? users_folder() : std::move(folder)), other_(budget.folder) {
  std::error_code error;
  if (!folder_.empty()) fs::create_directories(folder_.parent_path(), error);
  if (!folder_.empty() && ::mkdir(folder_.c_str(), 0700) != 0 && errno != EEXIST) folder_.clear();
  // Whoever else could write there could put other facets in place of ours.
  struct stat s;
  if (!folder_.empty() && (::lstat(folder_.c_str(), &s) != 0 || !S_ISDIR(s.st_mode) || s.st_uid != ::geteuid() ||
                           (s.st_mode & (S_IWGRP | S_IWOTH)) != 0 || ::access(folder_.c_str(), W_OK | X_OK) != 0))
    folder_.clear();
}

fs::path FacetCache::path_of(const std::string& key) const { return folder_ / (key + kEnding); }

std::optional<FacetCache::Entry> FacetCache::find(const std::string& key) const {
  if (folder_.empty()) return std::nullopt;
  Entry entry{opened(path_of(key), O_RDONLY), 0, ""};
  struct stat s;
  if (!entry.file || ::fstat(entry.file.get(), &s) != 0 || !S_ISREG(s.st_mode) || s.st_size < static_cast<off_t>(kHash)) return std::nullopt;
  entry.size = static_cast<uint64_t>(s.st_size) - kHash;
  std::array<uint8_t, kHash> behind{};
  if (entry.file.read(entry.size, behind) < kHash) return std::nullopt;
  const EntryHashes hashes = hashes_of(entry.file, entry.size, key);
  if (hashes.with_key != behind) return std::nullopt;
  entry.hash = hex(hashes.content);
  ::utimensat(AT_FDCWD, path_of(key).c_str(), nullptr, 0);  // those that were not used for longest go first
  return entry;
}

std::optional<std::string> FacetCache::find_text(const std::string& key) const {
  const std::optional<Entry> entry = find(key);
  if (!entry || entry->size > uint64_t{1} << 30) return std::nullopt;
  std::string text(entry->size, '\0');
  entry->file.read(0, {reinterpret_cast<uint8_t*>(text.data()), text.size()});
  return text;
}

FacetCache::Entry FacetCache::add(const std::string& key, const std::function<void(const std::string&)>& make) const {
  if (!folder_.empty()) try {
      return add_in(folder_, key, make);
    } catch (const IoError&) {  // it is full, or has become read-only
    }
  return add_in(other_, key, make);
}

FacetCache::Entry FacetCache::add_in(const fs::path& folder, const std::string& key, const std::function<void(const std::string&)>& make) const {
  const bool keeps = folder == folder_;
  std::string name = (folder / (key + "-XXXXXX" + kUnfinished)).string();
  Entry entry{Descriptor(::mkostemps(name.data(), static_cast<int>(std::strlen(kUnfinished)), O_CLOEXEC)), 0, ""};
  if (!entry.file) fail_at(name, "can't create", errno);
  ::flock(entry.file.get(), LOCK_SH);  // it belongs to a run that lives
  try {
    make(name);
    struct stat s;
    if (::fstat(entry.file.get(), &s) != 0) fail_at(name, "can't read", errno);
    entry.size = static_cast<uint64_t>(s.st_size);
    const EntryHashes hashes = hashes_of(entry.file, entry.size, key);
    entry.hash = hex(hashes.content);
    if (entry.file.write(entry.size, hashes.with_key) < kHash) fail_at(name, "can't write", errno);
    if (keeps && ::rename(name.c_str(), path_of(key).c_str()) != 0) fail_at(path_of(key), "can't create", errno);
  } catch (...) {
    ::unlink(name.c_str());
    throw;
  }
  if (keeps) make_room(key);
  else ::unlink(name.c_str());
  return entry;
}

void FacetCache::add_text(const std::string& key, const std::string& text) const {
  if (folder_.empty()) return;
  try {
    add_in(folder_, key, [&](const std::string& path) {
      const Descriptor file = opened(path, O_WRONLY);
      if (!file || file.write(0, {reinterpret_cast<const uint8_t*>(text.data()), text.size()}) < text.size()) fail_at(path, "can't write", errno);
    });
  } catch (const IoError&) {
  }
}

// Others of the same machine wait a tenth of a second at a time, because a lock can't be waited for together with the user's wish to stop.
Descriptor FacetCache::lock(const std::string& key, double seconds, const std::function<void()>& waiting) const {
  if (folder_.empty()) return Descriptor();
  const auto began = std::chrono::steady_clock::now();
  Descriptor file = opened(folder_ / (key + kLock), O_RDWR | O_CREAT);
  while (file && ::flock(file.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK && errno != EINTR) return Descriptor();
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count() > seconds) return Descriptor();
    waiting();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  if (file) ::futimens(file.get(), nullptr);  // so that it isn't taken for one that was left
  return file;
}

// Nothing but files with our endings is ever removed. Of locks, those that are older than a day.
void FacetCache::make_room(const std::string& newest) const {
  using File = std::tuple<int64_t, uint64_t, fs::path>;  // when it was used, its bytes
  std::vector<File> files;
  const int64_t day_ago = int64_t{::time(nullptr)} - int64_t{24} * 3600;
  uint64_t all = 0;
  std::error_code error;
  for (fs::directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    struct stat s;
    if (::lstat(at->path().c_str(), &s) != 0 || !S_ISREG(s.st_mode)) continue;
    if (name.ends_with(kUnfinished) ? is_left(at->path(), s) : name.ends_with(kLock) && s.st_mtim.tv_sec < day_ago) ::unlink(at->path().c_str());
    if (!name.ends_with(kEnding)) continue;
    files.emplace_back(int64_t{s.st_mtim.tv_sec} * 1'000'000'000 + s.st_mtim.tv_nsec, static_cast<uint64_t>(s.st_size), at->path());
    all += static_cast<uint64_t>(s.st_size);
  }
  if (all <= kMostBytes) return;
  std::ranges::sort(files);
  for (const auto& [used, size, path] : files) {
    if (all <= kMostBytes) return;
    if (path != path_of(newest) && ::unlink(path.c_str()) == 0) all -= size;
  }
}

}  // namespace teracell::mesher
