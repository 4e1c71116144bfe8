// Where the facets of a body lie flat across an axis of the grid.
#pragma once
#include <array>
#include <unordered_map>
#include <vector>

#include "store/grid/grid.hpp"

namespace teracell::mesher {

// What flat facets have at a coordinate: their area, and that of those that face greater coordinates less that of the others, by the order of their
// vertices. A facet that is flat but for rounding has a third of it at each of its vertices.
struct FlatArea {
  double at, area, facing;
};

struct FlatFaces {
  std::array<std::vector<FlatArea>, 3> axis;  // in ascending order of `at`
  std::array<double, 3> least_missed;         // the least extent of a facet across the axis that was too large to be taken
  double volume = 0;                          // what the facets enclose; below 0 where they face inwards
};

// The facets of one body, one after another.
class FlatFaceSearch {
 public:
  // `slack`: the largest extent of a flat facet across each axis; below 0 for axes that are not asked for.
  explicit FlatFaceSearch(const Vec3& slack = {-1, -1, -1}) : slack_(slack) { least_missed_.fill(HUGE_VAL); }
  bool wanted() const { return slack_[0] >= 0 || slack_[1] >= 0 || slack_[2] >= 0; }
  void take(const std::array<Vec3, 3>& facet, double area);
  FlatFaces found() &&;

 private:
  struct Areas {
    double area = 0, facing = 0;
  };
  Vec3 slack_;
  std::array<std::unordered_map<double, Areas>, 3> areas_;
  std::array<double, 3> least_missed_;
  std::array<double, 3> first_{};  // a vertex of the body, from which volumes are measured
  bool began_ = false;
  double volume_ = 0;
};

// Areas whose coordinates follow each other within `slack` are one face, which stands at their median by area. Those below `least_area` are left out.
std::vector<FlatArea> grouped(const std::vector<FlatArea>& areas, double slack, double least_area);

}  // namespace teracell::mesher
