#include "mesher/scene/node.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mesher/scene/names.hpp"
#include "store/base/error.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {
namespace {

using Json = nlohmann::json;

// Builds the tree as the text is read, and throws where a key is given twice.
class TreeBuilder final : public nlohmann::json_sax<Json> {
 public:
  TreeBuilder(const std::string& text, SceneText& out) : text_(text), out_(out) {}

  bool key(string_t& name) override {
    Level& object = levels_.back();
    const auto [member, fresh] = object.value->get_ref<Json::object_t&>().try_emplace(std::move(name));
    if (!fresh) throw UsageError(fmt::format("{}: this key is given twice: keep one of them", child_path(path(levels_.size() - 1), member->first)));
    object.member = &*member;
    if (levels_.size() == 2 && levels_[0].member && levels_[0].member->first == "materials") out_.material_order.push_back(member->first);
    return true;
  }
  bool start_object(size_t) override { return open(Json::object()); }
  bool start_array(size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(number_integer_t value) override { return put(value); }
  bool number_unsigned(number_unsigned_t value) override { return put(value); }
  bool number_float(number_float_t value, const string_t&) override { return put(value); }
  bool string(string_t& value) override { return put(std::move(value)); }
  bool binary(binary_t&) override { return false; }  // text has none

  bool parse_error(size_t position, const std::string&, const Json::exception& e) override {
    // The parser's message is "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error ...";
    // its own line and column give way to ours.
    std::string what = e.what();
    what.erase(0, what.find("] ") + 2);
    if (what.rfind("parse error at ", 0) == 0) what.erase(0, what.find(": ") + 2);
    const std::string_view read = std::string_view(text_).substr(0, std::max(position, size_t{1}) - 1);
    const auto line = std::count(read.begin(), read.end(), '\n') + 1;
    const size_t line_start = read.rfind('\n') + 1;  // npos + 1 is 0
    throw UsageError(fmt::format("line {}, column {}: {}", line, read.size() - line_start + 1, printable(what)));
  }

 private:
  // What is being filled: only the innermost grows, so the others stay where they are.
  struct Level {
    Json* value;
    Json::object_t::value_type* member = nullptr;  // of an object: the one read last
  };

  Json& add(Json value) {
    if (levels_.empty()) return out_.root = std::move(value);
    const Level& parent = levels_.back();
    if (parent.value->is_array()) return parent.value->get_ref<Json::array_t&>().emplace_back(std::move(value));
    return parent.member->second = std::move(value);
  }
  bool put(Json value) {
    add(std::move(value));
    return true;
  }
  bool open(Json value) {
    levels_.push_back({&add(std::move(value))});
    return true;
  }
  bool close() {
    levels_.pop_back();
    return true;
  }
  std::string path(size_t depth) const {
    std::string where;
    for (const Level& level : std::span(levels_).first(depth))
      where = level.value->is_array() ? fmt::format("{}[{}]", where, level.value->size() - 1) : child_path(where, level.member->first);
    return where;
  }

  const std::string& text_;
  SceneText& out_;
  std::vector<Level> levels_;
};

bool plain(const std::string& key) {
  return !key.empty() && std::all_of(key.begin(), key.end(), [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-' || c == '*'; });
}

std::string quoted(const std::string& key) { return printable(Json(key).dump()); }

}  // namespace

SceneText read_json(const std::string& text) {
  SceneText out;
  TreeBuilder builder(text, out);
  Json::sax_parse(text, &builder);
  return out;
}

std::string child_path(const std::string& parent, const std::string& key) {
  if (!plain(key)) return fmt::format("{}[{}]", parent, quoted(key));
  return parent.empty() ? key : parent + '.' + key;
}

std::string Node::path() const {
  if (!parent_) return "";
  return parent_->is_array() ? fmt::format("{}[{}]", parent_->path(), index_) : child_path(parent_->path(), *key_);
}

std::string Node::where() const { return parent_ ? path() : "the scene"; }

void Node::fail(const std::string& expected) const { throw UsageError(fmt::format("{}: expected {}, found {}", where(), expected, found())); }

std::string Node::found() const {
  if (value_->is_object()) return "an object";
  if (value_->is_array()) return fmt::format("an array of {}", value_->size());
  constexpr size_t kLongest = 60;
  const std::string text = printable(value_->dump());
  return text.size() > kLongest ? fmt::format("{}...", first_bytes(text, kLongest)) : text;
}

void Node::check_keys(std::initializer_list<std::string_view> known) const {
  if (!value_->is_object()) fail("an object");
  for (const auto& [key, value] : value_->get_ref<const Json::object_t&>()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    throw UsageError(fmt::format("{}: unknown key {}: the nearest known one is \"{}\" (known here: {})", where(), quoted(key), nearest(key, known),
                                 fmt::join(known, ", ")));
  }
}

std::optional<Node> Node::find(std::string_view key) const& {
  const auto it = value_->find(key);
  if (it == value_->end()) return std::nullopt;
  return Node(*it, *this, &it.key(), 0);
}

Node Node::require(std::string_view key) const& {
  const std::optional<Node> node = find(key);
  if (!node) throw UsageError(fmt::format("{}: the key \"{}\" is missing", where(), key));
  return *node;
}

std::vector<Node> Node::items() const& {
  if (!value_->is_array()) fail("an array");
  std::vector<Node> nodes;
  nodes.reserve(value_->size());
  for (const Json& item : *value_) nodes.push_back(Node(item, *this, nullptr, nodes.size()));
  return nodes;
}

std::vector<Node> Node::items(size_t count) const& {
  if (!value_->is_array() || value_->size() != count) fail(fmt::format("an array of {}", count));
  return items();
}

double Node::number() const {
  if (!value_->is_number()) fail("a number");
  return value_->get<double>() + 0.0;  // -0 is 0
}

double Node::positive() const {
  const double x = number();
  if (!(x > 0)) fail("a number above 0");
  return x;
}

bool Node::boolean() const {
  if (!value_->is_boolean()) fail("true or false");
  return value_->get<bool>();
}

int64_t Node::integer(int64_t lo, int64_t hi) const {
  const std::string expected = fmt::format("an integer from {} to {}", lo, hi);
  int64_t n = 0;
  if (value_->is_number_unsigned()) {
    if (value_->get<uint64_t>() > static_cast<uint64_t>(INT64_MAX)) fail(expected);
    n = value_->get<int64_t>();
  } else if (value_->is_number_integer()) {
    n = value_->get<int64_t>();
  } else if (value_->is_number_float()) {  // 1e3 and 1000.0 are integers too
    const double x = value_->get<double>();
    if (!(std::abs(x) <= 0x1p53) || x != std::trunc(x)) fail(expected);
    n = static_cast<int64_t>(x);
  } else {
    fail(expected);
  }
  if (n < lo || n > hi) fail(expected);
  return n;
}

const std::string& Node::text() const {
  if (!value_->is_string()) fail("a string");
  const auto& text = value_->get_ref<const std::string&>();
  if (text.empty()) fail("a string that is not empty");
  if (printable(text) != text) fail("a string without control characters");
  return text;
}

size_t Node::choice(std::span<const std::string_view> words) const {
  const auto it = value_->is_string() ? std::find(words.begin(), words.end(), value_->get_ref<const std::string&>()) : words.end();
  if (it == words.end()) {
    const std::string hint =
        value_->is_string() ? fmt::format(" (did you mean \"{}\"?)", nearest(value_->get_ref<const std::string&>(), {words.begin(), words.end()}))
                            : "";
    fail(fmt::format("one of {}{}", fmt::join(words, ", "), hint));
  }
  return static_cast<size_t>(it - words.begin());
}

Vec3 Node::vec3() const {
  const std::vector<Node> xyz = items(3);
  return {xyz[0].number(), xyz[1].number(), xyz[2].number()};
}

}  // namespace teracell::mesher
