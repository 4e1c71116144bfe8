// A value of a JSON document together with its place, so that every error can say where it is, what was expected and what was found.
#pragma once
#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "store/text/json_text.hpp"

namespace teracell::inline store {

// Borrows the value, and the JsonNode that it was found in, because its place is put into words only for an error. Every accessor
// throws FormatError when it finds something other than its name says.
class JsonNode {
 public:
  // `name` is that of the whole document, which is borrowed, too: "the scene".
  JsonNode(const Json& root, std::string_view name) : value_(&root), key_(name) {}

  std::string where() const;
  std::string found() const;
  [[noreturn]] void fail(const std::string& expected) const;

  // Refuses anything but an object, and keys other than these.
  void check_keys(std::initializer_list<std::string_view> known) const;
  std::optional<JsonNode> find(std::string_view key) const&;  // of an object
  JsonNode require(std::string_view key) const&;
  std::optional<JsonNode> find(std::string_view key) const&& = delete;  // what is found may not outlive this JsonNode
  JsonNode require(std::string_view key) const&& = delete;
  std::vector<JsonNode> members() const&;  // of an object, in the order of the text
  std::vector<JsonNode> members() const&& = delete;
  std::string_view key() const { return key_; }  // of a member

  bool is_null() const { return value_->is_null(); }
  bool is_object() const { return value_->is_object(); }
  bool is_array() const { return value_->is_array(); }
  bool is_string() const { return value_->is_string(); }
  const Json& json() const { return *value_; }
  std::vector<JsonNode> items() const&;              // of an array
  std::vector<JsonNode> items(size_t count) const&;  // of an array with exactly `count` elements
  std::vector<JsonNode> items() const&& = delete;
  std::vector<JsonNode> items(size_t count) const&& = delete;
  // Calls f with each item of the array under the key, if there is one.
  template <class F>
  void each(std::string_view key, F&& f) const {
    if (const auto list = find(key))
      for (const JsonNode& item : list->items()) f(item);
  }

  double exact() const;                        // a number
  double number() const { return exact() + 0.0; }  // -0 is 0
  double positive() const;
  std::optional<double> number_or_null(std::string_view key) const&;  // of an object that has the key
  int64_t integer(int64_t lo, int64_t hi) const;      // 1e3 and 1000.0 are integers, too
  uint64_t whole(uint64_t hi = ~uint64_t{0}) const;  // from 0 to hi; 1e3 and 1000.0 are not whole
  bool boolean() const;
  const std::string& any_text() const;
  const std::string& text() const;  // not empty, without control characters
  size_t choice(std::span<const std::string_view> words) const;  // the index of the word
  size_t choice(std::initializer_list<std::string_view> words) const { return choice(std::span(words.begin(), words.size())); }
  template <size_t kCount>
  std::array<double, kCount> numbers() const {
    const std::vector<JsonNode> list = items(kCount);
    std::array<double, kCount> out;
    for (size_t i = 0; i < kCount; ++i) out[i] = list[i].number();
    return out;
  }
  template <size_t kCount>
  std::array<int64_t, kCount> wholes() const {
    const std::vector<JsonNode> list = items(kCount);
    std::array<int64_t, kCount> out;
    for (size_t i = 0; i < kCount; ++i) out[i] = static_cast<int64_t>(list[i].whole(INT64_MAX));
    return out;
  }

 private:
  JsonNode(const Json& value, const JsonNode& parent, std::string_view key, size_t index)
      : value_(&value), parent_(&parent), key_(key), index_(index) {}
  std::string path() const;
  const Json* value_;
  const JsonNode* parent_ = nullptr;  // null for the root
  std::string_view key_;              // in an object; of the root, its name
  size_t index_ = 0;                  // in an array
};

}  // namespace teracell::inline store
