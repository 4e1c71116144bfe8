// Where bytes are read: files, with random access, shared by threads.
#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "store/base/bytes.hpp"
#include "store/base/descriptor.hpp"
#include "store/base/error.hpp"

struct stat;

namespace teracell::inline store {

// What was opened is gone, or has other bytes now.
struct Replaced : IoError {
  using IoError::IoError;
};

struct ByteRange {
  uint64_t offset, size;
};
// `out` is to be filled with the bytes from `offset` on.
struct ByteRead {
  uint64_t offset;
  std::span<uint8_t> out;
};

// Where bytes can be read at any offset. Threads may share it.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  virtual uint64_t size() const = 0;
  virtual const std::string& name() const = 0;  // for messages
  // Fills `out` with the bytes from `offset` on. Throws IoError when it can't read all of them.
  virtual void read(uint64_t offset, std::span<uint8_t> out) const = 0;
  // The same for several places, at the same time where that is faster.
  virtual void read_many(std::span<const ByteRead> reads) const {
    for (const ByteRead& r : reads) read(r.offset, r.out);
  }
  // Whether each read waits for another machine, so that it is worth the effort to call prefetch().
  virtual bool is_far() const { return false; }
  // Makes ready what is read next. It is only a hint, and places outside the source are ignored.
  virtual void prefetch(std::span<const ByteRange>) const {}
  // Whether the source has other bytes now than when it was opened; asks its host. Throws IoError when that can't be found out.
  virtual bool was_replaced() const { return false; }
};

// Tells one state of a file from another.
struct FileState {
  uint64_t device = 0, inode = 0, size = 0;
  int64_t changed = 0;  // nanoseconds
  friend bool operator==(const FileState&, const FileState&) = default;
};
FileState state_of(const struct stat& found);

class InputFile : public ByteSource {
 public:
  explicit InputFile(const std::filesystem::path& path);
  uint64_t size() const override { return state_.size; }
  const std::string& name() const override { return name_; }
  void read(uint64_t offset, std::span<uint8_t> out) const override;
  const FileState& state() const { return state_; }  // when it was opened

 private:
  std::string name_;
  Descriptor file_;
  FileState state_;
};

}  // namespace teracell::store
