#include "store/text/json_text.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/text/json_check.hpp"
#include "store/text/text.hpp"

namespace teracell::inline store {
namespace {

// Builds a document while it is parsed. The library's own builders look through all elements of an array after each of them,
// when a callback bounds the depth, and through all keys of an object before each. A file of 65,535 materials took seconds
// to open.
class Builder {
 public:
  Builder(Json& root, std::string_view text, const std::string& what, size_t most_values, const JsonParts& parts)
      : root_(root), text_(text), what_(what), most_values_(most_values), parts_(parts) {}

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
    if (skipped_ == 0) key_ = std::move(key);
    return true;
  }
  bool end_object() {
    if (skipped_ == 0) expect_different_keys();
    return close();
  }
  bool end_array() { return close(); }

  bool parse_error(size_t position, const std::string&, const nlohmann::json::exception& e) {
    // The parser's message is "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error ...";
    // its own line and column give way to ours.
    std::string words = e.what();
    words.erase(0, words.find("] ") + 2);
    if (words.starts_with("parse error at ")) words.erase(0, words.find(": ") + 2);
    const std::string_view read = text_.substr(0, std::max(position, size_t{1}) - 1);
    const size_t line_start = read.rfind('\n') + 1;  // npos + 1 is 0
    fail(fmt::format("line {}, column {}: {}", std::ranges::count(read, '\n') + 1, read.size() - line_start + 1, shortened(printable(words))));
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw FormatError(what_.empty() ? message : what_ + ": " + message); }

  Json& add(Json value) {
    if (values_++ == most_values_) fail(fmt::format("expected JSON of at most {} values, found more", most_values_));
    if (open_.empty()) return root_ = std::move(value);
    Json& parent = *open_.back();
    if (parent.is_array()) return parent.get_ref<Json::array_t&>().emplace_back(std::move(value));
    auto& members = parent.get_ref<Json::object_t&>();
    members.push_back({std::move(key_), std::move(value)});
    return members.back().second;
  }
  bool put(Json value) {
    if (skips(value)) return true;
    add(std::move(value));
    hand_out();
    return true;
  }
  bool open(Json value) {
    if (open_.size() + skipped_ == kDeepestJson) fail(fmt::format("expected JSON of at most {} levels, found more", kDeepestJson));
    if (skips(value)) {
      ++skipped_;
      return true;
    }
    open_.push_back(&add(std::move(value)));
    if (hands_out()) taken_ = 0, kept_ = values_;
    return true;
  }
  bool close() {
    if (skipped_ > 0) {
      --skipped_;
      return true;
    }
    open_.pop_back();
    hand_out();
    return true;
  }

  // The last key of an open object.
  const std::string& key_in(size_t level) const { return open_[level]->get_ref<const Json::object_t&>().back().first; }

  // Whether the object of which only the lists are read is open, and whether the value, which comes next, is something else in it.
  bool is_within() const {
    return open_.size() > 1 && !parts_.within.empty() && open_[0]->is_object() && open_[1]->is_object() && key_in(0) == parts_.within;
  }
  bool skips(const Json& value) const { return skipped_ > 0 || (open_.size() == 2 && !value.is_array() && is_within()); }

  // Whether the innermost open value is a list that is handed out.
  bool hands_out() const {
    if (!parts_.take || !open_.back()->is_array() || !open_[0]->is_object()) return false;
    return open_.size() == 2 || (open_.size() == 3 && is_within());
  }

  // Called when a value is complete.
  void hand_out() {
    if (open_.empty() || !hands_out()) return;
    auto& list = open_.back()->get_ref<Json::array_t&>();
    parts_.take(open_.size() == 2 ? key_in(0) : fmt::format("{}.{}", key_in(0), key_in(1)), taken_++, list.back());
    list.pop_back();
    values_ = kept_;
  }

  void expect_different_keys() {
    keys_.clear();
    for (const auto& [key, value] : open_.back()->get_ref<const Json::object_t&>()) keys_.push_back(key);
    std::ranges::sort(keys_);
    if (const auto twice = std::ranges::adjacent_find(keys_); twice != keys_.end())
      fail(shortened(json_path(place(), *twice)) + ": this key is given twice: keep one of them");
  }

  // Of the innermost value that is open.
  std::string place() const {
    std::string path;
    const size_t list = is_within() ? 2 : 1;
    for (size_t i = 0; i + 1 < open_.size(); ++i)
      path =
          open_[i]->is_array() ? fmt::format("{}[{}]", path, i == list && parts_.take ? taken_ : open_[i]->size() - 1) : json_path(path, key_in(i));
    return path;
  }

  Json& root_;
  const std::string_view text_;
  const std::string& what_;
  const size_t most_values_;
  const JsonParts& parts_;
  size_t values_ = 0;
  std::vector<Json*> open_;  // the values being filled, the innermost last. Only that one grows, so the others don't move
  std::string key_;          // of the value to come
  size_t skipped_ = 0;           // levels that are open and skipped
  size_t taken_ = 0, kept_ = 0;  // of the list that is read element by element: those that are done, and the values before it
  std::vector<std::string_view> keys_;  // scratch
};

}  // namespace

Json parse_json(std::string_view text, const std::string& what, size_t most_values, const JsonParts& parts) {
  Json root;
  Builder builder(root, text, what, most_values, parts);
  Json::sax_parse(text, &builder);
  return root;
}

std::string json_path(const std::string& parent, std::string_view key) {
  const bool plain = !key.empty() && std::ranges::all_of(key, [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-' || c == '*'; });
  if (!plain) return fmt::format("{}[{}]", parent, printable(Json(key).dump()));
  return parent.empty() ? std::string(key) : fmt::format("{}.{}", parent, key);
}

std::string ascii_json(const Json& j) { return j.dump(-1, ' ', true, Json::error_handler_t::replace); }

}  // namespace teracell::store
