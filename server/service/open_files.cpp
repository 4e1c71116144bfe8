#include "server/service/open_files.hpp"

#include <fmt/format.h>

namespace teracell::server {

ReopenedFile::ReopenedFile(std::filesystem::path path, std::shared_ptr<OpenFiles> open)
    : path_(std::move(path)), name_(path_.string()), open_(std::move(open)), number_(open_->new_owner()) {
  const auto file = std::make_shared<const InputFile>(path_);
  state_ = file->state();
  open_->add(number_, file, 1);
}

void ReopenedFile::read(uint64_t offset, std::span<uint8_t> out) const {
  auto file = open_->find(number_);
  if (!file) {
    file = reopened();
    open_->add(number_, file, 1);
  }
  file->read(offset, out);
}

std::shared_ptr<const InputFile> ReopenedFile::reopened() const try {
  auto file = std::make_shared<const InputFile>(path_);
  if (file->state() == state_) return file;
  throw Replaced(fmt::format("{}: expected the file that was opened first, found another one or other contents: ask again", name_));
} catch (const Replaced&) {
  throw;
} catch (const IoError& e) {
  std::error_code unknown;
  if (std::filesystem::exists(path_, unknown) || unknown) throw;
  throw Replaced(e.what());
}

}  // namespace teracell::server
