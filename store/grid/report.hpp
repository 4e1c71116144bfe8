// What the mesher found, for people and programs: the report in a grid's file. report_json writes it and reads it back;
// mesher/REPORT.md documents its keys.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "store/grid/grid.hpp"

namespace teracell::inline store {

// How the inside of a shell is decided. kEvenodd and kDistinct count crossings (kDistinct only those of distinct facets),
// kNonzero adds up windings, and kAuto is not decided yet.
enum class Fill { kAuto, kNonzero, kEvenodd, kDistinct };
inline constexpr std::array<std::string_view, 4> kFillNames = {"auto", "nonzero", "evenodd", "distinct"};  // in the order of Fill
constexpr std::string_view fill_name(Fill fill) { return kFillNames[static_cast<size_t>(fill)]; }

// A fill rule and the shells of a body that have it.
struct FillChoice {
  Fill rule;
  std::optional<uint64_t> shells;  // absent: all shells
  std::string why;                 // a text for people
};

struct SurfaceCounts {
  uint64_t degenerate = 0, duplicates = 0, opposite = 0, shells = 0;  // mesher/closing/surface_counts.hpp says of what
};

// The curves along which stitches joined boundary edges.
struct Seams {
  uint64_t number = 0;
  double length = 0;       // of all
  double widest_gap = 0;   // the largest distance between what was joined
  uint64_t collapsed = 0;  // open edges whose two ends were joined to one point
};

// A curve along which facets of a shell face the opposite way from their neighbours: its edges run the same way in both.
struct Flip {
  Vec3 at;  // the first vertex of the first of its edges, as the grid sees it
  uint64_t edges;
};

// An open end of a surface, as the grid sees it.
struct HoleReport {
  Vec3 at{};
  uint64_t edges = 0;
  double diameter = 0, cap_area = 0;  // in the grid's units; what all of these measure: mesher/closing/caps.hpp
  double diameter_cells = 0;          // in cells, where they are narrowest near `at`
  bool extruded = false;
  // Reports of earlier versions lack these.
  std::optional<double> width, off_plane;
  double width_cells = 0, off_plane_cells = 0;
  std::optional<std::array<double, 6>> box;  // of its vertices: the lower corner, the upper corner
};

// What lies between sample points along one axis, and so belongs to no cell (mesher/thin/tally.hpp).
struct LostReport {
  uint64_t number = 0;
  uint32_t widest_65536ths = 0;  // of the distance between the two sample points
  double widest = 0;             // as a length
  std::optional<Vec3> at;
};

struct BodyReport {
  std::string name;
  bool sheet = false;
  uint64_t facets = 0;
  SurfaceCounts counts;
  std::vector<FillChoice> fill;
  double stitch = 0;  // this and the seams: of solids alone
  Seams seams;
  std::vector<HoleReport> holes;  // the largest first
  std::vector<Flip> flips;
  uint64_t holes_left_out = 0, flips_left_out = 0;  // of the lists, for want of room
  unsigned __int128 cells = 0;    // that it owns
  unsigned __int128 covered = 0;  // that lie in it and a stronger body owns
  // Pairs of crossings between the same two sample points along the rays.
  int lost_axis = 2;
  uint64_t lost_pairs = 0;
  std::optional<Vec3> first_lost_pair;
  std::optional<std::array<LostReport, 3>> lost;  // stretches, when they were counted
};

struct GapReport {
  std::string material;
  int axis = 2;
  LostReport lost;
};

// Cells inside two bodies, whoever owns them.
struct OverlapReport {
  std::array<std::string, 2> bodies;
  unsigned __int128 cells = 0;
  std::optional<std::string> owner;  // of all these cells, when that is one of the two
  Box box;                           // in cells
  Vec3 at{};                         // the sample point of one of them
};

struct OverlapsReport {
  uint64_t pairs = 0;                // of bodies that overlap
  std::vector<OverlapReport> list;   // those with the most cells, the most first
};

// What the CAD kernel made of the parts of a STEP file that a body takes, in the grid's units.
struct CadPartReport {
  std::string path;  // of the first of its instances
  uint64_t instances = 1, faces = 0, faces_without_facets = 0;
  bool closed = false;  // its facets are
  double facet_volume = 0;
  std::optional<double> kernel_volume, sender_volume;
};
struct CadReport {
  std::string kernel;     // "OpenCASCADE 7.6.3"
  std::string key, hash;  // of file, kernel and options; of the facets
  double deflection = 0, angle = 0;
  std::vector<CadPartReport> parts;
  uint64_t parts_left_out = 0;  // for want of room
  // Of the body's own cells, or by its shares of mixed cells where it is alone with its label; of grids without planes of their own.
  std::optional<double> grid_volume;
  bool by_shares = false;
};

// A place where planes that were made break a rule of theirs, because two rules collide there.
struct PlaneBreach {
  enum class Rule { kFinest, kWidth, kGrowth };
  int axis;
  Rule rule;
  double at;               // the lower plane of the cell; of growth, the plane between two cells
  double found, expected;  // a width, or a ratio of two widths
};
inline constexpr std::array<std::string_view, 3> kPlaneRuleNames = {"finest", "width", "growth"};  // in the order of PlaneBreach::Rule

// What is to be said of planes that were made.
struct PlanesReport {
  std::vector<PlaneBreach> breaches;
  uint64_t left_out = 0;              // of the list, for want of room
  std::vector<std::string> warnings;  // those of the report have them, too
};

struct InputReport {
  std::string path, format, hash;
  uint64_t bytes = 0;
  std::string unit;   // that the file states; empty when it states none
  double factor = 1;  // by which its coordinates were multiplied
  std::optional<CadReport> cad;
};

// The report in the file: only what inputs and options determine, so no times, memory or numbers of threads.
struct Report {
  std::vector<BodyReport> bodies;
  uint64_t bodies_left_out = 0;  // by a report that was read
  std::vector<std::string> sheet_materials;  // of a report that was read: those that sheets alone have, in order
  uint64_t crossings = 0;
  std::vector<std::string> warnings;
  std::vector<InputReport> inputs;  // one per body
  int axis = 2;                     // of the rays
  bool axis_asked_for = false;
  Vec3 crossings_expected{};                        // along each axis
  std::optional<std::vector<GapReport>> lost_gaps;  // when they were counted
  std::optional<PlanesReport> planes;               // when they were made
  std::optional<OverlapsReport> overlaps;           // reports of earlier versions have none
};

}  // namespace teracell::inline store
