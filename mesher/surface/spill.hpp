// Room on disk for what the memory budget doesn't hold.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace teracell {

// How much memory a run may use, and where it may put the rest.
struct Budget {
  uint64_t bytes = ~uint64_t{0};
  std::filesystem::path folder = ".";  // for temporary files
};

// A temporary file without a name: however the process ends, nothing stays behind. Threads may share it. Throws IoError
// that says what to do about it. (Giving room back piece by piece was tried: punching a hole makes ext4 write out
// everything first, which took most of the time of a run.)
class SpillFile {
 public:
  // `expected` bytes must be free in the folder.
  SpillFile(const std::filesystem::path& folder, uint64_t expected);
  ~SpillFile();
  SpillFile(const SpillFile&) = delete;

  void write(uint64_t offset, std::span<const uint8_t> bytes);
  void read(uint64_t offset, std::span<uint8_t> out) const;

 private:
  std::string folder_;
  int fd_ = -1;
};

}  // namespace teracell
