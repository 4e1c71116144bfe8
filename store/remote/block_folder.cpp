#include "store/remote/block_folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "store/base/descriptor.hpp"
#include "store/base/error.hpp"
#include "store/format/format.hpp"

namespace teracell::inline store {
namespace {

namespace fs = std::filesystem;

constexpr char kEnding[] = ".blocks";
constexpr uint64_t kPlace = BlockFolder::kBlock + sizeof(uint64_t);  // of a block in its file
constexpr time_t kFresh = 60;  // seconds for which a file's time of use is good enough

// O_NONBLOCK: a pipe that lies there under a file's name would be waited for.
Descriptor open_block_file(const fs::path& path, int flags) {
  return Descriptor(::open(path.c_str(), flags | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0600));
}

std::string key_of(const std::string& what) {
  ContentHash hash;
  hash.add({reinterpret_cast<const uint8_t*>(what.data()), what.size()});
  return hex(hash.digest());
}

// Whether a name is one of ours: nothing else is ever removed.
bool is_block_file(const std::string& name) {
  return name.ends_with(kEnding) && name.size() > 33 && name[32] == '-' && name.find_first_not_of("0123456789abcdef") == 32 &&
         name.find_first_not_of("0123456789abcdef", 33) == name.size() - (sizeof kEnding - 1);
}

}  // namespace

BlockFolder::BlockFolder(fs::path folder, uint64_t most_bytes, const std::string& what)
    : folder_(std::move(folder)), most_(most_bytes), key_(key_of(what)), written_(most_bytes) {
  std::error_code error;
  fs::create_directories(folder_.parent_path(), error);
  if (::mkdir(folder_.c_str(), 0700) != 0 && errno != EEXIST) fail_at(folder_, "can't create", errno);
  if (!fs::is_directory(folder_, error)) throw IoError(fmt::format("{}: expected a folder", folder_.string()));
}

fs::path BlockFolder::file_of(uint64_t block) const { return folder_ / fmt::format("{}-{:x}{}", key_, block / kBlocksPerFile, kEnding); }

uint64_t BlockFolder::checksum_of(uint64_t block, const Bytes& bytes) const {
  Bytes all(key_.begin(), key_.end());
  put_fixed(all, block);
  all.insert(all.end(), bytes.begin(), bytes.end());
  return checksum(all);
}

std::optional<Bytes> BlockFolder::find(uint64_t block, size_t size) const {
  const Descriptor file = open_block_file(file_of(block), O_RDONLY);
  if (!file) return std::nullopt;
  Bytes bytes(sizeof(uint64_t) + size);
  if (file.read(block % kBlocksPerFile * kPlace, bytes) < bytes.size()) return std::nullopt;
  const auto expected = ByteReader(bytes, "block").fixed<uint64_t>();
  bytes.erase(bytes.begin(), bytes.begin() + sizeof(uint64_t));
  if (checksum_of(block, bytes) != expected) return std::nullopt;
  struct stat s;
  if (::fstat(file.get(), &s) == 0 && s.st_mtim.tv_sec + kFresh < ::time(nullptr)) ::futimens(file.get(), nullptr);
  return bytes;
}

void BlockFolder::add(uint64_t block, const Bytes& bytes) const {
  {
    std::lock_guard lock(mutex_);
    if (written_ >= most_ / 16) make_room();
    written_ += bytes.size();
  }
  const Descriptor file = open_block_file(file_of(block), O_WRONLY | O_CREAT);
  if (!file) return;
  Bytes framed;
  put_fixed(framed, checksum_of(block, bytes));
  framed.insert(framed.end(), bytes.begin(), bytes.end());
  file.write(block % kBlocksPerFile * kPlace, framed);  // if it fails, the block is read from its address once more
}

void BlockFolder::make_room() const {
  written_ = 0;
  using File = std::tuple<int64_t, uint64_t, fs::path>;  // when it was used, its bytes on disk
  std::vector<File> files;
  uint64_t bytes = 0;
  std::error_code error;
  for (fs::directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
    struct stat s;
    if (!is_block_file(at->path().filename().string()) || ::lstat(at->path().c_str(), &s) != 0 || !S_ISREG(s.st_mode)) continue;
    files.emplace_back(int64_t{s.st_mtim.tv_sec} * 1'000'000'000 + s.st_mtim.tv_nsec, static_cast<uint64_t>(s.st_blocks) * 512, at->path());
    bytes += std::get<1>(files.back());
  }
  if (bytes <= most_ - most_ / 16) return;
  std::ranges::sort(files);
  for (const auto& [used, size, path] : files) {
    if (bytes <= most_ - most_ / 8) return;
    if (::unlink(path.c_str()) == 0) bytes -= size;
  }
}

}  // namespace teracell::store
