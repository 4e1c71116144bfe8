#include "store/json_writer.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace teracell {

void JsonWriter::separate() {
  constexpr std::string_view kBefore = "{[:,";
  if (!text_.empty() && kBefore.find(text_.back()) == kBefore.npos) text_ += ',';
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

JsonWriter& JsonWriter::key(std::string_view name) {
  value(name);
  text_ += ':';
  return *this;
}

JsonWriter& JsonWriter::value(std::string_view text) {
  const bool plain = std::ranges::all_of(text, [](char c) { return c >= ' ' && c < '\x7f' && c != '"' && c != '\\'; });
  if (!plain) return raw(nlohmann::ordered_json(text).dump());
  separate();
  text_ += '"';
  text_ += text;
  text_ += '"';
  return *this;
}

JsonWriter& JsonWriter::value(double number) {
  const bool whole = number == std::trunc(number) && std::abs(number) < 1e15 && (number != 0 || !std::signbit(number));
  return raw(whole ? fmt::format("{}.0", static_cast<int64_t>(number)) : nlohmann::ordered_json(number).dump());
}

JsonWriter& JsonWriter::value(std::span<const double> numbers) {
  begin_array();
  for (const double x : numbers) value(x);
  return end_array();
}

}  // namespace teracell
