// Files. In: random access, shared by threads. Out: a temporary beside the target that takes its name only when it is
// complete and on disk.
#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "store/bytes.hpp"

namespace teracell {

// Where bytes can be read at any offset: a file here, a server's byte ranges tomorrow. Threads may share it.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  virtual uint64_t size() const = 0;
  virtual const std::string& name() const = 0;  // for messages
  // Fills `out` from `offset`; throws IoError when that many bytes can't be had.
  virtual void read(uint64_t offset, std::span<uint8_t> out) const = 0;
};

class InputFile : public ByteSource {
 public:
  explicit InputFile(const std::filesystem::path& path);
  ~InputFile() override;
  InputFile(const InputFile&) = delete;
  uint64_t size() const override { return size_; }
  const std::string& name() const override { return name_; }
  void read(uint64_t offset, std::span<uint8_t> out) const override;

 private:
  std::string name_;
  int fd_;
  uint64_t size_;
};

// One writer a target: a second one is refused while the first holds the lock on "<target>.partial".
// Destroyed without commit(), it removes the partial file. Not thread-safe.
class OutputFile {
 public:
  // Goes on after the first `keep` bytes of what a killed writer has left; IoError when there are fewer.
  explicit OutputFile(const std::filesystem::path& target, uint64_t keep = 0);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  uint64_t size() const { return size_; }
  void append(std::span<const uint8_t> bytes);
  // Of the bytes that it began with. REQUIRES: nothing appended yet.
  void read_kept(uint64_t offset, std::span<uint8_t> out) const;
  // Leaves the partial file where it is.
  void abandon();
  // When it returns, the bytes so far outlive a power failure; under the temporary name.
  void sync();
  // When it returns, the bytes and the name are durable (fsync of file and folder). When it throws there is no file, or, if
  // the folder alone fails, a complete one whose name may not be durable: the message says so.
  void commit();

 private:
  void flush();
  [[noreturn]] void fail(const char* what) const;
  std::filesystem::path target_, partial_;
  int fd_ = -1;
  uint64_t size_ = 0;
  Bytes buffer_;
};

}  // namespace teracell
