// Files. Input: random access, shared by threads. Output: a temporary file or folder beside the target, which takes the target's
// name only when it is complete and on disk.
#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "store/base/bytes.hpp"
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
  ~InputFile() override;
  InputFile(const InputFile&) = delete;
  uint64_t size() const override { return state_.size; }
  const std::string& name() const override { return name_; }
  void read(uint64_t offset, std::span<uint8_t> out) const override;
  const FileState& state() const { return state_; }  // when it was opened

 private:
  std::string name_;
  int fd_;
  FileState state_;
};

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
  int fd_ = -1;
  uint64_t size_ = 0, written_back_ = 0;
  Bytes buffer_;
};

// Throws IoError if something else than a file has this name: an OutputFile would refuse it, perhaps after hours of other work.
void expect_file_name(const std::filesystem::path& target);

// What several processes write of one file: the places that its OutputFile, in any process, has skipped. Throws IoError.
class FileRoom {
 public:
  explicit FileRoom(const std::filesystem::path& target);  // of that OutputFile
  ~FileRoom();
  FileRoom(const FileRoom&) = delete;
  void write_at(uint64_t offset, std::span<const uint8_t> bytes) const;
  void sync() const;  // when it returns, what was written outlives a power failure

 private:
  std::filesystem::path partial_;
  int fd_;
};

// A folder of files that appears as a whole or not at all. Like a file, it is written under the name "<target>.partial", has one
// writer, and is removed when it is destroyed without commit(). What a killed writer left under this name is removed by the next one.
class OutputFolder {
 public:
  // An older folder of this name is replaced by commit() if it is empty or holds a file `mark`, which every output of the format has.
  // Then all that is in it goes, so any other folder is refused: it may be somebody's home. Throws IoError.
  OutputFolder(const std::filesystem::path& target, std::string mark);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  // Where files are written until commit().
  const std::filesystem::path& path() const { return partial_; }
  // Writes a file of the folder, and makes the folders that it lies in. `name` is relative. Threads may write different files at the
  // same time.
  void write(const std::filesystem::path& name, std::span<const uint8_t> bytes) const;
  // When it returns, all files and the name are durable, and an older folder is gone. When it throws, there is no folder, or still the
  // older one; unless the message says that the new one is complete and in place.
  void commit();

 private:
  void expect_replaceable() const;
  std::filesystem::path target_, partial_;
  std::string mark_;
  int fd_ = -1;
};

}  // namespace teracell::store
