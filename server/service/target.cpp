#include "server/service/target.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "server/service/message.hpp"

namespace teracell::server {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if ((c | 32) >= 'a' && (c | 32) <= 'f') return (c | 32) - 'a' + 10;
  return -1;
}

std::string decoded(std::string_view text) {
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    unsigned char c = static_cast<unsigned char>(text[i]);
    if (c == '%') {
      const int high = i + 1 < text.size() ? hex_digit(text[i + 1]) : -1, low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
      if (high < 0 || low < 0) throw bad_request("the address has a '%' without two hexadecimal digits after it");
      c = static_cast<unsigned char>(16 * high + low);
      i += 2;
    }
    if (c < 0x20 || c == 0x7f) throw bad_request("the address holds a control character");
    out += static_cast<char>(c);
  }
  return out;
}

}  // namespace

const std::string* Target::find(std::string_view key) const {
  const std::string* found = nullptr;
  for (const auto& [name, value] : query) {
    if (name != key) continue;
    if (found) throw bad_request(fmt::format("{}: expected once, found twice", key));
    found = &value;
  }
  return found;
}

void Target::allow(std::span<const std::string_view> known) const {
  for (const auto& [name, value] : query) {
    if (std::ranges::find(known, name) != known.end()) continue;
    std::string expected;
    for (const std::string_view one : known) expected.append(expected.empty() ? "one of " : ", ").append(one);
    throw bad_request(fmt::format("there is no parameter {}; expected {}", clipped(name), known.empty() ? "none" : expected));
  }
}

std::string clipped(std::string_view text) { return fmt::format("'{}{}'", text.substr(0, 48), text.size() > 48 ? "..." : ""); }

Target parse_target(std::string_view target) {
  if (!target.starts_with('/')) throw bad_request("expected an address that begins with '/'");
  Target out;
  const size_t question = target.find('?');
  for (const std::string_view part : split(target.substr(1, question == std::string_view::npos ? question : question - 1), '/'))
    out.path.push_back(decoded(part));
  if (question != std::string_view::npos && question + 1 < target.size())
    for (const std::string_view part : split(target.substr(question + 1), '&')) {
      const size_t sign = part.find('=');
      out.query.emplace_back(decoded(part.substr(0, sign)), sign == std::string_view::npos ? "" : decoded(part.substr(sign + 1)));
    }
  return out;
}

std::string_view path_of(std::string_view target) { return target.substr(0, target.find('?')); }

std::string percent_encoded(std::string_view segment) {
  std::string out;
  for (const char c : segment) {
    const bool plain = (c >= '0' && c <= '9') || ((c | 32) >= 'a' && (c | 32) <= 'z') || c == '-' || c == '.' || c == '_' || c == '~';
    if (plain) out += c;
    else out += fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

int64_t integer_in(std::string_view text, std::string_view name, int64_t lo, int64_t hi) {
  const auto value = number_in<int64_t>(text);
  if (!value || *value < lo || *value > hi)
    throw bad_request(fmt::format("{}: expected a whole number from {} to {}, found {}", name, lo, hi, clipped(text)));
  return *value;
}

namespace {

template <class T>
std::vector<T> numbers(std::string_view text, size_t count, std::string_view name, const char* kind) {
  if (auto out = numbers_in<T>(text, count)) return *std::move(out);
  throw bad_request(fmt::format("{}: expected {} {} separated by commas, found {}", name, count, kind, clipped(text)));
}

}  // namespace

std::vector<int64_t> integers(std::string_view text, size_t count, std::string_view name) {
  return numbers<int64_t>(text, count, name, "whole numbers");
}
std::vector<double> reals(std::string_view text, size_t count, std::string_view name) { return numbers<double>(text, count, name, "numbers"); }

std::optional<int64_t> plain_integer(std::string_view text) {
  int64_t value = 0;
  if (text.empty() || text.size() > 18 || (text[0] == '0' && text.size() > 1)) return std::nullopt;
  for (const char c : text) {
    if (c < '0' || c > '9') return std::nullopt;
    value = 10 * value + (c - '0');
  }
  return value;
}

}  // namespace teracell::server
