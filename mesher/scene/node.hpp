// A value of the scene file that knows where it stands, so that every error says where, expected, found.
#pragma once
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "store/grid.hpp"

namespace teracell {

// A JSON text, checked for what a document tree no longer shows. Throws UsageError with line and column for a syntax
// error, and for a key given twice in one object (JSON readers silently drop all but one).
struct SceneText {
  nlohmann::json root;
  std::vector<std::string> material_order;  // the keys of "materials" as written, which numbers them
};
SceneText read_json(const std::string& text);

// "bodies[2].scale", "materials[\"odd name\"].color".
std::string child_path(const std::string& parent, const std::string& key);

// Borrows the value; a reader that finds something else throws UsageError.
class Node {
 public:
  Node(const nlohmann::json& value, std::string where) : value_(&value), where_(std::move(where)) {}

  const std::string& where() const { return where_; }
  [[noreturn]] void fail(const std::string& expected) const;

  // An object with these keys only.
  void check_keys(std::initializer_list<std::string_view> known) const;
  std::optional<Node> find(const std::string& key) const;
  Node require(const std::string& key) const;

  bool is_object() const { return value_->is_object(); }
  bool is_array() const { return value_->is_array(); }
  std::vector<Node> items() const;              // of an array
  std::vector<Node> items(size_t count) const;  // of an array of that many

  double number() const;
  double positive() const;
  int64_t integer(int64_t lo, int64_t hi) const;
  const std::string& text() const;  // not empty, without control characters
  size_t choice(std::initializer_list<std::string_view> words) const;
  Vec3 vec3() const;

 private:
  std::string found() const;
  const nlohmann::json* value_;
  std::string where_;
};

}  // namespace teracell
