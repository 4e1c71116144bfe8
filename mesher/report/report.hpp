// What meshing found, for people and programs. report_json writes it and reads it back; REPORT.md documents its keys.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mesher/closing/closing.hpp"
#include "mesher/closing/surface_counts.hpp"

namespace teracell::mesher {

// An open end of a surface, as the grid sees it.
struct HoleReport {
  Vec3 at{};
  uint64_t edges = 0;
  double diameter = 0, width = 0, cap_area = 0;          // in the grid's units; what they measure: caps.hpp
  double diameter_cells = 0, width_cells = 0;            // in cells, where they are narrowest near `at`
  Vec3 lo{}, hi{};                                       // the box of its vertices
  double off_plane = 0, off_plane_cells = 0;             // as in caps.hpp, and in cells
  bool extruded = false;
};

// What lies between sample points along one axis, and so belongs to no cell (tally.hpp).
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

struct InputReport {
  std::string path, format, hash;
  uint64_t bytes = 0;
};

// The report in the file: only what inputs and options determine, so no times, memory or numbers of threads.
struct Report {
  std::vector<BodyReport> bodies;
  uint64_t bodies_left_out = 0;  // by a report that was read
  uint64_t crossings = 0;
  std::vector<std::string> warnings;
  std::vector<InputReport> inputs;  // one per body
  int axis = 2;                     // of the rays
  bool axis_asked_for = false;
  Vec3 crossings_expected{};                        // along each axis
  std::optional<std::vector<GapReport>> lost_gaps;  // when they were counted
  std::optional<OverlapsReport> overlaps;           // reports of earlier versions have none
};

}  // namespace teracell::mesher
