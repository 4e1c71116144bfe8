// Are the caps to be trusted? A cap across a wide hole is a guess. The generalized winding number needs no cap: it is the
// solid angle of the surface as it is, holes and all, as seen from a point, and where more than half of the whole sphere is
// covered the point is rather inside than outside (A. Jacobson, L. Kavan, O. Sorkine-Hornung, "Robust Inside-Outside
// Segmentation using Generalized Winding Numbers", 2013). So it is held against the cells at some points. It decides no
// cell: it rounds, and in front of a hole it knows no better than the caps do. Where both say the same, that is worth
// something; where they don't, somebody should look.
//
// Facets come one by one, in any way that has them: from memory, or from a file while it is read again for the bins. The
// answer depends on their order (it rounds), but not on how points are shared out to threads. Only for bodies that go by
// winding number throughout: facets oriented both ways make the sum of their solid angles mean nothing.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "mesher/surface/facet.hpp"
#include "store/grid.hpp"

namespace teracell {

// A point that was tried.
struct TrustPoint {
  Vec3 at;
  double winding;  // of the surface as it is
  bool inside;     // the surface as closed: what the cell is
};

// What was found at all of them. Positions are as the grid sees them.
struct Trust {
  uint64_t points = 0, disagree = 0;
  double clearest = -1;  // of the points that disagree, how far the winding number is from 1/2 where it is furthest
  Vec3 at{};             // there; the least of them where equal
  Vec3 lo{}, hi{};       // the box of those that disagree

  void add(const Trust& other);     // of other points
  bool worth_a_warning() const { return disagree * 500 > points; }  // more than 0.2 %
};

// How many points a body of so many facets is tried at, one of so many bodies: at most 4096, no more than 2^27 pairs of a
// point and a facet, and no more than 2^21 points for all bodies, where a scene has very many.
uint64_t trust_points(uint64_t facets, uint64_t bodies);

// The sample points of `count` cells that hold points drawn, the same on every run, over the box lo .. hi of a body, as
// far as the grid reaches. None where the box lies outside.
std::vector<Vec3> draw_trust_points(const Vec3& lo, const Vec3& hi, const Grid& grid, uint64_t count);

// Tries some points. Not thread-safe; threads share out the points, each gives its own the same facets in the same order,
// and the results are added.
class TrustCheck {
 public:
  // `lo`, `hi`: the box of the body, that the coordinates are scaled to.
  TrustCheck(std::span<const Vec3> points, const Vec3& lo, const Vec3& hi);
  void add_surface(const Facet& facet);               // as the grid sees it
  void add_closing(const Facet& facet) { cross(facet); }  // a stitch, a cap
  std::vector<TrustPoint> points();
  Trust result();

 private:
  static constexpr size_t kBlock = 8, kBatch = 64;
  // Points as structures of arrays, scaled, with the product of the facets' complex numbers (trust.cpp).
  struct Block {
    double x[kBlock], y[kBlock], z[kBlock], re[kBlock], im[kBlock], turns[kBlock];
  };
  // A facet, scaled: its vertices, its normal (twice the area long), and halves of its edges' squared lengths.
  struct Scaled {
    double a[3], b[3], c[3], n[3], ab, bc, ca;
  };
  static void turn(Block& points, std::span<const Scaled> facets);
  void flush();
  void cross(const Facet& facet);

  std::vector<Vec3> points_;   // ascending by the row of their rays
  std::vector<int64_t> winding_;  // of the closed surface around them, exactly
  std::vector<Block> blocks_;  // of points_, in order
  std::vector<Scaled> batch_;
  Vec3 origin_;
  double scale_;
};

// All of them, shared out to threads. `feed` gives a check every facet; it is called once a thread, from several at a time; for few points there is one.
Trust try_points(std::span<const Vec3> points, const Vec3& lo, const Vec3& hi, int threads, const std::function<void(TrustCheck&)>& feed);

// For the user; empty when it is not worth one.
std::string trust_warning(const Trust& trust, const std::string& body);

}  // namespace teracell
