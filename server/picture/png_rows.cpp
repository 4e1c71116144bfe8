#include "server/picture/png_rows.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace teracell::server {
namespace {

constexpr int64_t kAdlerBase = 65521;
constexpr int64_t kReduceWeighted = int64_t{1} << 32, kReduceB = int64_t{1} << 62;

}  // namespace

void append_changes(std::span<const uint16_t> above, std::span<const uint16_t> row, std::vector<uint32_t>& groups) {
  const size_t whole = row.size() / 8, all = (row.size() + 7) / 8;
  const auto differ = [&](size_t first, size_t count) {  // numbers
    return above.empty() || std::memcmp(above.data() + first, row.data() + first, count * sizeof(uint16_t)) != 0;
  };
  // Most stretches of a row are as above: those are passed at the speed of memcmp.
  constexpr size_t kStretch = 128;
  for (size_t from = 0, to; from < whole; from = to) {
    to = std::min(from + kStretch, whole);
    if (!differ(8 * from, 8 * (to - from))) continue;
    const size_t before = groups.size();
    groups.resize(before + (to - from));
    uint32_t* end = groups.data() + before;
    for (size_t g = from; g < to; ++g) {
      *end = static_cast<uint32_t>(g);
      end += differ(8 * g, 8);
    }
    groups.resize(static_cast<size_t>(end - groups.data()));
  }
  if (whole < all && differ(8 * whole, row.size() - 8 * whole)) groups.push_back(static_cast<uint32_t>(whole));
}

PngRows::PngRows(uint32_t width, uint32_t height, std::span<const Rgba> palette, PngFile::Sink sink)
    : file_(width, height, palette, std::move(sink)),
      bits_(file_.bits()),
      length_((uint64_t{width} * bits_ + 7) / 8 + 1),
      length_weight_(static_cast<int64_t>(length_) % kAdlerBase),
      matches_above_(length_ <= RunDeflate::kFarthest),
      near_(bits_ == 32 && matches_above_ ? 4 : 1),
      deflate_(near_, matches_above_ ? static_cast<uint32_t>(length_) : near_ + 1, [this](std::span<const uint8_t> bytes) { file_.data(bytes); }),
      line_(length_, 0) {}

void PngRows::row(std::span<const uint16_t> numbers, std::span<const uint32_t> changed, const uint32_t* value) {
  if (matches_above_) {
    if (first_) byte(0, 0, 0);
    else same(0, 1);
  } else {
    sum_ = weighted_ = 0;
    line_[0] = 0;
    byte(0, 2, length_weight_);
  }
  uint64_t at = 1;  // bytes of the row that are done
  for (const uint32_t group : changed) {
    const uint64_t start = 1 + uint64_t{group} * bits_;
    if (start > at) same(at, start - at);
    // The last group of a row may be short; its last number is then repeated to fill the last byte.
    const uint16_t* n = numbers.data() + size_t{group} * 8;
    std::array<uint16_t, 8> padded;
    const bool whole = size_t{group} * 8 + 8 <= numbers.size();
    if (!whole) {
      padded.fill(numbers.back());
      std::copy(n, numbers.data() + numbers.size(), padded.begin());
      n = padded.data();
    }
    const auto bytes = file_.pack(n, value);
    const uint64_t end = std::min(start + bits_, length_);
    const int64_t weight = static_cast<int64_t>(length_ - start) % kAdlerBase;
    for (at = start; at < end; ++at) byte(at, bytes[at - start], weight - static_cast<int64_t>(at - start));
  }
  if (at < length_) same(at, length_ - at);
  add_to_adler();
  first_ = false;
}

void PngRows::repeat() {
  if (!matches_above_) return row({}, {}, nullptr);
  extend(RunDeflate::kFar, 0, length_);
  add_to_adler();
}

void PngRows::add_to_adler() {
  // A remainder is taken only where a sum grows too large: seven of them per row were a third of the time of a picture that is
  // one pixel wide and 2^26 high.
  if (weighted_ < 0 || weighted_ >= kReduceWeighted) weighted_ = (weighted_ % kAdlerBase + kAdlerBase) % kAdlerBase;
  adler_b_ += length_weight_ * adler_a_ + weighted_;
  if (adler_b_ >= kReduceB) adler_b_ %= kAdlerBase;
  adler_a_ += sum_;
  if (adler_a_ >= kAdlerBase) adler_a_ %= kAdlerBase;
}

// The bytes [at, at + length) equal those of the row above.
void PngRows::same(uint64_t at, uint64_t length) {
  if (matches_above_) return extend(RunDeflate::kFar, at, length);
  if (last_ != 0) {
    flush(at);
    deflate_.literal(last_ = 0);
    if (--length == 0) return;
  }
  extend(RunDeflate::kNear, at, length);
}

// `weight` is the number of bytes from this one to the row's end, itself included, modulo the base of Adler-32.
void PngRows::byte(uint64_t at, uint8_t value, int64_t weight) {
  const int change = value - line_[at];
  line_[at] = value;
  if (matches_above_) {
    sum_ += change;
    weighted_ += weight * change;
    if (change == 0 && !first_) return extend(RunDeflate::kFar, at, 1);
    if (at >= near_ && line_[at - near_] == value) return extend(RunDeflate::kNear, at, 1);
    flush(at);
    deflate_.literal(value);
  } else {
    const auto difference = static_cast<uint8_t>(change);
    sum_ += difference;
    weighted_ += weight * difference;
    if (at > 0 && difference == last_) return extend(RunDeflate::kNear, at, 1);
    flush(at);
    deflate_.literal(last_ = difference);
  }
}

void PngRows::extend(RunDeflate::Back back, uint64_t at, uint64_t length) {
  if (back != back_) flush(at);
  back_ = back;
  match_ += length;
}

void PngRows::flush(uint64_t at) {
  if (match_ >= RunDeflate::kLeastMatch) deflate_.match(back_, match_);
  else
    for (uint64_t i = match_; i > 0; --i) deflate_.literal(!matches_above_ ? last_ : line_[at >= i ? at - i : at + length_ - i]);
  match_ = 0;
}

void PngRows::finish() {
  flush(0);
  deflate_.finish(static_cast<uint32_t>(adler_b_ % kAdlerBase << 16 | adler_a_));
  file_.finish();
}

}  // namespace teracell::server
