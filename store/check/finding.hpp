// What is found wrong, or worth knowing, about a grid.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "store/grid/grid.hpp"

namespace teracell::inline store {

using CellCount = unsigned __int128;

// The kinds, in the order in which they are listed, and their names.
enum class FindingKind { empty, winding, cap, seam, overlap, lost_stretch, lost_gap, thin, narrow, island, enclosed, cut };
inline constexpr const char* kFindingKinds[] = {"empty",    "winding", "cap",    "seam",   "overlap",  "lost_stretch",
                                                "lost_gap", "thin",    "narrow", "island", "enclosed", "cut"};
inline constexpr size_t kFindingKindCount = std::size(kFindingKinds);

enum class FindingLevel { error, warning, note };
inline constexpr const char* kFindingLevels[] = {"error", "warning", "note"};

struct Finding {
  FindingKind kind{};
  FindingLevel level{};
  std::vector<std::string> bodies;  // or materials, where the file does not keep bodies apart
  CellCount cells = 0;
  std::optional<Vec3> at;   // a coordinate
  std::optional<Box> box;   // of cells
  std::string text;         // a sentence
};

// The most findings of a kind that are listed.
inline constexpr size_t kMostFindings = 1000;

struct KindTotal {
  uint64_t findings = 0;
  CellCount cells = 0;
};

// How thick the walls of a body are.
struct WallReport {
  std::string body;
  std::optional<double> thinnest;        // cells; nothing where all are 8 or more
  std::optional<Vec3> at;                // a cell of that thickness
  std::array<CellCount, 8> histogram{};  // cells of thickness 1, 2, .. 7 (by the whole part), and 8 or more
};

struct Findings {
  std::string hash, cells_hash;  // of the grid (store/read/reader.hpp)
  std::vector<Finding> list;
  std::array<KindTotal, kFindingKindCount> totals{};
  std::vector<WallReport> walls;
  std::vector<std::string> not_looked_at;  // sentences: what was not, and why
};

}  // namespace teracell::store
