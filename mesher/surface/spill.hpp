// Disk space for what exceeds the memory budget.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace teracell {

// How much memory a run may use, and where it may write the rest.
struct Budget {
  uint64_t bytes = ~uint64_t{0};
  std::filesystem::path folder = ".";  // for temporary files
};

// A temporary file without a name, which disappears with the process, however that ends. Threads may share it. Throws IoError
// that says what to do. (Rejected: returning disk space piece by piece. To punch a hole, ext4 first writes out the whole
// file, which took most of the time of a run.)
class SpillFile {
 public:
  // Throws unless the folder has `expected` bytes of free space.
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
