#include "mesher/surface/contents.hpp"

#include <cerrno>
#include <cstring>

#include <fmt/format.h>

#include "store/base/error.hpp"

namespace teracell::mesher {
namespace {

std::span<const uint8_t> as_bytes(std::string_view text) { return {reinterpret_cast<const uint8_t*>(text.data()), text.size()}; }

}  // namespace

Contents::Contents(Input& input, const Budget& budget) : name_(input.name()), file_(input.plain_file()) {
  const auto memory = input.plain_memory();
  if (file_ || memory) first_ = input.offset();
  else spilled_.emplace(budget.folder, 0);
  for (size_t some; (some = input.window(1).size()) > 0; input.consume(some), size_ += some)
    if (spilled_) spilled_->write(size_, as_bytes(input.window(0)));
  if (memory) memory_ = memory->substr(first_);
}

void Contents::read(uint64_t offset, std::span<char> out) const {
  const std::span<uint8_t> bytes(reinterpret_cast<uint8_t*>(out.data()), out.size());
  if (spilled_) return spilled_->read(offset, bytes);
  if (!file_) {
    memory_.copy(out.data(), out.size(), offset);
    return;
  }
  if (const size_t got = file_.read(first_ + offset, bytes); got < out.size())
    throw IoError(fmt::format("{}: byte {}: can't be read: {}", name_, first_ + offset + got,
                              errno != 0 ? std::strerror(errno) : "the file has become shorter"),
                  errno);
}

}  // namespace teracell::mesher
