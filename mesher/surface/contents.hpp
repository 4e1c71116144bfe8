// What is left of an input, at any place: for formats that refer to places in the file. A plain file is read where it lies; what is
// compressed or comes through a pipe is first written to a temporary file.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "mesher/surface/input.hpp"
#include "store/base/descriptor.hpp"
#include "store/base/spill.hpp"

namespace teracell::mesher {

class Contents {
 public:
  // Takes the input to its end, so its hash is complete. The bytes of an input in memory must outlive this.
  Contents(Input& input, const Budget& budget);
  uint64_t size() const { return size_; }
  // REQUIRES: offset + out.size() <= size(). Throws IoError when the file can't be read or has become shorter.
  void read(uint64_t offset, std::span<char> out) const;

 private:
  std::string name_;
  uint64_t first_ = 0, size_ = 0;
  Descriptor file_;          // a plain file, or
  std::string_view memory_;  // bytes in memory, or
  std::optional<SpillFile> spilled_;
};

}  // namespace teracell::mesher
