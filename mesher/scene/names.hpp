// Names that scene files and bare meshes share: defaults for bodies and colours.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <unordered_map>

#include "store/grid/grid.hpp"

namespace teracell::mesher {

inline constexpr size_t kMaxMaterials = 65535;  // besides the background: a label names its material in 16 bits
inline constexpr int64_t kMaxPad = Axis::kMaxCells / 2;
inline constexpr const char* kBackgroundColor = "#00000000";

// "hull" for "meshes/hull.stl" and "meshes/hull.stl.gz".
std::string mesh_stem(const std::filesystem::path& mesh);

// Gives out distinct names: "hull", "hull-2", "hull-3".
class NameBook {
 public:
  bool take(const std::string& name) { return last_.try_emplace(name, 1).second; }  // false when the name is taken already
  std::string numbered(const std::string& stem);

 private:
  std::unordered_map<std::string, uint64_t> last_;  // of each name that is taken, the last number given to it as a stem
};

}  // namespace teracell::mesher
