// Disk space for what exceeds the memory budget, and memory that is used like it.
#pragma once
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "store/base/descriptor.hpp"

namespace teracell::inline store {

// How much memory a run may use, and where it may write the rest.
struct Budget {
  uint64_t bytes = ~uint64_t{0};
  std::filesystem::path folder = ".";  // for temporary files
  bool together = false;               // the facets are needed all at once, even where bins would be faster (kMostTogether in read_bodies.cpp)

  // So much the process may take before it gives back what it freed: the pages would soon be needed again.
  uint64_t unasked() const { return std::min(bytes / 4, uint64_t{1} << 26); }
};

// The folder for temporary files of those who choose none: what TMPDIR says, or /tmp.
std::filesystem::path temporary_folder();

// A temporary file without a name, which disappears with the process, however that ends. Threads may share it. Throws IoError
// that says what to do. (Rejected: returning disk space piece by piece. To punch a hole, ext4 first writes out the whole
// file, which took most of the time of a run.)
class SpillFile {
 public:
  // Throws unless the folder has `expected` bytes of free space. With `in_memory` it uses no folder, if the system has files in memory.
  SpillFile(const std::filesystem::path& folder, uint64_t expected, bool in_memory = false);

  void write(uint64_t offset, std::span<const uint8_t> bytes);
  void read(uint64_t offset, std::span<uint8_t> out) const;
  bool in_memory() const { return in_memory_; }

 private:
  std::string folder_;
  Descriptor file_;
  bool in_memory_ = false;
  std::vector<uint8_t> held_;  // where there are no files at all, as in a page
};

}  // namespace teracell::store
