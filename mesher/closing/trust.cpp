// The solid angle of a facet (a, b, c) as seen from the origin is twice the argument of the complex number
//
//     |a| |b| |c| + (a . b) |c| + (b . c) |a| + (c . a) |b|  +  i a . (b x c)
//
// (A. Van Oosterom, J. Strackee, "The Solid Angle of a Plane Triangle", 1983). Multiplying complex numbers adds their
// arguments. So each point takes one multiplication per facet, a count of how often the product passes the negative real
// axis, and one atan2 at the end. With n = (b - a) x (c - a) the imaginary part is a . n, and 2 a . b = |a|^2 + |b|^2 - |a - b|^2.
//
// 2^27 pairs of a point and a facet take 1.2 s on one thread (SSE2, 9 ns per pair, half of it for the three square
// roots). The exact crossings of 32,768 facets at 4096 points take 0.01 s.
#include "mesher/closing/trust.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <fmt/format.h>

#include "mesher/engines/ray.hpp"
#include "store/base/in_order.hpp"
#include "store/grid/number_text.hpp"

namespace teracell::mesher {
namespace {

constexpr RayFrame kFrame = RayFrame::along(2);  // of the rays that decide whether a point is inside; every axis gives the same answer

// A sample point on the surface is decided as if it were shifted by (e, e^2, e^3). The winding number jumps at the surface, so
// there the shift is a number: this fraction of the longest side of the body's box.
constexpr Vec3 kShift = {0x1p-20, 0x1p-28, 0x1p-36};

}  // namespace

void Trust::add(const Trust& other) {
  if (other.disagree > 0) {
    for (int d = 0; d < 3; ++d) {
      lo[d] = disagree > 0 ? std::min(lo[d], other.lo[d]) : other.lo[d];
      hi[d] = disagree > 0 ? std::max(hi[d], other.hi[d]) : other.hi[d];
    }
    if (other.clearest > clearest || (other.clearest == clearest && other.at < at)) {
      clearest = other.clearest;
      at = other.at;
    }
  }
  points += other.points;
  disagree += other.disagree;
}

uint64_t trust_points(uint64_t facets, uint64_t bodies) {
  return std::min({uint64_t{4096}, (uint64_t{1} << 27) / std::max<uint64_t>(facets, 1), (uint64_t{1} << 21) / std::max<uint64_t>(bodies, 1)});
}

std::vector<Vec3> draw_trust_points(const Vec3& lo, const Vec3& hi, const Grid& grid, uint64_t count) {
  std::array<double, 3> from, to;
  for (int d = 0; d < 3; ++d) {
    from[d] = std::max(lo[d], grid.axis[d].min());
    to[d] = std::min(hi[d], grid.axis[d].max());
    if (!(from[d] <= to[d])) return {};
  }
  std::mt19937_64 random(1);
  std::vector<Vec3> points(count);
  for (Vec3& p : points)
    for (int d = 0; d < 3; ++d) {
      const double share = static_cast<double>(random() >> 11) * 0x1p-53;  // the distributions of the standard library differ between platforms
      const double x = std::clamp(from[d] + share * (to[d] - from[d]), from[d], to[d]);
      p[d] = grid.axis[d].centre(grid.axis[d].cell_at(x));
    }
  return points;
}

TrustCheck::TrustCheck(std::span<const Vec3> points, const Vec3& lo, const Vec3& hi)
    : points_(points.begin(), points.end()), winding_(points.size()), origin_(lo) {
  std::ranges::sort(points_, {}, [](const Vec3& p) { return p[kFrame.v]; });
  const double side = std::max({hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]});
  scale_ = side > 0 ? 1 / side : 1;
  blocks_.resize((points_.size() + kBlock - 1) / kBlock);
  for (size_t i = 0; i < blocks_.size() * kBlock; ++i) {
    const Vec3& p = points_[std::min(i, points_.size() - 1)];
    Block& block = blocks_[i / kBlock];
    const size_t k = i % kBlock;
    block.x[k] = (p[0] - origin_[0]) * scale_ + kShift[0];
    block.y[k] = (p[1] - origin_[1]) * scale_ + kShift[1];
    block.z[k] = (p[2] - origin_[2]) * scale_ + kShift[2];
    block.re[k] = 1;
    block.im[k] = block.turns[k] = 0;
  }
  batch_.reserve(kBatch);
}

void TrustCheck::add_surface(const Facet& facet) {
  Scaled s;
  for (int d = 0; d < 3; ++d) {
    s.a[d] = (facet.vertex[0][d] - origin_[d]) * scale_;
    s.b[d] = (facet.vertex[1][d] - origin_[d]) * scale_;
    s.c[d] = (facet.vertex[2][d] - origin_[d]) * scale_;
  }
  double ab[3], ac[3];
  s.ab = s.bc = s.ca = 0;
  for (int d = 0; d < 3; ++d) {
    ab[d] = s.b[d] - s.a[d];
    ac[d] = s.c[d] - s.a[d];
    s.ab += ab[d] * ab[d] / 2;
    s.ca += ac[d] * ac[d] / 2;
    s.bc += (s.c[d] - s.b[d]) * (s.c[d] - s.b[d]) / 2;
  }
  for (int d = 0; d < 3; ++d) s.n[d] = ab[(d + 1) % 3] * ac[(d + 2) % 3] - ab[(d + 2) % 3] * ac[(d + 1) % 3];
  batch_.push_back(s);
  if (batch_.size() == kBatch) flush();
  cross(facet);
}

void TrustCheck::flush() {
  for (Block& block : blocks_) turn(block, batch_);
  batch_.clear();
}

void TrustCheck::turn(Block& p, std::span<const Scaled> facets) {
  Block q = p;  // a local copy: the compiler sees that nothing else points to it
  for (size_t f = 0; f < facets.size(); ++f) {
    const Scaled s = facets[f];
    for (size_t i = 0; i < kBlock; ++i) {
      const double ax = s.a[0] - q.x[i], ay = s.a[1] - q.y[i], az = s.a[2] - q.z[i];
      const double bx = s.b[0] - q.x[i], by = s.b[1] - q.y[i], bz = s.b[2] - q.z[i];
      const double cx = s.c[0] - q.x[i], cy = s.c[1] - q.y[i], cz = s.c[2] - q.z[i];
      const double aa = ax * ax + ay * ay + az * az, bb = bx * bx + by * by + bz * bz, cc = cx * cx + cy * cy + cz * cz;
      const double a = std::sqrt(aa), b = std::sqrt(bb), c = std::sqrt(cc);
      // On an edge the number is 0 and would make the whole product 0. A real part too small to matter prevents that.
      const double re = a * b * c + (0.5 * (aa + bb) - s.ab) * c + (0.5 * (bb + cc) - s.bc) * a + (0.5 * (cc + aa) - s.ca) * b + 1e-40;
      const double im = ax * s.n[0] + ay * s.n[1] + az * s.n[2];
      const double before = q.im[i], product = q.re[i] * im + before * re;
      q.re[i] = q.re[i] * re - before * im;
      q.im[i] = product;
      const double wraps = before < 0 ? (product < 0 ? 0.0 : -1.0) : (product < 0 ? 1.0 : 0.0);
      q.turns[i] += (before < 0) == (im < 0) ? wraps : 0.0;
    }
    if (f % 4 == 3 || f + 1 == facets.size())  // the product of four numbers of at least 1e-40 does not underflow
      for (size_t i = 0; i < kBlock; ++i) {
        const double size = 1 / (std::abs(q.re[i]) + std::abs(q.im[i]));
        q.re[i] *= size;
        q.im[i] *= size;
      }
  }
  p = q;
}

void TrustCheck::cross(const Facet& facet) {
  const auto& [a, b, c] = facet.vertex;
  const auto least = [&](int d) { return std::min({a[d], b[d], c[d]}); };
  const auto most = [&](int d) { return std::max({a[d], b[d], c[d]}); };
  const auto row = [](const Vec3& p) { return p[kFrame.v]; };
  const double lo_u = least(kFrame.u), hi_u = most(kFrame.u), hi_v = most(kFrame.v), lo_w = least(kFrame.w);
  const auto first = std::ranges::lower_bound(points_, least(kFrame.v), {}, row);
  for (auto p = first; p != points_.end() && row(*p) <= hi_v; ++p) {
    if ((*p)[kFrame.u] < lo_u || (*p)[kFrame.u] > hi_u || (*p)[kFrame.w] < lo_w) continue;
    const int turn = turn_around_ray(facet, kFrame, (*p)[kFrame.u], (*p)[kFrame.v]);
    if (turn != 0 && is_above(facet, kFrame.w, *p)) winding_[p - points_.begin()] += turn;
  }
}

std::vector<TrustPoint> TrustCheck::points() {
  flush();
  std::vector<TrustPoint> out;
  for (size_t i = 0; i < points_.size(); ++i) {
    const Block& block = blocks_[i / kBlock];
    const size_t k = i % kBlock;
    out.push_back({points_[i], std::atan2(block.im[k] + 0.0, block.re[k]) / (2 * std::numbers::pi) + block.turns[k],
                   winding_[i] != 0});  // + 0.0: with -0 atan2 would give -pi
  }
  return out;
}

Trust TrustCheck::result() {
  Trust out;
  for (const TrustPoint& p : points()) {
    const double beyond = std::abs(p.winding) - 0.5;
    out.add({1, (beyond > 0) != p.inside, std::abs(beyond), p.at, p.at, p.at});
  }
  return out;
}

Trust try_points(std::span<const Vec3> points, const Vec3& lo, const Vec3& hi, int threads, const std::function<void(TrustCheck&)>& feed) {
  constexpr size_t kWorthAThread = 1024;
  threads = static_cast<int>(std::min(static_cast<size_t>(threads), points.size() / kWorthAThread + 1));
  Trust out;
  size_t next = 0;
  const size_t share = (points.size() + static_cast<size_t>(threads) - 1) / static_cast<size_t>(threads);
  in_order(
      threads,
      [&]() -> std::optional<std::span<const Vec3>> {
        if (next >= points.size()) return std::nullopt;
        const auto part = points.subspan(next, std::min(share, points.size() - next));
        next += part.size();
        return part;
      },
      [&](std::span<const Vec3> part, int) {
        TrustCheck check(part, lo, hi);
        feed(check);
        return check.result();
      },
      [&](const Trust& part) { out.add(part); });
  return out;
}

std::string trust_warning(const Trust& t, const std::string& body) {
  if (!t.worth_a_warning()) return "";
  return fmt::format(
      "body '{}': look at its caps. Of {} points that were tried, the cells and the surface without its caps disagree at {} ({:.1f} %): the cell is inside although "
      "the surface's winding number is not above 1/2, or the other way round. The clearest of these points is {}; all lie in the box from {} to {}. If the cells "
      "are wrong there, close the surface, set another \"stitch\" (a longer one if gaps were left open, a shorter one if it joined separate parts), or set another \"fill\"",
      body, t.points, t.disagree, 100.0 * static_cast<double>(t.disagree) / static_cast<double>(t.points), place_text(t.at), place_text(t.lo),
      place_text(t.hi));
}

}  // namespace teracell::mesher
