#include "store/text/text.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "store/text/json_text.hpp"

namespace teracell::inline store {

std::string printable(std::string_view text) {
  if (std::ranges::all_of(text, [](char c) { return c >= ' ' && c < '\x7f'; })) return std::string(text);  // like nearly all texts
  const std::string utf8 = utf8_of(text);
  std::string out;
  for (size_t i = 0; i < utf8.size(); ++i) {
    const auto byte = [&](size_t at) { return static_cast<unsigned char>(utf8[at]); };
    const bool c1 = byte(i) == 0xc2 && byte(i + 1) < 0xa0;  // U+0080 to U+009F take two bytes
    out += byte(i) < 0x20 || byte(i) == 0x7f || c1 ? '?' : utf8[i];
    i += c1;
  }
  return out;
}

std::string shortened(std::string_view text) {
  if (text.size() <= kLongestMessage) return std::string(text);
  constexpr std::string_view kGap = " [...] ";
  constexpr size_t kEnd = kLongestMessage / 4;  // a message ends with the reason, and begins with the place
  size_t head = kLongestMessage - kEnd - kGap.size(), tail = text.size() - kEnd;
  const auto is_inside = [&](size_t at) { return (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80; };  // of a character
  for (int i = 0; i < 3 && is_inside(head); ++i) --head;
  for (int i = 0; i < 3 && is_inside(tail); ++i) ++tail;
  return std::string(text.substr(0, head)).append(kGap).append(text.substr(tail));
}

std::string_view first_bytes(std::string_view utf8, size_t most) {
  if (utf8.size() <= most) return utf8;
  while (most > 0 && (static_cast<unsigned char>(utf8[most]) & 0xc0) == 0x80) --most;
  return utf8.substr(0, most);
}

std::string whole_text(unsigned __int128 number) {
  std::string out;
  do out.insert(out.begin(), static_cast<char>('0' + static_cast<int>(number % 10)));
  while ((number /= 10) != 0);
  return out;
}

std::string plural(uint64_t n, std::string_view thing) { return fmt::format("{} {}{}", n, thing, n == 1 ? "" : "s"); }

}  // namespace teracell::store
