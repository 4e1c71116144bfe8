#include "tools/export/zarr/files.hpp"

#include <fmt/format.h>

#include "store/base/output_folder.hpp"
#include "tools/export/zarr/zip.hpp"

namespace teracell::exports::zarr {
namespace {

class ZippedFiles : public Files {
 public:
  ZippedFiles(const std::filesystem::path& output, std::string comment) : zip_(output), comment_(std::move(comment)) {}
  void write(const std::string& name, std::span<const uint8_t> bytes) override { zip_.write(name, bytes); }
  void commit() override { zip_.commit(comment_); }

 private:
  Zip zip_;
  const std::string comment_;
};

class FolderFiles : public Files {
 public:
  explicit FolderFiles(const std::filesystem::path& output) : folder_(expect_free(output), "none") {}
  void write(const std::string& name, std::span<const uint8_t> bytes) override { folder_.write(name, bytes); }
  void commit() override { folder_.commit(); }

 private:
  // A file is replaced, but a folder may hold more than an older export.
  static const std::filesystem::path& expect_free(const std::filesystem::path& output) {
    std::error_code ignored;
    if (std::filesystem::is_directory(output, ignored) && !std::filesystem::is_empty(output, ignored))
      throw UsageError(
          fmt::format("{}: expected a new name or an empty folder, found a folder with files: remove it, or write to another one", output.string()));
    return output;
  }

  OutputFolder folder_;
};

}  // namespace

std::unique_ptr<Files> files_at(const std::filesystem::path& output, const std::string& comment) {
  const std::filesystem::path extension = output.extension();
  if (extension == ".zip" || extension == ".ozx") return std::make_unique<ZippedFiles>(output, comment);
  return std::make_unique<FolderFiles>(output);
}

}  // namespace teracell::exports::zarr
