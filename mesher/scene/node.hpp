// A value of the scene file together with its path, so that every error can say where it is, what was expected and what was found.
#pragma once
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "store/grid.hpp"

namespace teracell {

// A JSON document, and the order of its materials, which the document tree does not keep.
struct SceneText {
  nlohmann::json root;
  std::vector<std::string> material_order;  // the keys of "materials" in the order of the text, which numbers them
};
// Throws UsageError for a syntax error, with line and column, and for a key given twice in one object: JSON libraries
// silently keep only one of them.
SceneText read_json(const std::string& text);

// "bodies[2].scale", "materials[\"odd name\"].color".
std::string child_path(const std::string& parent, const std::string& key);

// Borrows the value. Every accessor throws UsageError when it finds something other than its name says.
class Node {
 public:
  Node(const nlohmann::json& value, std::string where) : value_(&value), where_(std::move(where)) {}

  const std::string& where() const { return where_; }
  [[noreturn]] void fail(const std::string& expected) const;

  // Refuses anything but an object, and keys other than these.
  void check_keys(std::initializer_list<std::string_view> known) const;
  std::optional<Node> find(const std::string& key) const;
  Node require(const std::string& key) const;

  bool is_object() const { return value_->is_object(); }
  bool is_array() const { return value_->is_array(); }
  std::vector<Node> items() const;              // of an array
  std::vector<Node> items(size_t count) const;  // of an array with exactly `count` elements

  double number() const;
  double positive() const;
  int64_t integer(int64_t lo, int64_t hi) const;
  const std::string& text() const;  // not empty, without control characters
  size_t choice(std::span<const std::string_view> words) const;  // the index of the word
  size_t choice(std::initializer_list<std::string_view> words) const { return choice(std::span(words.begin(), words.size())); }
  Vec3 vec3() const;

 private:
  std::string found() const;
  const nlohmann::json* value_;
  std::string where_;
};

}  // namespace teracell
