#include "store/text/json_text.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/text/json_check.hpp"

namespace teracell::inline store {
namespace {

using Json = nlohmann::ordered_json;

// Builds a document while it is parsed. The library's own builders look through all elements of an array after each of them,
// when a callback bounds the depth, and through all keys of an object before each. A file of 65,535 materials took seconds
// to open.
class Builder {
 public:
  Builder(Json& root, const std::string& what, size_t most_values) : root_(root), what_(what), most_values_(most_values) {}

  bool null() { return put(nullptr); }
  bool boolean(bool value) { return put(value); }
  bool number_integer(Json::number_integer_t value) { return put(value); }
  bool number_unsigned(Json::number_unsigned_t value) { return put(value); }
  bool number_float(Json::number_float_t value, const std::string&) { return put(value); }
  bool string(std::string& value) { return put(std::move(value)); }
  bool binary(Json::binary_t&) { return false; }  // text has none
  bool start_object(size_t) { return open(Json::object()); }
  bool start_array(size_t) { return open(Json::array()); }
  bool key(std::string& key) {
    key_ = std::move(key);
    return true;
  }
  bool end_object() {
    expect_different_keys();
    return close();
  }
  bool end_array() { return close(); }
  bool parse_error(size_t at, const std::string&, const nlohmann::json::exception&) {
    throw FormatError(fmt::format("{}: expected JSON, found something else at byte {}", what_, at));
  }

 private:
  Json& add(Json value) {
    if (values_++ == most_values_) throw FormatError(fmt::format("{}: expected JSON of at most {} values, found more", what_, most_values_));
    if (open_.empty()) return root_ = std::move(value);
    Json& parent = *open_.back();
    if (parent.is_array()) return parent.get_ref<Json::array_t&>().emplace_back(std::move(value));
    auto& members = parent.get_ref<Json::object_t&>();
    members.push_back({std::move(key_), std::move(value)});
    return members.back().second;
  }
  bool put(Json value) {
    add(std::move(value));
    return true;
  }
  bool open(Json value) {
    if (open_.size() == kDeepestJson) throw FormatError(fmt::format("{}: expected JSON of at most {} levels, found more", what_, kDeepestJson));
    open_.push_back(&add(std::move(value)));
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  void expect_different_keys() {
    keys_.clear();
    for (const auto& [key, value] : open_.back()->get_ref<const Json::object_t&>()) keys_.push_back(key);
    std::ranges::sort(keys_);
    if (const auto twice = std::ranges::adjacent_find(keys_); twice != keys_.end())
      throw FormatError(fmt::format("{}: expected keys that differ, found {} twice in an object", what_, ascii_json(twice->substr(0, 60))));
  }

  Json& root_;
  const std::string& what_;
  const size_t most_values_;
  size_t values_ = 0;
  std::vector<Json*> open_;  // the values being filled, the innermost last. Only that one grows, so the others don't move
  std::string key_;          // of the value to come
  std::vector<std::string_view> keys_;  // scratch
};

}  // namespace

Json parse_json(const std::string& text, const std::string& what, size_t most_values) {
  Json root;
  Builder builder(root, what, most_values);
  Json::sax_parse(text, &builder);
  return root;
}

std::string ascii_json(const Json& j) { return j.dump(-1, ' ', true, Json::error_handler_t::replace); }

std::string utf8_of(std::string_view text) { return parse_json(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace), "text"); }

}  // namespace teracell::store
