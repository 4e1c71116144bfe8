// Files that are read now and then. Each is opened when it is read. The descriptors that were used last are kept, up to a number, so that more
// grids can be served than the system allows descriptors.
#pragma once
#include "store/base/file.hpp"
#include "store/base/lru_cache.hpp"

namespace teracell::server {

// The files that are kept open. What is being read stays open on top of their number: a file for each thread. Threads may share it.
using OpenFiles = LruCache<uint64_t, InputFile>;

// Threads may share it.
class ReopenedFile : public ByteSource {
 public:
  // Throws IoError when the file can't be opened.
  ReopenedFile(std::filesystem::path path, std::shared_ptr<OpenFiles> open);
  ~ReopenedFile() override { open_->erase(number_); }
  ReopenedFile(const ReopenedFile&) = delete;
  uint64_t size() const override { return state_.size; }
  const std::string& name() const override { return name_; }
  // Throws Replaced when the file had to be opened again and is no longer the one that the constructor found.
  void read(uint64_t offset, std::span<uint8_t> out) const override;

 private:
  std::shared_ptr<const InputFile> reopened() const;
  const std::filesystem::path path_;
  const std::string name_;
  const std::shared_ptr<OpenFiles> open_;
  const uint64_t number_;
  FileState state_;
};

}  // namespace teracell::server
