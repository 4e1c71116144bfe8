// Why not a library: pictures of 10^5 x 10^5 cells must stream, and with a palette of two colours a pixel is a bit: a
// picture of 10^8 cells is 12.5 MB for zlib instead of 100. Filter "up" makes rows that repeat all zeros.
#include "server/picture.hpp"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>
#include <zlib.h>

namespace teracell {
namespace {

constexpr size_t kIdatBytes = 1 << 16;
constexpr size_t kMaxSetColors = 65536;

void put_be32(std::vector<uint8_t>& out, uint32_t v) {
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<uint8_t>(v >> shift));
}

uint32_t packed(const Rgba& c) { return c[0] | uint32_t{c[1]} << 8 | uint32_t{c[2]} << 16 | uint32_t{c[3]} << 24; }

// Numbers below 2^bits, bits 1, 2 or 4, the leftmost in the highest bits of a byte.
void pack(std::span<const uint16_t> numbers, unsigned bits, uint8_t* out) {
  // Four numbers at a time: in x they stand 16 bits apart, the product brings them together above bit 48. What the
  // product makes besides falls below bit 48 or beyond bit 63.
  const uint64_t gather = uint64_t{1} << (48 + 3 * bits) | uint64_t{1} << (32 + 2 * bits) | uint64_t{1} << (16 + bits) | 1;
  const auto four = [&](const uint16_t* n) {
    const uint64_t x = n[0] | uint64_t{n[1]} << 16 | uint64_t{n[2]} << 32 | uint64_t{n[3]} << 48;
    return static_cast<uint32_t>(x * gather >> 48);
  };
  const auto eight = [&](const uint16_t* n) { return four(n) << 4 * bits | four(n + 4); };  // `bits` bytes
  const auto put = [&](uint32_t word) {
    for (unsigned shift = 8 * bits; shift > 0; shift -= 8) *out++ = static_cast<uint8_t>(word >> (shift - 8));
  };
  size_t i = 0;
  for (; i + 8 <= numbers.size(); i += 8) put(eight(&numbers[i]));
  if (i == numbers.size()) return;
  std::array<uint16_t, 8> rest{};
  std::ranges::copy(numbers.subspan(i), rest.begin());
  uint32_t word = eight(rest.data());
  for (size_t used = 0; used < (numbers.size() - i) * bits; used += 8, word <<= 8) *out++ = static_cast<uint8_t>(word >> (8 * bits - 8));
}

}  // namespace

Rgba blend(std::span<const Rgba> colors) {
  if (colors.size() == 1) return colors[0];
  std::array<uint32_t, 4> sum{};
  for (const Rgba& c : colors) {
    for (int i = 0; i < 3; ++i) sum[i] += (2 * c[i] * c[3] + 255) / 510;  // c * alpha / 255, half up
    sum[3] += c[3];
  }
  const auto n = static_cast<uint32_t>(colors.size());
  std::array<uint32_t, 4> mean;
  for (int i = 0; i < 4; ++i) mean[i] = (2 * sum[i] + n) / (2 * n);
  if (mean[3] == 0) return {0, 0, 0, 0};
  Rgba out;
  for (int i = 0; i < 3; ++i) out[i] = static_cast<uint8_t>(std::min(255u, (2 * mean[i] * 255 + mean[3]) / (2 * mean[3])));
  out[3] = static_cast<uint8_t>(mean[3]);
  return out;
}

SetColors::SetColors(const Metadata& meta, int level) : meta_(meta) {
  for (const MaterialInfo& m : meta.materials) material_colors_.push_back(parse_color(m.color).value());
  const auto n = static_cast<uint32_t>(meta.materials.size());
  for (uint32_t m = 0; m < n; ++m) number_of_materials({m});
  // Every set of 8 materials or fewer: 255 of them.
  if (level > 0 && n <= 8)
    for (uint32_t members = 1; members < 1u << n; ++members) {
      std::vector<uint32_t> set;
      for (uint32_t m = 0; m < n; ++m)
        if (members >> m & 1) set.push_back(m);
      number_of_materials(set);
    }
  complete_ = (level == 0 || n <= 8) && colors_.size() <= 256;
}

uint16_t SetColors::number_of_materials(const std::vector<uint32_t>& materials) {
  std::vector<Rgba> members;
  for (const uint32_t m : materials) members.push_back(material_colors_[m]);
  const Rgba color = blend(members);
  std::lock_guard lock(mutex_);
  if (const auto it = by_color_.find(packed(color)); it != by_color_.end()) return it->second;
  if (colors_.size() == kMaxSetColors) throw Error(fmt::format("the picture has more than {} colours", kMaxSetColors));
  colors_.push_back(color);
  const auto number = static_cast<uint16_t>(colors_.size() - 1);
  by_color_[packed(color)] = number;
  return number;
}

uint16_t SetColors::number(const std::vector<Label>& set) {
  std::vector<uint32_t> materials;
  for (const Label label : set) materials.push_back(meta_.labels[label].material);
  std::ranges::sort(materials);
  materials.erase(std::unique(materials.begin(), materials.end()), materials.end());
  return number_of_materials(materials);
}

std::vector<Rgba> SetColors::colors() const {
  std::lock_guard lock(mutex_);
  return colors_;
}

// After filter "up" a picture of labels is long runs of zeros with a few bytes between. Run-length matching is as fast as
// zlib's level 1 on them and a third of its size: every distance is 1 and costs no bits.
struct PngWriter::Deflate {
  z_stream stream{};
  Deflate() {
    if (deflateInit2(&stream, 1, Z_DEFLATED, 15, 9, Z_RLE) != Z_OK) throw Error("zlib can't start");
  }
  ~Deflate() { deflateEnd(&stream); }
};

PngWriter::PngWriter(uint32_t width, uint32_t height, const SetColors& colors, Sink sink)
    : width_(width), height_(height), colors_(colors), sink_(std::move(sink)), deflate_(std::make_unique<Deflate>()) {
  constexpr uint8_t kSignature[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  sink_(kSignature);
  known_ = colors.colors();
  bits_ = !colors.complete() ? 32 : known_.size() <= 2 ? 1 : known_.size() <= 4 ? 2 : known_.size() <= 16 ? 4 : 8;
  const bool palette = bits_ <= 8;
  std::vector<uint8_t> header;
  put_be32(header, width);
  put_be32(header, height);
  header.insert(header.end(), {static_cast<uint8_t>(palette ? bits_ : 8), static_cast<uint8_t>(palette ? 3 : 6), 0, 0, 0});
  chunk("IHDR", header);
  if (palette) {
    std::vector<uint8_t> rgb, alpha;
    for (const Rgba& c : known_) {
      rgb.insert(rgb.end(), c.begin(), c.begin() + 3);
      alpha.push_back(c[3]);
    }
    chunk("PLTE", rgb);
    while (!alpha.empty() && alpha.back() == 255) alpha.pop_back();  // those left out are opaque
    if (!alpha.empty()) chunk("tRNS", alpha);
  }
  const size_t bytes = (uint64_t{width} * static_cast<uint32_t>(bits_) + 7) / 8;
  above_.assign(bytes, 0);
  row_.resize(bytes);
  filtered_.resize(bytes + 1);
  same_.assign(bytes + 1, 0);
  filtered_[0] = same_[0] = 2;  // filter "up"
  out_.resize(kIdatBytes);
}

PngWriter::~PngWriter() = default;

void PngWriter::row(std::span<const uint16_t> numbers) {
  const bool again = numbers.size() == numbers_.size() && std::memcmp(numbers.data(), numbers_.data(), numbers.size_bytes()) == 0;
  if (again) return deflate_bytes(same_, false);
  numbers_.assign(numbers.begin(), numbers.end());
  if (bits_ == 32) fill_rgba();
  else if (bits_ == 8) std::ranges::copy(numbers_, row_.begin());
  else pack(numbers_, static_cast<unsigned>(bits_), row_.data());
  for (size_t i = 0; i < row_.size(); ++i) filtered_[i + 1] = static_cast<uint8_t>(row_[i] - above_[i]);
  above_.swap(row_);
  deflate_bytes(filtered_, false);
}

void PngWriter::fill_rgba() {
  // Sets turn up while rows are made: their colours are fetched when a number is new here.
  if (*std::ranges::max_element(numbers_) >= known_.size()) known_ = colors_.colors();
  uint8_t* out = row_.data();
  for (const uint16_t number : numbers_) {
    std::memcpy(out, known_[number].data(), 4);
    out += 4;
  }
}

void PngWriter::finish() {
  deflate_bytes({}, true);
  chunk("IEND", {});
}

void PngWriter::deflate_bytes(std::span<const uint8_t> bytes, bool last) {
  constexpr size_t kMost = 1 << 30;  // zlib counts in 32 bits
  z_stream& z = deflate_->stream;
  for (bool done = false; !done;) {
    if (z.avail_in == 0 && !bytes.empty()) {
      const size_t take = std::min(bytes.size(), kMost);
      z.next_in = const_cast<uint8_t*>(bytes.data());
      z.avail_in = static_cast<uInt>(take);
      bytes = bytes.subspan(take);
    }
    z.next_out = out_.data() + filled_;
    z.avail_out = static_cast<uInt>(out_.size() - filled_);
    const int result = deflate(&z, last ? Z_FINISH : Z_NO_FLUSH);
    filled_ = out_.size() - z.avail_out;
    done = last ? result == Z_STREAM_END : z.avail_in == 0 && bytes.empty();
    if (filled_ == out_.size() || (last && done)) {
      chunk("IDAT", {out_.data(), filled_});
      filled_ = 0;
    }
  }
}

void PngWriter::chunk(const char* type, std::span<const uint8_t> data) {
  std::vector<uint8_t> head;
  put_be32(head, static_cast<uint32_t>(data.size()));
  head.insert(head.end(), type, type + 4);
  sink_(head);
  sink_(data);
  uLong crc = crc32(0, reinterpret_cast<const Bytef*>(type), 4);
  crc = data.empty() ? crc : crc32(crc, data.data(), static_cast<uInt>(data.size()));
  std::vector<uint8_t> tail;
  put_be32(tail, static_cast<uint32_t>(crc));
  sink_(tail);
}

}  // namespace teracell
