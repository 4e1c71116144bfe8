// Little-endian numbers <-> bytes. Reading checks every count against the bytes that remain.
#pragma once
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "store/base/error.hpp"

namespace teracell::inline store {

using Bytes = std::vector<uint8_t>;

template <class T>
void put_fixed(Bytes& out, T value) {
  for (size_t i = 0; i < sizeof(T); ++i) out.push_back(static_cast<uint8_t>(static_cast<uint64_t>(value) >> (8 * i)));
}

// The number whose bytes begin at `from`.
template <class T>
T fixed_at(const uint8_t* from) {
  uint64_t v = 0;
  for (size_t i = 0; i < sizeof(T); ++i) v |= uint64_t{from[i]} << (8 * i);
  return static_cast<T>(v);
}

// LEB128: seven bits per byte, the least significant first; the high bit says that another byte follows.
inline void put_varint(Bytes& out, uint64_t value) {
  for (; value >= 0x80; value >>= 7) out.push_back(static_cast<uint8_t>(value | 0x80));
  out.push_back(static_cast<uint8_t>(value));
}

// Bytes, or a text, after their number.
inline void put_sized(Bytes& out, std::span<const uint8_t> bytes) {
  put_varint(out, bytes.size());
  out.insert(out.end(), bytes.begin(), bytes.end());
}
inline void put_sized(Bytes& out, const std::string& text) { put_sized(out, {reinterpret_cast<const uint8_t*>(text.data()), text.size()}); }

class ByteReader {
 public:
  // `what` names the structure in messages. Where FORMAT.md has it, `clause` is the one that messages cite.
  ByteReader(std::span<const uint8_t> bytes, std::string what, const char* clause = nullptr)
      : bytes_(bytes), what_(std::move(what)), clause_(clause) {}

  size_t remaining() const { return bytes_.size() - at_; }
  // What follows is in this clause.
  void clause(const char* number) { clause_ = number; }
  [[noreturn]] void fail(const std::string& message, Remedy remedy = Remedy::kNone) const {
    const std::string cited = clause_ == nullptr ? "" : std::string(" (FORMAT.md ") + clause_ + ")";
    throw FormatError(what_ + ": byte " + std::to_string(at_) + ": " + message + cited, remedy);
  }
  std::span<const uint8_t> take(uint64_t count) {
    if (count > remaining()) fail("expected " + std::to_string(count) + " more bytes, found " + std::to_string(remaining()));
    at_ += count;
    return bytes_.subspan(at_ - count, count);
  }
  template <class T>
  T fixed() {
    return fixed_at<T>(take(sizeof(T)).data());
  }
  uint64_t varint() {
    uint64_t v = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      if (at_ == bytes_.size()) fail("a number is cut short");
      const uint8_t b = bytes_[at_++];
      if (shift == 63 && b > 1) break;
      v |= uint64_t{b & 0x7Fu} << shift;
      if (b < 0x80) return v;
    }
    fail("a number has more than 64 bits");
  }
  // A varint that must lie in [lo, hi].
  uint64_t varint(uint64_t lo, uint64_t hi, const char* name) {
    const uint64_t v = varint();
    if (v < lo || v > hi) fail(std::string(name) + " must be " + std::to_string(lo) + " to " + std::to_string(hi) + ", found " + std::to_string(v));
    return v;
  }
  std::span<const uint8_t> take_sized() { return take(varint()); }  // what put_sized() put
  void expect_end() const {
    if (remaining() != 0) fail("expected the end, found " + std::to_string(remaining()) + " more bytes");
  }

 private:
  std::span<const uint8_t> bytes_;
  size_t at_ = 0;
  std::string what_;
  const char* clause_;
};

}  // namespace teracell::store
