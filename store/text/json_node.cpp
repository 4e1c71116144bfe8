#include "store/text/json_node.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "store/base/error.hpp"
#include "store/text/text.hpp"

namespace teracell::inline store {

std::string JsonNode::path() const {
  if (!parent_) return "";
  return parent_->is_array() ? fmt::format("{}[{}]", parent_->path(), index_) : json_path(parent_->path(), key_);
}

std::string JsonNode::where() const { return parent_ ? path() : std::string(key_); }

void JsonNode::fail(const std::string& expected) const { throw FormatError(fmt::format("{}: expected {}, found {}", where(), expected, found())); }

std::string JsonNode::found() const {
  if (is_object()) return "an object";
  if (is_array()) return fmt::format("an array of {}", value_->size());
  constexpr size_t kLongest = 60;
  const std::string text = printable(value_->dump());
  return text.size() > kLongest ? fmt::format("{}...", first_bytes(text, kLongest)) : text;
}

void JsonNode::check_keys(std::initializer_list<std::string_view> known) const {
  for (const JsonNode& member : members()) {
    if (std::ranges::find(known, member.key_) != known.end()) continue;
    throw FormatError(fmt::format("{}: unknown key {}: the nearest known one is \"{}\" (known here: {})", where(),
                                  printable(Json(member.key_).dump()), nearest(member.key_, known), fmt::join(known, ", ")));
  }
}

std::optional<JsonNode> JsonNode::find(std::string_view key) const& {
  if (!is_object()) fail("an object");
  const auto it = value_->find(key);
  if (it == value_->end()) return std::nullopt;
  return JsonNode(*it, *this, it.key(), 0);
}

JsonNode JsonNode::require(std::string_view key) const& {
  const std::optional<JsonNode> node = find(key);
  if (!node) throw FormatError(fmt::format("{}: the key \"{}\" is missing", where(), key));
  return *node;
}

std::vector<JsonNode> JsonNode::members() const& {
  if (!is_object()) fail("an object");
  std::vector<JsonNode> nodes;
  nodes.reserve(value_->size());
  for (const auto& [key, value] : value_->get_ref<const Json::object_t&>()) nodes.push_back(JsonNode(value, *this, key, 0));
  return nodes;
}

std::vector<JsonNode> JsonNode::items() const& {
  if (!is_array()) fail("an array");
  std::vector<JsonNode> nodes;
  nodes.reserve(value_->size());
  for (const Json& item : *value_) nodes.push_back(JsonNode(item, *this, {}, nodes.size()));
  return nodes;
}

std::vector<JsonNode> JsonNode::items(size_t count) const& {
  if (!is_array() || value_->size() != count) fail(fmt::format("an array of {}", count));
  return items();
}

double JsonNode::exact() const {
  if (!value_->is_number()) fail("a number");
  return value_->get<double>();
}

double JsonNode::positive() const {
  const double x = number();
  if (!(x > 0)) fail("a number above 0");
  return x;
}

std::optional<double> JsonNode::number_or_null(std::string_view key) const& {
  const JsonNode n = require(key);
  return n.is_null() ? std::nullopt : std::optional(n.number());
}

bool JsonNode::boolean() const {
  if (!value_->is_boolean()) fail("true or false");
  return value_->get<bool>();
}

int64_t JsonNode::integer(int64_t lo, int64_t hi) const {
  const std::string expected = fmt::format("an integer from {} to {}", lo, hi);
  int64_t n = 0;
  if (value_->is_number_unsigned()) {
    if (value_->get<uint64_t>() > static_cast<uint64_t>(INT64_MAX)) fail(expected);
    n = value_->get<int64_t>();
  } else if (value_->is_number_integer()) {
    n = value_->get<int64_t>();
  } else if (value_->is_number_float()) {
    const double x = value_->get<double>();
    if (!(std::abs(x) <= 0x1p53) || x != std::trunc(x)) fail(expected);
    n = static_cast<int64_t>(x);
  } else {
    fail(expected);
  }
  if (n < lo || n > hi) fail(expected);
  return n;
}

uint64_t JsonNode::whole(uint64_t hi) const {
  if (!value_->is_number_unsigned() || value_->get<uint64_t>() > hi)
    fail(hi == ~uint64_t{0} ? "a whole number" : fmt::format("a whole number from 0 to {}", hi));
  return value_->get<uint64_t>();
}

const std::string& JsonNode::any_text() const {
  if (!is_string()) fail("a string");
  return value_->get_ref<const std::string&>();
}

const std::string& JsonNode::text() const {
  const std::string& text = any_text();
  if (text.empty()) fail("a string that is not empty");
  if (printable(text) != text) fail("a string without control characters");
  return text;
}

size_t JsonNode::choice(std::span<const std::string_view> words) const {
  const auto it = is_string() ? std::ranges::find(words, any_text()) : words.end();
  if (it == words.end()) {
    const std::string hint = is_string() ? fmt::format(" (did you mean \"{}\"?)", nearest(any_text(), words)) : "";
    fail(fmt::format("one of {}{}", fmt::join(words, ", "), hint));
  }
  return static_cast<size_t>(it - words.begin());
}

}  // namespace teracell::inline store
