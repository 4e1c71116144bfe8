// A ZIP archive of stored files with 64-bit sizes (PKWARE's APPNOTE 6.3.3, 4.3 and 4.5.3). The same files give the same bytes: all are
// dated 1 January 1980. The directory is kept in memory, some 100 bytes for each file.
#pragma once
#include "store/base/output_file.hpp"

namespace teracell::exports::zarr {

class Zip {
 public:
  explicit Zip(const std::filesystem::path& target) : file_(target) {}
  void write(const std::string& name, std::span<const uint8_t> bytes);
  void commit(const std::string& comment);

 private:
  OutputFile file_;
  uint64_t files_ = 0;
  Bytes directory_;
};

}  // namespace teracell::exports::zarr
