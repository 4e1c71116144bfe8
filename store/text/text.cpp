#include "store/text/text.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace teracell::inline store {
namespace {

size_t edit_distance(std::string_view a, std::string_view b) {
  constexpr size_t kLongest = 64;  // bounds the work on absurdly long keys; real ones differ long before
  a = a.substr(0, kLongest), b = b.substr(0, kLongest);
  std::vector<size_t> row(b.size() + 1);  // distances from the prefix of a so far to every prefix of b
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 0; i < a.size(); ++i) {
    size_t diagonal = std::exchange(row[0], i + 1);
    for (size_t j = 0; j < b.size(); ++j) {
      const size_t replaced = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, diagonal + 1, row[j] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string utf8_of(std::string_view text) {
  using nlohmann::ordered_json;
  const auto is_ascii = [](char c) { return (static_cast<unsigned char>(c) & 0x80) == 0; };
  std::string out;
  for (auto at = text.begin(); at != text.end();) {
    auto end = std::find_if_not(at, text.end(), is_ascii);
    out.append(at, end);
    at = std::find_if(end, text.end(), is_ascii);
    if (at == end) break;
    const std::string quoted =
        ordered_json(std::string(end, at)).dump(-1, ' ', false, ordered_json::error_handler_t::replace);  // it escapes ASCII alone
    out.append(quoted, 1, quoted.size() - 2);
  }
  return out;
}

std::string printable(std::string_view text) {
  if (std::ranges::all_of(text, [](char c) { return c >= ' ' && c < '\x7f'; })) return std::string(text);  // like nearly all texts
  const std::string utf8 = utf8_of(text);
  std::string out;
  for (size_t i = 0; i < utf8.size(); ++i) {
    const auto byte = [&](size_t at) { return static_cast<unsigned char>(utf8[at]); };
    const bool c1 = byte(i) == 0xc2 && byte(i + 1) < 0xa0;  // U+0080 to U+009F take two bytes
    // U+2028 to U+202E and U+2066 to U+2069 end a line, or turn the direction of what follows.
    const bool turns = byte(i) == 0xe2 && ((byte(i + 1) == 0x80 && byte(i + 2) >= 0xa8 && byte(i + 2) <= 0xae) ||
                                           (byte(i + 1) == 0x81 && byte(i + 2) >= 0xa6 && byte(i + 2) <= 0xa9));
    out += byte(i) < 0x20 || byte(i) == 0x7f || c1 || turns ? '?' : utf8[i];
    i += c1 ? 1 : turns ? 2 : 0;
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

// (The page's module has no fmt for 128 bits.)
std::string counted(unsigned __int128 n, std::string_view one, std::string_view many) {
  std::string digits = whole_text(n);
  for (size_t i = digits.size(); i > 3;) digits.insert(i -= 3, ",");
  if (n != 1 && !many.empty()) return fmt::format("{} {}", digits, many);
  return fmt::format("{} {}{}", digits, one, n == 1 ? "" : "s");
}

std::string_view nearest(std::string_view word, std::span<const std::string_view> candidates) {
  const auto closer = [&](std::string_view a, std::string_view b) { return edit_distance(word, a) < edit_distance(word, b); };
  const auto best = std::ranges::min_element(candidates, closer);
  return best == candidates.end() ? std::string_view{} : *best;
}

bool resembles(std::string_view word, std::string_view other) { return 2 * edit_distance(word, other) <= std::max(word.size(), other.size()); }

}  // namespace teracell::store
