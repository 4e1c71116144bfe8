// The target of a request: path segments and query parameters, percent-decoded. Pure.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "store/text/words.hpp"

namespace teracell::server {

struct Target {
  std::vector<std::string> path;  // "/a/b%20c" has "a", "b c"; a slash at the end adds an empty segment
  std::vector<std::pair<std::string, std::string>> query;

  // The value of a parameter, or null. Throws HttpError 400 when the parameter is there twice.
  const std::string* find(std::string_view key) const;
  // Throws HttpError 400 naming the first parameter that is not one of `known`.
  void allow(std::span<const std::string_view> known) const;
  void allow(std::initializer_list<std::string_view> known) const { allow(std::span(known.begin(), known.size())); }
};

// Throws HttpError 400 unless it begins with '/', its percent-encodings are whole, and decoded it is free of NUL and other
// control characters. "." and ".." are segments like others: no segment ever becomes part of a file's path.
Target parse_target(std::string_view target);

std::string clipped(std::string_view text);  // text from a client, quoted, and cut so that a message can show it
std::string_view path_of(std::string_view target);  // without its query

// As one segment of an address.
std::string percent_encoded(std::string_view segment);

// `text` as a whole number in [lo, hi]. Throws HttpError 400 with `name` and the range.
int64_t integer_in(std::string_view text, std::string_view name, int64_t lo, int64_t hi);
// "1,2,3" as `count` whole numbers. Throws HttpError 400 with `name`.
std::vector<int64_t> integers(std::string_view text, size_t count, std::string_view name);
// The same for finite numbers.
std::vector<double> reals(std::string_view text, size_t count, std::string_view name);
// A number inside a name ("0-64_0-64_0-1"): nothing but digits, without superfluous zeros in front, at most 18 digits.
std::optional<int64_t> plain_integer(std::string_view text);

}  // namespace teracell::server
