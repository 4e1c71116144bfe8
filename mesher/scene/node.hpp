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

#include "store/grid/grid.hpp"

namespace teracell::mesher {

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

// Borrows the value, and the Node that it was found in, because its place is put into words only for an error. Every accessor
// throws UsageError when it finds something other than its name says.
class Node {
 public:
  explicit Node(const nlohmann::json& root) : value_(&root) {}

  std::string where() const;
  [[noreturn]] void fail(const std::string& expected) const;

  // Refuses anything but an object, and keys other than these.
  void check_keys(std::initializer_list<std::string_view> known) const;
  std::optional<Node> find(std::string_view key) const&;
  Node require(std::string_view key) const&;
  std::optional<Node> find(std::string_view key) const&& = delete;  // what is found may not outlive this Node
  Node require(std::string_view key) const&& = delete;

  bool is_object() const { return value_->is_object(); }
  bool is_array() const { return value_->is_array(); }
  std::vector<Node> items() const&;              // of an array
  std::vector<Node> items(size_t count) const&;  // of an array with exactly `count` elements
  std::vector<Node> items() const&& = delete;
  std::vector<Node> items(size_t count) const&& = delete;

  double number() const;
  double positive() const;
  int64_t integer(int64_t lo, int64_t hi) const;
  bool boolean() const;
  const std::string& text() const;  // not empty, without control characters
  size_t choice(std::span<const std::string_view> words) const;  // the index of the word
  size_t choice(std::initializer_list<std::string_view> words) const { return choice(std::span(words.begin(), words.size())); }
  Vec3 vec3() const;

 private:
  Node(const nlohmann::json& value, const Node& parent, const std::string* key, size_t index)
      : value_(&value), parent_(&parent), key_(key), index_(index) {}
  std::string path() const;
  std::string found() const;
  const nlohmann::json* value_;
  const Node* parent_ = nullptr;      // null for the root
  const std::string* key_ = nullptr;  // in an object
  size_t index_ = 0;                  // in an array
};

}  // namespace teracell::mesher
