// Words and numbers in texts that people and programs write: options, addresses, headers.
#pragma once
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <type_traits>
#include <vector>

namespace teracell::inline store {

inline bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

inline std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

// The parts between separators: one more than there are separators.
inline std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> out;
  for (;;) {
    const size_t end = text.find(separator);
    out.push_back(text.substr(0, end));
    if (end == text.npos) return out;
    text.remove_prefix(end + 1);
  }
}

// The number that the whole text is, if it is one that fits and is finite.
template <class T>
std::optional<T> number_in(std::string_view text) {
  T value = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || rest != text.data() + text.size()) return std::nullopt;
  if constexpr (std::is_floating_point_v<T>)
    if (!std::isfinite(value)) return std::nullopt;
  return value;
}

// "1,2,3", if these are `count` such numbers.
template <class T>
std::optional<std::vector<T>> numbers_in(std::string_view text, size_t count) {
  std::vector<T> out;
  for (const std::string_view part : split(text, ',')) {
    const auto number = number_in<T>(part);
    if (!number || out.size() == count) return std::nullopt;
    out.push_back(*number);
  }
  return out.size() == count ? std::optional(std::move(out)) : std::nullopt;
}

// "1-4,7": of each number below `end`, whether it is one of these, if all of them are below it.
inline std::optional<std::vector<bool>> ranges_in(std::string_view text, size_t end) {
  std::vector<bool> out(end);
  for (const std::string_view part : split(text, ',')) {
    const size_t dash = part.find('-');
    const auto first = number_in<size_t>(part.substr(0, dash));
    const auto last = dash == part.npos ? first : number_in<size_t>(part.substr(dash + 1));
    if (!first || !last || *first > *last || *last >= end) return std::nullopt;
    for (size_t i = *first; i <= *last; ++i) out[i] = true;
  }
  return out;
}

}  // namespace teracell::store
