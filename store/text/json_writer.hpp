// JSON as text, written value by value. As a document, a list of 100,000 bodies takes hundreds of megabytes, and writing it
// takes longer than casting the rays. The text is the same as ascii_json() makes.
#pragma once
#include <charconv>
#include <concepts>
#include <cstdint>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace teracell::inline store {

// Appends to a text that it doesn't own. It has no other state: whether a comma is due follows from the text's last character.
class JsonWriter {
 public:
  explicit JsonWriter(std::string& text) : text_(text) {}

  JsonWriter& begin_object() { return begin('{'); }
  JsonWriter& end_object() { return end('}'); }
  JsonWriter& begin_array() { return begin('['); }
  JsonWriter& end_array() { return end(']'); }
  JsonWriter& key(std::string_view name) { return quoted(name, "\":"); }  // REQUIRES: nothing in it must be escaped

  JsonWriter& value(std::string_view text);
  JsonWriter& value(const char* text) { return value(std::string_view(text)); }
  JsonWriter& value(double number);
  template <std::integral T>
  JsonWriter& value(T number) {
    char digits[24];
    return raw(std::string_view(digits, static_cast<size_t>(std::to_chars(digits, std::end(digits), number).ptr - digits)));
  }
  JsonWriter& value(bool yes) { return raw(yes ? "true" : "false"); }
  JsonWriter& value(std::nullptr_t) { return raw("null"); }
  JsonWriter& value(std::span<const double> numbers);
  JsonWriter& value(std::span<const int64_t> numbers);

  template <class T>
  JsonWriter& field(std::string_view name, const T& what) {
    key(name);
    return value(what);
  }
  template <class T>
  JsonWriter& field(std::string_view name, const std::optional<T>& what) {
    return what ? field(name, *what) : field(name, nullptr);
  }
  // All digits of a count of cells; from 2^53 on, where others read it as a double, also as the text NAME_text.
  JsonWriter& count(std::string_view name, unsigned __int128 n);
  // Appends a value that is JSON already.
  JsonWriter& raw(std::string_view json);

 private:
  JsonWriter& quoted(std::string_view plain, std::string_view end);
  JsonWriter& begin(char bracket);
  JsonWriter& end(char bracket);
  void separate();
  std::string& text_;
};

// Appends a list of `count` items, each written by `item(writer, i)`, as far as they fit into `most` bytes. Returns how many
// are left out.
template <class F>
size_t write_list(std::string& text, size_t count, size_t most, F&& item) {
  JsonWriter writer(text);
  const size_t begin = text.size();
  writer.begin_array();
  for (size_t i = 0; i < count; ++i) {
    const size_t before = text.size();
    item(writer, i);
    if (text.size() - begin + 1 <= most) continue;
    text.resize(before);
    writer.end_array();
    return count - i;
  }
  writer.end_array();
  return 0;
}

}  // namespace teracell::store
