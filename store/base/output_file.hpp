// A temporary file beside the target, which takes the target's name only when it is complete and on disk.
#pragma once
#include <filesystem>
#include <span>

#include "store/base/bytes.hpp"
#include "store/base/descriptor.hpp"

namespace teracell::inline store {

// A target has one writer: while it holds the lock on "<target>.partial", a second one is refused. Destroyed without
// commit(), it removes the partial file. Not thread-safe.
class OutputFile {
 public:
  // Goes on after the first `keep` bytes of what a killed writer has left. Throws IoError when there are fewer. `reads`: read_kept() is
  // called, though nothing is kept.
  explicit OutputFile(const std::filesystem::path& target, uint64_t keep = 0, bool reads = false);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  uint64_t size() const { return size_; }
  void append(std::span<const uint8_t> bytes);
  // For libraries that write in an order of their own. Gaps are zeros. REQUIRES: nothing was appended.
  void write_at(uint64_t offset, std::span<const uint8_t> bytes);
  // Leaves room for bytes that another process puts there by way of a FileRoom before commit().
  void skip(uint64_t bytes);
  // Reads from the bytes that were kept or written by write_at(). REQUIRES: nothing was appended yet.
  void read_kept(uint64_t offset, std::span<uint8_t> out) const;
  // Closes the partial file and leaves it where it is.
  void abandon();
  // When it returns, the bytes so far outlive a power failure, under the temporary name.
  void sync();
  // When it returns, the bytes and the name are durable (fsync of file and folder). When it throws there is no file. If only
  // the folder fails, there is a complete file whose name may not be durable; the message says so. Not durable: for bytes that are
  // checked when they are read, and can be made again.
  void commit(bool durable = true);

 private:
  void flush();
  void begin_write_back();
  [[noreturn]] void fail(const char* what) const;
  std::filesystem::path target_, partial_;
  Descriptor file_;
  uint64_t size_ = 0, written_back_ = 0;
  Bytes buffer_;
};

// Throws IoError if something else than a file has this name: an OutputFile would refuse it, perhaps after hours of other work.
void expect_file_name(const std::filesystem::path& target);

// Whether a writer of the target that is gone has left its temporary file, which the next one throws away unless it resumes.
bool left_behind(const std::filesystem::path& target);

// What several processes write of one file: the places that its OutputFile, in any process, has skipped. Throws IoError.
class FileRoom {
 public:
  explicit FileRoom(const std::filesystem::path& target);  // of that OutputFile
  void write_at(uint64_t offset, std::span<const uint8_t> bytes) const;
  void sync() const;  // when it returns, what was written outlives a power failure

 private:
  std::filesystem::path partial_;
  Descriptor file_;
};

}  // namespace teracell::store
