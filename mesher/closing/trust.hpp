// Can the caps be trusted? A cap across a wide hole is a guess. The generalized winding number needs no caps: it is the
// solid angle that the surface, with its holes, covers as seen from a point. Where it covers more than half of the sphere the
// point is more likely inside than outside (A. Jacobson, L. Kavan, O. Sorkine-Hornung, "Robust Inside-Outside Segmentation
// using Generalized Winding Numbers", 2013). So the cells are compared with it at some points. It decides no cell, because it
// is subject to rounding, and in front of a hole it knows no better than the caps do. Where both agree, the caps are more
// credible; where they disagree, the user should look.
//
// Facets come one by one from any source: from memory, or from a file while it is read again for the bins. Because of
// rounding the answer depends on their order, but not on how points are distributed to threads. This is only for bodies whose
// shells all go by winding number: if facets are oriented both ways, the sum of their solid angles means nothing.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "mesher/surface/facet.hpp"
#include "store/grid/grid.hpp"

namespace teracell::mesher {

// A point that was tried.
struct TrustPoint {
  Vec3 at;
  double winding;  // of the surface with its holes
  bool inside;     // inside the closed surface, as the cell is
};

// The result for all points. Positions are as the grid sees them.
struct Trust {
  uint64_t points = 0, disagree = 0;
  double clearest = -1;  // the largest distance of the winding number from 1/2 among points that disagree
  Vec3 at{};             // the point with that distance; of several the lexicographically least
  Vec3 lo{}, hi{};       // the box of those that disagree

  void add(const Trust& other);  // of other points
  bool worth_a_warning() const { return disagree * 500 > points; }  // more than 0.2 %
};

// The number of points for a body of so many facets in a scene of so many bodies: at most 4096, at most 2^27 pairs of a point
// and a facet, and at most 2^21 points for all bodies together.
uint64_t trust_points(uint64_t facets, uint64_t bodies);

// Draws `count` points from the part of a body's box lo .. hi that lies in the grid, the same ones on every run, and returns
// the sample points of their cells. Empty when the box lies outside the grid.
std::vector<Vec3> draw_trust_points(const Vec3& lo, const Vec3& hi, const Grid& grid, uint64_t count);

// Tries some points. Not thread-safe: each thread has a check of its own for a part of the points, gives it all facets in
// the same order, and the results are added.
class TrustCheck {
 public:
  // `lo`, `hi`: the box of the body. Coordinates are scaled to it.
  TrustCheck(std::span<const Vec3> points, const Vec3& lo, const Vec3& hi);
  void add_surface(const Facet& facet);               // as the grid sees it
  void add_closing(const Facet& facet) { cross(facet); }  // a stitch, a cap
  std::vector<TrustPoint> points();
  Trust result();

 private:
  static constexpr size_t kBlock = 8, kBatch = 64;
  // Scaled points, with the products of the facets' complex numbers (trust.cpp), coordinate by coordinate for SIMD.
  struct Block {
    double x[kBlock], y[kBlock], z[kBlock], re[kBlock], im[kBlock], turns[kBlock];
  };
  // A scaled facet: its vertices, its normal (whose length is twice the area), and half the squared lengths of its edges.
  struct Scaled {
    double a[3], b[3], c[3], n[3], ab, bc, ca;
  };
  static void turn(Block& points, std::span<const Scaled> facets);
  void flush();
  void cross(const Facet& facet);

  std::vector<Vec3> points_;   // in ascending order of their rays' rows
  std::vector<int64_t> winding_;  // the exact winding number of the closed surface around each point
  std::vector<Block> blocks_;  // of points_, in order
  std::vector<Scaled> batch_;
  Vec3 origin_;
  double scale_;
};

// Tries all points, distributed to threads. `feed` gives a check every facet. It is called once per thread, by several threads
// at the same time; for few points there is one thread.
Trust try_points(std::span<const Vec3> points, const Vec3& lo, const Vec3& hi, int threads, const std::function<void(TrustCheck&)>& feed);

// The warning for the user; empty when worth_a_warning() is false.
std::string trust_warning(const Trust& trust, const std::string& body);

}  // namespace teracell::mesher
