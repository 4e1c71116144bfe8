// Names that scene files and bare meshes share: defaults for bodies and colours, and suggestions for misspelt words.
#pragma once
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "store/grid.hpp"

namespace teracell {

inline constexpr size_t kMaxMaterials = 65535;  // besides the background: a label names its material in 16 bits
inline constexpr int64_t kMaxPad = Axis::kMaxCells / 2;
inline constexpr const char* kBackgroundColor = "#00000000";

// The default colour of material `id` >= 1: seven colours that colour-blind readers can tell apart, then darker shades of them.
std::string palette_color(uint32_t id);

// "hull" for "meshes/hull.stl" and "meshes/hull.stl.gz".
std::string mesh_stem(const std::filesystem::path& mesh);

// The candidate with the smallest edit distance to `word` (V. Levenshtein, 1966); empty when there are no candidates.
std::string_view nearest(std::string_view word, const std::vector<std::string_view>& candidates);
// Whether `word` may be a misspelling of `other`: their edit distance is at most half of the longer length.
bool resembles(std::string_view word, std::string_view other);

// Gives out distinct names: "hull", "hull-2", "hull-3".
class NameBook {
 public:
  bool take(const std::string& name) { return taken_.insert(name).second; }  // false when the name is taken already
  std::string numbered(const std::string& stem);

 private:
  std::set<std::string> taken_;
  std::unordered_map<std::string, uint64_t> last_;
};

}  // namespace teracell
