// The names of parts in the tree of an assembly: "/as1/l-bracket assembly/nut#2".
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace teracell::mesher {

inline constexpr const char* kUnnamedPart = "mesh 1";  // the part of a file without a tree that has no name

// In a path / * ? [ \ of names are preceded by \, so that a path is also a glob that matches itself.
std::string escaped(std::string_view name);
// The path of a part below that of its parent; the root's is empty.
std::string path_below(std::string_view parent, std::string_view name);
// The names along a path, as they were before they were escaped.
std::vector<std::string> names_of(std::string_view path);

// Siblings by names that differ: of those with one name the later get #2, #3 and so on, but no name that another sibling has.
std::vector<std::string> told_apart(std::vector<std::string> names);
// The name without such a number: "nut" for "nut#2".
std::string_view without_number(std::string_view name);

// Which parts of a file a body takes.
class PartGlob {
 public:
  explicit PartGlob(std::string glob);
  const std::string& text() const { return glob_; }
  bool takes_all() const { return glob_.empty(); }
  // No wildcard: it is a path, and matches that one alone.
  bool is_path() const { return is_path_; }
  // With a leading / the glob matches the whole path, else the last name or the path. `*` matches / too.
  bool matches(std::string_view path) const;
  // A part of a file without a tree, such as a group of an OBJ file.
  bool matches_name(const std::string& name) const;

 private:
  std::string glob_, coded_;  // see coded() in the source
  bool is_path_;
};

}  // namespace teracell::mesher
