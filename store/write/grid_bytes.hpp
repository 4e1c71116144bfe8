// The bytes of a grid on their way into a file. They are hashed, and a run that goes on where another one was killed finds out whether they
// are still what they were.
#pragma once
#include "store/base/output_file.hpp"
#include "store/format/format.hpp"

namespace teracell::inline store {

// Not thread-safe.
class GridBytes {
 public:
  GridBytes(const std::filesystem::path& path, uint64_t keep) : file_(path, keep) {}
  uint64_t size() const { return file_.size(); }  // of the file
  void append(std::span<const uint8_t> bytes);
  DirectoryEntry append_frame(std::span<const uint8_t> frame);
  std::array<uint8_t, 16> hash() const { return hash_.digest(); }
  // For what is not hashed, and for the end.
  OutputFile& file() { return file_; }

  // Makes the bytes durable, and appends to `state` the size of the file and the hash. The size is what `keep` has to be.
  void save(Bytes& state);
  // Hashes what was kept, which the grid's bytes are from `first` on. Reads the hash. Throws FormatError when the bytes have another one.
  void restore(ByteReader& state, uint64_t first);

 private:
  OutputFile file_;
  ContentHash hash_;
};

}  // namespace teracell::store
