// The same as output_file.hpp for a folder.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "store/base/descriptor.hpp"

namespace teracell::inline store {

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
  Descriptor lock_;
};

}  // namespace teracell::store
