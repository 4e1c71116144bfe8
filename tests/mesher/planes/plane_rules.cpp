#include "tests/mesher/planes/plane_rules.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace teracell::testing {
namespace {

using mesher::AutoPlanes;
constexpr double kNear = 1e-9;  // relative

struct Wish {
  double at;
  int rank;
  double area;
};

std::array<double, 2> extent_of(const shapes::Facets& facets, int axis) {
  std::array<double, 2> out = {HUGE_VAL, -HUGE_VAL};
  for (const mesher::Facet& f : facets)
    for (const Vec3& v : f.vertex) out = {std::min(out[0], v[axis]), std::max(out[1], v[axis])};
  return out;
}

struct Face {
  double at, area;
  int outwards;  // 1: the body lies below it; -1: above it; 0: on both sides
};

// Facets whose corners have one coordinate. (Random scenes have none that are flat but for rounding.)
std::vector<Face> faces_of(const shapes::Facets& facets, int axis) {
  std::map<double, std::pair<double, double>> found;  // area, and that which faces upwards less the rest
  const double sign = shapes::volume(facets) < 0 ? -1 : 1;
  for (const mesher::Facet& f : facets) {
    const auto& [a, b, c] = f.vertex;
    if (a[axis] != b[axis] || b[axis] != c[axis]) continue;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double normal = ((b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u])) / 2;
    found[a[axis]].first += std::abs(normal), found[a[axis]].second += sign * normal;
  }
  std::vector<Face> out;
  for (const auto& [at, areas] : found) out.push_back({at, areas.first, std::abs(areas.second) < 1e-9 * areas.first ? 0 : areas.second > 0 ? 1 : -1});
  return out;
}

bool names(const std::vector<std::string>& list, const RuledBody& b) {
  return std::ranges::find(list, b.name) != list.end() || std::ranges::find(list, b.material) != list.end();
}

double step_of(const AutoPlanes& rules, const RuledBody& b) {
  double step = HUGE_VAL;
  for (const std::string& name : {b.name, b.material})
    if (const auto r = rules.resolution.find(name); r != rules.resolution.end() && r->second.step) step = std::min(step, *r->second.step);
  return step;
}

std::vector<Wish> wishes(const RuledAxis& of, const std::vector<RuledBody>& bodies, const std::array<double, 2>& domain) {
  const AutoPlanes& rules = of.rules;
  std::vector<Wish> out = {{domain[0], 0, 0}, {domain[1], 0, 0}};
  for (const double f : rules.fixed) out.push_back({f, 1, 0});
  if (rules.snap == AutoPlanes::Snap::kNone) return out;
  for (const RuledBody& b : bodies) {
    const auto extent = extent_of(b.facets, of.axis);
    for (const Face& face : faces_of(b.facets, of.axis)) {
      if (face.area < rules.finest * rules.finest) continue;
      const double own = step_of(rules, b);
      const double step = std::max(own == HUGE_VAL ? rules.finest : own, 3 * rules.finest);
      std::vector<double> at = {face.at};
      if (rules.snap == AutoPlanes::Snap::kThirds && names(rules.metals, b) && extent[1] - extent[0] > step && face.outwards != 0) {
        const double out_of_it = face.outwards;
        at = {face.at - out_of_it * step / 3, face.at + out_of_it * 2 * step / 3};
      }
      for (const double a : at)
        if (a > domain[0] && a < domain[1]) out.push_back({a, 2, face.area});
    }
  }
  return out;
}

struct Piece {
  double lo, hi, most;
};

// The largest width at each place: pieces between all places where it may change.
std::vector<Piece> pieces_of(const RuledAxis& of, const std::vector<RuledBody>& bodies, const std::vector<double>& kept) {
  std::vector<Piece> limits;
  for (const RuledBody& b : bodies) {
    const auto extent = extent_of(b.facets, of.axis);
    double most = step_of(of.rules, b);
    for (const std::string& name : {b.name, b.material})
      if (const auto r = of.rules.resolution.find(name); r != of.rules.resolution.end() && r->second.across)
        most = std::min(most, std::max(of.rules.finest, (extent[1] - extent[0]) / static_cast<double>(*r->second.across)));
    if (most < HUGE_VAL && extent[0] < extent[1]) limits.push_back({extent[0], extent[1], most});
  }
  std::vector<double> ends = kept;
  for (const Piece& l : limits)
    for (const double e : {l.lo, l.hi})
      if (e > kept.front() && e < kept.back()) ends.push_back(e);
  std::ranges::sort(ends);
  ends.erase(std::ranges::unique(ends).begin(), ends.end());
  std::vector<Piece> out;
  size_t gap = 0;
  for (size_t i = 0; i + 1 < ends.size(); ++i) {
    while (kept[gap + 1] <= ends[i]) ++gap;
    double most = std::min(of.rules.coarsest, kept[gap + 1] - kept[gap]);
    for (const Piece& l : limits)
      if (l.lo < ends[i + 1] && ends[i] < l.hi) most = std::min(most, l.most);
    out.push_back({ends[i], ends[i + 1], most});
  }
  return out;
}

// The sum over gaps of max(1, ceil(integral of dx / h)), where h(x) is the least over y of w(y) + log(growth) |x - y|.
double ideal_cells(const std::vector<Piece>& pieces, const std::vector<double>& kept, double growth) {
  const double slope = std::log(growth);
  std::vector<double> h(pieces.size() + 1, HUGE_VAL);  // at the ends
  for (size_t i = 0; i < pieces.size(); ++i)
    for (const size_t e : {i, i + 1}) h[e] = std::min(h[e], pieces[i].most);
  for (size_t i = 0; i < pieces.size(); ++i) h[i + 1] = std::min(h[i + 1], h[i] + slope * (pieces[i].hi - pieces[i].lo));
  for (size_t i = pieces.size(); i-- > 0;) h[i] = std::min(h[i], h[i + 1] + slope * (pieces[i].hi - pieces[i].lo));
  double sum = 0, cells = 0;
  size_t gap = 0;
  for (size_t i = 0; i < pieces.size(); ++i) {
    const auto [lo, hi, most] = pieces[i];
    const double up = (most - h[i]) / slope, down = (most - h[i + 1]) / slope, length = hi - lo;
    if (up + down <= length) cells += (std::log(most / h[i]) + std::log(most / h[i + 1])) / slope + (length - up - down) / most;
    else {
      const double top = (h[i] + h[i + 1] + slope * length) / 2;
      cells += (std::log(top / h[i]) + std::log(top / h[i + 1])) / slope;
    }
    if (hi != kept[gap + 1]) continue;
    sum += std::max(1.0, std::ceil(cells - 1e-9));
    cells = 0, ++gap;
  }
  return sum;
}

}  // namespace

Verdict judge(const RuledAxis& of, const std::vector<RuledBody>& bodies, const std::vector<double>& planes,
              const std::vector<PlaneBreach>& breaches) {
  const AutoPlanes& rules = of.rules;
  Verdict out;
  const auto broken = [&](const char* what, double at, double found) {
    if (out.broken.size() < 5) out.broken.push_back(std::string(what) + " at " + std::to_string(at) + ": " + std::to_string(found));
  };
  std::array<double, 2> domain = {HUGE_VAL, -HUGE_VAL};
  for (const RuledBody& b : bodies)
    domain = {std::min(domain[0], extent_of(b.facets, of.axis)[0]), std::max(domain[1], extent_of(b.facets, of.axis)[1])};
  const double pad = static_cast<double>(rules.pad) * rules.coarsest;
  domain = of.domain.value_or(std::array{domain[0] - pad, domain[1] + pad});

  std::vector<Wish> all = wishes(of, bodies, domain);
  std::ranges::sort(all, [](const Wish& a, const Wish& b) { return std::tuple(a.rank, -a.area, a.at) < std::tuple(b.rank, -b.area, b.at); });
  std::vector<double> kept;
  for (const Wish& w : all)
    if (w.rank == 0 || std::ranges::none_of(kept, [&](double k) { return std::abs(k - w.at) < rules.finest * (1 - kNear); })) kept.push_back(w.at);
  std::ranges::sort(kept);
  out.gaps = kept.size() - 1;

  for (const double k : kept)
    if (!std::ranges::binary_search(planes, k)) broken("a candidate is no plane", k, 0);
  if (planes.front() != domain[0] || planes.back() != domain[1]) broken("the domain ends elsewhere", planes.front(), planes.back());
  const auto gap_above = [&](double x) {  // the gap that holds what lies just above x
    const auto above = std::ranges::upper_bound(kept, x);
    return *above - *(above - 1);
  };
  const auto gap_below = [&](double x) {
    const auto at = std::ranges::lower_bound(kept, x);
    return *at - *(at - 1);
  };
  const std::vector<Piece> pieces = pieces_of(of, bodies, kept);
  const double short_gap = rules.finest * std::ceil(1 / (rules.growth - 1) - 1e-9);
  std::map<std::pair<int, double>, bool> listed;
  for (const PlaneBreach& b : breaches) listed[{static_cast<int>(b.rule), b.at}] = true;
  const auto is_listed = [&](PlaneBreach::Rule rule, double at) { return listed.contains({static_cast<int>(rule), at}); };
  size_t found = 0;
  for (size_t i = 0; i + 1 < planes.size(); ++i) {
    const double lo = planes[i], hi = planes[i + 1], width = hi - lo;
    if (!(width > 0)) broken("planes don't ascend", lo, width);
    if (width < rules.finest * (1 - kNear)) {
      ++found;
      if (gap_above(lo) >= rules.finest * (1 - kNear)) broken("narrower than finest", lo, width);
      if (!is_listed(PlaneBreach::Rule::kFinest, lo)) broken("not listed: narrower than finest", lo, width);
    }
    double most = HUGE_VAL;
    for (const Piece& p : pieces)
      if (p.lo < hi && lo < p.hi) most = std::min(most, p.most);
    if (width > most * (1 + kNear)) {
      ++found;
      if (most >= 2 * rules.finest) broken("wider than allowed, where whole cells could be less", lo, width / most);
      if (!is_listed(PlaneBreach::Rule::kWidth, lo)) broken("not listed: wider than allowed", lo, width);
    }
    if (i == 0) continue;
    const double before = lo - planes[i - 1], ratio = std::max(width / before, before / width);
    if (ratio <= rules.growth * (1 + kNear)) continue;
    ++found;
    if (!std::ranges::binary_search(kept, lo) || std::min(gap_above(lo), gap_below(lo)) >= short_gap * (1 - kNear)) broken("growth", lo, ratio);
    if (!is_listed(PlaneBreach::Rule::kGrowth, lo)) broken("not listed: growth", lo, ratio);
  }
  if (found != breaches.size()) broken("breaches are listed that are none", static_cast<double>(breaches.size()), static_cast<double>(found));

  out.cells = static_cast<double>(planes.size() - 1);
  out.ideal = ideal_cells(pieces, kept, rules.growth);
  const double sum = domain[0] + domain[1], slack = 1e-12 * (domain[1] - domain[0]);
  out.symmetric = true;
  for (size_t i = 0; i < kept.size(); ++i) out.symmetric &= std::abs(kept[i] + kept[kept.size() - 1 - i] - sum) <= slack;
  for (size_t i = 0; i < pieces.size(); ++i) {
    const Piece& other = pieces[pieces.size() - 1 - i];
    out.symmetric &= std::abs(pieces[i].lo + other.hi - sum) <= slack && std::abs(pieces[i].most - other.most) <= 1e-12 * other.most;
  }
  if (out.symmetric)
    for (size_t i = 0; i < planes.size(); ++i)
      if (std::abs(planes[i] + planes[planes.size() - 1 - i] - sum) > 2 * slack) broken("not symmetric", planes[i], planes[planes.size() - 1 - i]);
  return out;
}

}  // namespace teracell::testing
