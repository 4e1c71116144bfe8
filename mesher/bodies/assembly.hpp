// Puts the bytes of parts that processes have made into one file, by many processes at once: one says what lies where and writes what joins
// the parts, and any of them copies.
#pragma once
#include <functional>

#include "store/base/output_file.hpp"
#include "store/write/part.hpp"
#include "store/write/pyramid_writer.hpp"
#include "store/write/writer.hpp"

namespace teracell::mesher {

// The next `bytes` bytes of a part lie at `to` in the file.
struct Placed {
  uint64_t to, bytes;
};

class Assembly {
 public:
  Assembly(const std::filesystem::path& output, const Metadata& meta) : writer_(output, meta), pyramid_(writer_) {}
  // The places of all bytes of a part, which are to be there before finish(). Parts come in order.
  std::vector<Placed> add(const PartReader& part);
  void finish(const std::string& report, uint64_t crossings, const CellSums& sums) { writer_.finish(report, crossings, &sums); }
  uint64_t bytes() const { return writer_.bytes(); }

 private:
  GridWriter writer_;
  PyramidWriter pyramid_;
};

// Copies the bytes of a part to their places. Throws FormatError when they are not what they were. Calls `now_and_then` after some
// megabytes.
void copy_placed(const PartReader& part, const std::vector<Placed>& places, const FileRoom& file, const std::function<void()>& now_and_then);

}  // namespace teracell::mesher
