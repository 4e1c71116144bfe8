#include "web/module/page_file.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace teracell::server {
namespace {

constexpr uint64_t kGap = 8;        // blocks that are fetched though nobody wants them, to save a request
constexpr uint64_t kLongest = 128;  // blocks of one request

}  // namespace

uint32_t PageFiles::add(std::string name, uint64_t size) {
  files_.push_back({std::move(name), size});
  return static_cast<uint32_t>(files_.size() - 1);
}

const PageFiles::Block* PageFiles::find(uint32_t file, uint64_t block) {
  const auto found = blocks_.find(key(file, block));
  if (found == blocks_.end()) return nullptr;
  found->second.used = rests_;
  return &found->second;
}

void PageFiles::read(uint32_t file, uint64_t offset, std::span<uint8_t> out) {
  const File& f = files_[file];
  if (offset > f.size || out.size() > f.size - offset)
    throw IoError(fmt::format("{}: expected {} bytes at byte {}, found the end at byte {}", f.name, out.size(), offset, f.size));
  if (out.empty()) return;
  const ByteRange range{offset, out.size()};
  expect(file, {&range, 1});
  for (uint64_t b = offset / kBlock; b <= (offset + out.size() - 1) / kBlock; ++b) {
    const Bytes& bytes = find(file, b)->bytes;
    const uint64_t from = std::max(offset, b * kBlock), to = std::min(offset + out.size(), b * kBlock + bytes.size());
    std::copy_n(bytes.data() + (from - b * kBlock), to - from, out.data() + (from - offset));
  }
}

void PageFiles::expect(uint32_t file, std::span<const ByteRange> ranges) {
  const uint64_t size = files_[file].size;
  bool all = true;
  for (const ByteRange& r : ranges) {
    if (r.size == 0 || r.offset > size || r.size > size - r.offset) continue;
    for (uint64_t b = r.offset / kBlock; b <= (r.offset + r.size - 1) / kBlock; ++b)
      if (!find(file, b)) {
        all = false;
        missing_.emplace(file, b);
        if (bytes_ + missing_.size() * kBlock > kKept + kMost) {
          missing_.clear();  // nobody wants them now
          throw OptionError(fmt::format("{}: this needs more than {} MB of the file at once: ask for less, or use the program teracell",
                                        files_[file].name, kMost >> 20));
        }
      }
  }
  if (!all) throw Later("bytes are wanted that the page has not fetched yet");
}

std::vector<PageFiles::Missing> PageFiles::take_missing() {
  std::vector<Missing> out;
  for (const auto& [file, block] : missing_) {
    const uint64_t offset = block * kBlock, end = std::min(offset + kBlock, files_[file].size);
    if (!out.empty() && out.back().file == file && offset <= out.back().offset + out.back().size + kGap * kBlock &&
        end - out.back().offset <= kLongest * kBlock)
      out.back().size = end - out.back().offset;
    else out.push_back({file, offset, end - offset});
  }
  missing_.clear();
  return out;
}

void PageFiles::give(uint32_t file, uint64_t offset, std::span<const uint8_t> bytes) {
  for (uint64_t at = 0; at < bytes.size(); at += kBlock) {
    const auto part = bytes.subspan(at, std::min<uint64_t>(kBlock, bytes.size() - at));
    const auto [place, fresh] = blocks_.try_emplace(key(file, (offset + at) / kBlock), Block{{part.begin(), part.end()}, rests_});
    if (fresh) bytes_ += part.size();
  }
}

void PageFiles::rest() {
  missing_.clear();
  ++rests_;
  if (bytes_ <= kKept) return;
  std::vector<std::pair<uint64_t, uint64_t>> old;  // when they were used, and their keys
  for (const auto& [k, block] : blocks_) old.emplace_back(block.used, k);
  std::ranges::sort(old);
  for (auto it = old.begin(); bytes_ > kKept / 2 && it != old.end(); ++it) {
    const auto block = blocks_.find(it->second);
    bytes_ -= block->second.bytes.size();
    blocks_.erase(block);
  }
}

}  // namespace teracell::server
