#include "store/text/json_writer.hpp"

#include <algorithm>
#include <cmath>

#include "store/text/json_text.hpp"
#include "store/text/text.hpp"

namespace teracell::inline store {

void JsonWriter::separate() {
  const char last = text_.empty() ? ',' : text_.back();
  if (last != '{' && last != '[' && last != ':' && last != ',') text_ += ',';
}

JsonWriter& JsonWriter::begin(char bracket) {
  separate();
  text_ += bracket;
  return *this;
}

JsonWriter& JsonWriter::end(char bracket) {
  text_ += bracket;
  return *this;
}

JsonWriter& JsonWriter::raw(std::string_view json) {
  separate();
  text_ += json;
  return *this;
}

JsonWriter& JsonWriter::quoted(std::string_view plain, std::string_view end) {
  separate();
  text_ += '"';
  text_ += plain;
  text_ += end;
  return *this;
}

JsonWriter& JsonWriter::value(std::string_view text) {
  const bool plain = std::ranges::all_of(text, [](char c) { return c >= ' ' && c < '\x7f' && c != '"' && c != '\\'; });
  return plain ? quoted(text, "\"") : raw(ascii_json(text));
}

JsonWriter& JsonWriter::value(double number) {
  if (!std::isfinite(number)) return value(nullptr);
  return raw(Json(number).dump());
}

JsonWriter& JsonWriter::value(std::span<const double> numbers) {
  begin_array();
  for (const double x : numbers) value(x);
  return end_array();
}

JsonWriter& JsonWriter::value(std::span<const int64_t> numbers) {
  begin_array();
  for (const int64_t n : numbers) value(n);
  return end_array();
}

JsonWriter& JsonWriter::count(std::string_view name, unsigned __int128 n) {
  const std::string digits = whole_text(n);
  key(name).raw(digits);
  return n >> 53 == 0 ? *this : field(std::string(name) + "_text", digits);
}

}  // namespace teracell::store
