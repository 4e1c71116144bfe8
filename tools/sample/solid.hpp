// Closed surfaces for the built-in scenes, all made by one operation: a loft through sections.
#pragma once
#include <array>
#include <filesystem>
#include <vector>

#include "store/grid/grid.hpp"

namespace teracell::sample {

// A plane outline as a ladder of two chains with as many points each: along `low`, then back along `high`. Rung by rung
// it splits into quads, so that even a stepped, far from convex outline has caps without a triangulator.
struct Section {
  std::vector<Vec3> low, high;
};

// One or more closed shells, outward oriented. They may overlap: the body is their union (nonzero rule).
class Solid {
 public:
  using Corner = std::array<float, 3>;

  // A shell through the sections: capped at both ends, or closed into a ring. REQUIRES: two sections or more (three for
  // a ring), equally many rungs in each, every outline counter-clockwise seen from where the loft is going.
  void loft(const std::vector<Section>& sections, bool ring = false);

  void box(const Vec3& lo, const Vec3& hi);
  // A round bar between two points that may taper; its section is a regular octagon's.
  void bar(const Vec3& from, const Vec3& to, double radius_from, double radius_to);
  // A cylinder along x with hemispheres on its ends; `half` is half the cylinder's length.
  void capsule(const Vec3& centre, double half, double radius);

  const std::vector<std::array<Corner, 3>>& facets() const { return facets_; }
  // Binary STL, little endian. The file appears under its name when it is complete.
  void write_stl(const std::filesystem::path& path) const;

 private:
  void quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
  std::vector<std::array<Corner, 3>> facets_;
};

// All of `bytes` under its name, or nothing and an IoError.
void write_whole(const std::filesystem::path& path, const std::string& bytes);

}  // namespace teracell::sample
