// The files of a hierarchy, in a folder or in a zip.
#pragma once
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace teracell::exports::zarr {

// Destroyed without commit(), it leaves nothing. Not thread-safe.
class Files {
 public:
  virtual ~Files() = default;
  virtual void write(const std::string& name, std::span<const uint8_t> bytes) = 0;
  // When it returns, everything is durable and in place.
  virtual void commit() = 0;
};

// A zip if the name ends in .zip or .ozx, which then has this comment. Throws UsageError if there is a folder that is not empty.
std::unique_ptr<Files> files_at(const std::filesystem::path& output, const std::string& comment);

}  // namespace teracell::exports::zarr
