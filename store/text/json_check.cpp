#include "store/text/json_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <ranges>
#include <vector>

#include <fmt/format.h>

#include "store/base/error.hpp"

namespace teracell::inline store {
namespace {

// A text as UTF-16 code units, hashed (G. Fowler, L. C. Noll, P. Vo: FNV-1a): "\u0061" and "a" are the same key. Keys that
// differ and have the same hash don't occur by chance; a file made for that is refused, which hurts nobody else.
class KeyHash {
 public:
  void add(uint32_t unit) { hash_ = (hash_ ^ unit) * 0x100000001B3; }
  uint64_t value() const { return hash_; }

 private:
  uint64_t hash_ = 0xCBF29CE484222325;
};

class Checker {
 public:
  Checker(std::string_view text, const std::string& what) : text_(text), what_(what) {}

  void check() {
    value(0);
    skip_space();
    if (at_ != text_.size()) fail("the end of the text", "more");
  }

 private:
  [[noreturn]] void fail(const std::string& expected, const char* found = "something else") const {
    throw FormatError(fmt::format("{}: byte {}: expected {}, found {}", what_, at_, expected, found));
  }

  // 0 at the end. A zero byte in the text is nowhere expected either.
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  bool take(char c) {
    if (peek() != c) return false;
    ++at_;
    return true;
  }
  bool is_digit() const { return peek() >= '0' && peek() <= '9'; }
  void skip_space() {
    while (peek() == ' ' || peek() == '\n' || peek() == '\r' || peek() == '\t') ++at_;
  }

  // Calls item() for each of the items up to the closing bracket.
  template <class F>
  void list(size_t depth, char end, F&& item) {
    if (depth == kDeepestJson) fail(fmt::format("JSON of at most {} levels", kDeepestJson), "more");
    ++at_;
    skip_space();
    if (take(end)) return;
    do {
      skip_space();
      item();
      skip_space();
    } while (take(','));
    if (!take(end)) fail(fmt::format("',' or '{}'", end));
  }

  void value(size_t depth) {
    skip_space();
    switch (peek()) {
      case '{': return object(depth);
      case '[': return list(depth, ']', [&] { value(depth + 1); });
      case '"': string(); return;
      case 't': return word("true");
      case 'f': return word("false");
      case 'n': return word("null");
      default: return number();
    }
  }

  void object(size_t depth) {
    const size_t first = keys_.size();
    list(depth, '}', [&] {
      if (keys_.size() - first == kMostJsonKeys) fail(fmt::format("at most {} keys in an object", kMostJsonKeys), "more");
      keys_.push_back(string());
      skip_space();
      if (!take(':')) fail("':'");
      value(depth + 1);
    });
    const auto mine = keys_.begin() + static_cast<ptrdiff_t>(first);
    std::ranges::sort(std::ranges::subrange(mine, keys_.end()));
    if (std::adjacent_find(mine, keys_.end()) != keys_.end()) fail("keys that differ in the object that ends here", "one that occurs twice");
    keys_.resize(first);
  }

  void word(std::string_view expected) {
    if (!text_.substr(at_).starts_with(expected)) fail("JSON");
    at_ += expected.size();
  }

  void digits() {
    if (!is_digit()) fail("JSON");
    while (is_digit()) ++at_;
  }

  void number() {
    const size_t first = at_;
    take('-');
    if (!take('0')) digits();
    if (take('.')) digits();
    if (take('e') || take('E')) {
      if (!take('+')) take('-');
      digits();
    }
    constexpr size_t kSurelyFinite = 300, kLongest = 1024;  // without an exponent
    const std::string_view text = text_.substr(first, at_ - first);
    if (text.size() > kLongest) fail(fmt::format("numbers of at most {} characters", kLongest), "a longer one");
    if (text.size() <= kSurelyFinite && text.find_first_of("eE") == std::string_view::npos) return;
    if (!std::isfinite(std::strtod(std::string(text).c_str(), nullptr))) fail("numbers that a double can hold", "a larger one");
  }

  // Returns the text's hash.
  uint64_t string() {
    if (!take('"')) fail("a text in quotes");
    KeyHash hash;
    for (;;) {
      const auto c = static_cast<unsigned char>(peek());
      if (c < 0x20 || c >= 0x7f) fail("a text of printable ASCII characters that ends with quotes");
      ++at_;
      if (c == '"') return hash.value();
      if (c == '\\') escape(hash);
      else hash.add(c);
    }
  }

  void escape(KeyHash& hash) {
    static constexpr std::string_view kShort = "\"\\/bfnrt", kMeaning = "\"\\/\b\f\n\r\t";
    if (const size_t i = kShort.find(peek()); i != std::string_view::npos) {
      ++at_;
      return hash.add(static_cast<unsigned char>(kMeaning[i]));
    }
    const uint32_t unit = code_unit();
    hash.add(unit);
    if (unit < 0xD800 || unit > 0xDFFF) return;
    const bool escaped = unit < 0xDC00 && take('\\');
    const uint32_t second = escaped ? code_unit() : 0;
    if (second < 0xDC00 || second > 0xDFFF) fail("a pair of surrogates", "one alone");
    hash.add(second);
  }

  uint32_t code_unit() {
    if (!take('u')) fail("an escape sequence of JSON");
    uint32_t unit = 0;
    for (int i = 0; i < 4; ++i) {
      const char c = peek(), letter = static_cast<char>(c | 32);
      if (is_digit()) unit = 16 * unit + static_cast<uint32_t>(c - '0');
      else if (letter >= 'a' && letter <= 'f') unit = 16 * unit + static_cast<uint32_t>(letter - 'a' + 10);
      else fail("four hexadecimal digits");
      ++at_;
    }
    return unit;
  }

  const std::string_view text_;
  const std::string& what_;
  size_t at_ = 0;
  std::vector<uint64_t> keys_;  // hashes of the keys of the objects around this place, the innermost object last
};

}  // namespace

void check_json(std::string_view text, const std::string& what) { Checker(text, what).check(); }

}  // namespace teracell::store
