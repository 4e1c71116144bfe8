// Small words shared by the scene file and bare meshes: names, their numbers, their colours.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "store/grid.hpp"

namespace teracell {

inline constexpr size_t kMaxMaterials = 65535;  // without the background: labels name materials in 16 bits
inline constexpr int64_t kMaxPad = Axis::kMaxCells / 2;
inline constexpr const char* kBackgroundColor = "#00000000";

// A colour for material `id` >= 1 that has none: seven that the colour-blind tell apart, then darker shades of them.
std::string palette_color(uint32_t id);

// "hull" for "meshes/hull.stl" and "meshes/hull.stl.gz".
std::string mesh_stem(const std::filesystem::path& mesh);

// The text with control characters as '?' and what is not UTF-8 as U+FFFD: file names and files from elsewhere may hold
// anything, but a terminal obeys the one and JSON can't carry the other.
std::string printable(std::string_view text);

// The candidate with the smallest edit distance (V. Levenshtein, 1966); empty when there is none.
std::string_view nearest(std::string_view word, const std::vector<std::string_view>& candidates);
// Whether the word may be a slip for the other: at most half of it must be changed.
bool resembles(std::string_view word, std::string_view other);

// Gives out names that differ: "hull", "hull-2", "hull-3".
class NameBook {
 public:
  bool take(const std::string& name) { return last_.try_emplace(name, 1).second; }  // false: it was taken
  std::string numbered(const std::string& stem);

 private:
  std::unordered_map<std::string, uint64_t> last_;  // of each name that is taken, the last number given to it as a stem
};

}  // namespace teracell
