// Blocks of objects in a folder, for the next program that reads them. Any number of processes may use a folder at the same time.
//
// A file has kBlocksPerFile blocks of one version of one object, each behind its checksum, at computed places; places of blocks that are
// not there are holes. No locks: whoever writes a block writes the same bytes, and a block that is half written, damaged or of another
// object has another checksum, so it counts as missing. When the files take more than the folder may hold, those that were used
// longest ago are removed. Each process looks after it has written a sixteenth of that, so several may exceed it by so much each.
#pragma once
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>

#include "store/base/bytes.hpp"

namespace teracell::inline store {

// The blocks of one version of an object. Threads may share it.
class BlockFolder {
 public:
  // `what` stands for the object's address, version and size. Makes the folder, for this user alone. Throws IoError if it can't be used.
  BlockFolder(std::filesystem::path folder, uint64_t most_bytes, const std::string& what);
  // The block, if the folder has it, whole.
  std::optional<Bytes> find(uint64_t block, size_t size) const;
  // A block that can't be written is none that is kept.
  void add(uint64_t block, const Bytes& bytes) const;

  static constexpr uint64_t kBlock = 1 << 13;  // bytes; the last block of an object may be shorter
  static constexpr uint64_t kBlocksPerFile = 128;

 private:
  std::filesystem::path file_of(uint64_t block) const;
  uint64_t checksum_of(uint64_t block, const Bytes& bytes) const;
  void make_room() const;

  const std::filesystem::path folder_;
  const uint64_t most_;
  const std::string key_;
  mutable std::mutex mutex_;
  mutable uint64_t written_;  // since the last look; at first as if a look were due
};

}  // namespace teracell::store
