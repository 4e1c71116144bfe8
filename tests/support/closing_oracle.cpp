#include "tests/support/closing_oracle.hpp"

namespace teracell::oracle {
namespace {

using Edge = std::pair<Vec3, Vec3>;     // the lesser vertex first
using Chain = std::map<Edge, int64_t>;  // how often more from the lesser to the greater than back; by parity: 1

enum class By { kWinding, kParity };

void count(Chain& chain, const Vec3& from, const Vec3& to) {
  if (from < to) chain[{from, to}] += 1;
  if (to < from) chain[{to, from}] -= 1;
}

// What does not cancel.
Chain left_of(Chain chain, By by) {
  if (by == By::kParity)
    for (auto& [edge, k] : chain) k = std::abs(k % 2);
  std::erase_if(chain, [](const auto& entry) { return entry.second == 0; });
  return chain;
}

// One use either way changes the count by 1, so its parity is that of the uses.
Chain boundary_of(const std::vector<mesher::Facet>& facets, By by) {
  Chain chain;
  for (const mesher::Facet& f : facets)
    for (int i = 0; i < 3; ++i) count(chain, f.vertex[i], f.vertex[(i + 1) % 3]);
  return left_of(chain, by);
}

double length(double x, double y, double z) { return std::sqrt((x * x + y * y) + z * z); }
double distance(const Vec3& p, const Vec3& q) { return length(p[0] - q[0], p[1] - q[1], p[2] - q[2]); }

// For each end of a boundary edge the one that stands for it.
std::map<Vec3, Vec3> representatives_of(const std::set<Vec3>& ends, double tau) {
  std::map<Vec3, Vec3> out;
  for (auto one = ends.begin(); one != ends.end(); ++one) {
    if (out.contains(*one)) continue;
    out[*one] = *one;
    for (auto later = std::next(one); later != ends.end(); ++later)
      if (!out.contains(*later) && distance(*one, *later) <= tau) out[*later] = *one;
  }
  return out;
}

// From the lesser end to the greater one, over the representatives beside the way.
std::vector<Vec3> path_between(const Vec3& a, const Vec3& b, const std::set<Vec3>& representatives, double tau) {
  const Vec3 e = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const double squared = (e[0] * e[0] + e[1] * e[1]) + e[2] * e[2];
  std::vector<std::pair<double, Vec3>> beside;
  for (const Vec3& p : representatives) {
    if (p == a || p == b) continue;
    const Vec3 d = {p[0] - a[0], p[1] - a[1], p[2] - a[2]};
    const double t = ((d[0] * e[0] + d[1] * e[1]) + d[2] * e[2]) / squared;
    if (!(t > 0 && t < 1)) continue;
    const Vec3 foot = {a[0] + t * e[0], a[1] + t * e[1], a[2] + t * e[2]};
    if (distance(p, foot) <= tau) beside.push_back({t, p});
  }
  std::sort(beside.begin(), beside.end());
  std::vector<Vec3> path = {a};
  for (const auto& [t, p] : beside) path.push_back(p);
  path.push_back(b);
  return path;
}

struct Stitched {
  std::vector<mesher::Facet> facets;
  Chain before;  // between representatives: what does not cancel
  Chain left;    // of that, once it is subdivided
};

class Needle {
 public:
  Needle(const std::set<Vec3>& ends, double tau) : tau_(tau), stands_for_(representatives_of(ends, tau)) {
    for (const auto& [vertex, r] : stands_for_) representatives_.insert(r);
  }

  Stitched stitch(const Chain& boundary, By by) const {
    Stitched out;
    if (tau_ == 0) return {{}, boundary, boundary};
    const auto add = [&](const Vec3& p, const Vec3& q, const Vec3& r) {
      if (p != q && q != r && r != p) out.facets.push_back({{p, q, r}});
    };
    for (const auto& [edge, k] : boundary) {
      const auto& [a, b] = k > 0 ? edge : Edge{edge.second, edge.first};  // by parity k is 1, so a < b
      const Vec3 &ra = stands_for_.at(a), &rb = stands_for_.at(b);
      for (int64_t i = 0; i < std::abs(k); ++i) {
        add(b, a, ra);
        add(b, ra, rb);
        count(out.before, ra, rb);
      }
    }
    out.before = left_of(out.before, by);
    for (const auto& [edge, k] : out.before) {
      const std::vector<Vec3> path = path_between(edge.first, edge.second, representatives_, tau_);
      for (int64_t i = 0; i < std::abs(k); ++i)
        for (size_t s = 0; s + 1 < path.size(); ++s) {
          const Vec3 &from = path[k > 0 ? s : s + 1], &to = path[k > 0 ? s + 1 : s];
          add(edge.second, from, to);  // the fan, from the greater end
          count(out.left, from, to);
        }
    }
    out.left = left_of(out.left, by);
    return out;
  }

 private:
  double tau_;
  std::map<Vec3, Vec3> stands_for_;
  std::set<Vec3> representatives_;
};

// From the smallest vertex along the smallest unused edge; what a vertex that comes up again closes is cut off, and the
// walk goes on from there.
std::vector<std::vector<Vec3>> loops_of(const Chain& chain, By by) {
  std::map<Vec3, std::multiset<Vec3>> leaving;
  for (const auto& [edge, k] : chain) {
    for (int64_t i = 0; i < std::abs(k); ++i) (k > 0 ? leaving[edge.first] : leaving[edge.second]).insert(k > 0 ? edge.second : edge.first);
    if (by == By::kParity) leaving[edge.second].insert(edge.first);
  }
  const auto take = [&](const Vec3& from, const Vec3& to) {
    leaving[from].erase(leaving[from].find(to));
    if (leaving[from].empty()) leaving.erase(from);
  };
  std::vector<std::vector<Vec3>> loops;
  while (!leaving.empty()) {
    std::vector<Vec3> path = {leaving.begin()->first};
    while (leaving.contains(path.back())) {
      const Vec3 from = path.back(), to = *leaving[from].begin();
      take(from, to);
      if (by == By::kParity) take(to, from);
      const auto met = std::find(path.begin(), path.end(), to);
      if (met == path.end()) {
        path.push_back(to);
        continue;
      }
      loops.emplace_back(met, path.end());
      path.erase(std::next(met), path.end());
    }
  }
  return loops;
}

Vec3 apex_of(std::vector<Vec3> loop, bool float32) {
  std::sort(loop.begin(), loop.end());
  Vec3 apex;
  for (int d = 0; d < 3; ++d) {
    double sum = 0, lo = loop[0][d], hi = lo;
    for (const Vec3& v : loop) {
      sum += v[d];
      lo = std::min(lo, v[d]);
      hi = std::max(hi, v[d]);
    }
    apex[d] = std::clamp(sum / static_cast<double>(loop.size()), lo, hi);
    if (float32) apex[d] = static_cast<float>(apex[d]);
  }
  return apex;
}

using Vertices = std::array<Vec3, 3>;
Vertices sorted_vertices(const mesher::Facet& f) {
  Vertices v = f.vertex;
  std::sort(v.begin(), v.end());
  return v;
}

// Of those with the same three vertices the first.
std::vector<mesher::Facet> distinct(const std::vector<mesher::Facet>& facets) {
  std::set<Vertices> seen;
  std::vector<mesher::Facet> out;
  for (const mesher::Facet& f : facets)
    if (seen.insert(sorted_vertices(f)).second) out.push_back(f);
  return out;
}

// Whether facets that cancel are at least half of all. One with two equal vertices is its own opposite: it takes no part.
bool mostly_cancels(const std::vector<mesher::Facet>& facets) {
  std::map<Vertices, int64_t> net;
  int64_t all = 0, stays = 0;
  for (const mesher::Facet& f : facets) {
    const Vertices v = sorted_vertices(f);
    if (v[0] == v[1] || v[1] == v[2]) continue;
    const bool even = f.vertex == Vertices{v[0], v[1], v[2]} || f.vertex == Vertices{v[1], v[2], v[0]} || f.vertex == Vertices{v[2], v[0], v[1]};
    net[v] += even ? 1 : -1;
    ++all;
  }
  for (const auto& [vertices, n] : net) stays += std::abs(n);
  return all > 0 && 2 * (all - stays) >= all;
}

// The facets of each shell, in the order of its first one.
std::vector<std::vector<mesher::Facet>> shells_of(const std::vector<mesher::Facet>& facets) {
  std::map<Vec3, std::set<size_t>> at;  // facets by vertex
  for (size_t i = 0; i < facets.size(); ++i)
    for (const Vec3& v : facets[i].vertex) at[v].insert(i);
  std::vector<bool> seen(facets.size());
  std::vector<std::vector<mesher::Facet>> shells;
  for (size_t first = 0; first < facets.size(); ++first) {
    if (seen[first]) continue;
    std::set<size_t> shell, next = {first};
    while (!next.empty()) {
      const size_t i = *next.begin();
      next.erase(next.begin());
      if (!shell.insert(i).second) continue;
      seen[i] = true;
      for (const Vec3& v : facets[i].vertex) next.insert(at[v].begin(), at[v].end());
    }
    shells.emplace_back();
    for (const size_t i : shell) shells.back().push_back(facets[i]);
  }
  return shells;
}

struct Shell {
  std::vector<mesher::Facet> facets;  // that count
  bool distinct;
  Chain winding, parity;      // its boundary by either rule
  bool closed() const { return parity.empty() || (winding.empty() && !distinct); }
};

Shell shell_of(const std::vector<mesher::Facet>& facets, bool is_distinct) {
  Shell s{is_distinct ? distinct(facets) : facets, is_distinct, {}, {}};
  s.winding = boundary_of(s.facets, By::kWinding);
  s.parity = boundary_of(s.facets, By::kParity);
  return s;
}

bool share_an_edge(const Chain& a, const Chain& b) {
  return std::any_of(a.begin(), a.end(), [&](const auto& entry) { return b.contains(entry.first); });
}

// Adds shells that count as one, with what closes them.
void add_closed(ClosedSurface& out, const std::vector<const Shell*>& members, By by, const Needle& needle, bool float32) {
  JoinedShell joined;
  Chain boundary;
  std::vector<mesher::Facet>& facets = by == By::kParity ? out.evenodd : out.nonzero;
  joined.shells = members.size();
  joined.evenodd = by == By::kParity;
  for (const Shell* s : members) {
    joined.distinct |= s->distinct;
    facets.insert(facets.end(), s->facets.begin(), s->facets.end());
    const Chain& own = by == By::kParity ? s->parity : s->winding;
    boundary.insert(own.begin(), own.end());  // shells share no vertex
  }
  joined.boundary = boundary.size();
  if (!boundary.empty()) {
    const Stitched stitched = needle.stitch(boundary, by);
    out.stitches += stitched.facets.size();
    facets.insert(facets.end(), stitched.facets.begin(), stitched.facets.end());
    joined.open = stitched.left.size();
    for (const std::vector<Vec3>& loop : loops_of(stitched.left, by)) {
      ++joined.loops;
      const Vec3 apex = apex_of(loop, float32);
      for (size_t i = 0; i < loop.size(); ++i) facets.push_back({{loop[(i + 1) % loop.size()], loop[i], apex}});
    }
  }
  out.shells.push_back(joined);
}

void add_ends(std::set<Vec3>& ends, const Chain& boundary) {
  for (const auto& [edge, k] : boundary) ends.insert({edge.first, edge.second});
}

ClosedSurface closed_by_shell(const std::vector<mesher::Facet>& facets, Fill fill, double tau, bool float32) {
  const bool automatic = fill == Fill::kAuto, by_parity = fill == Fill::kEvenodd || fill == Fill::kDistinct;
  std::vector<Shell> open;
  std::set<Vec3> ends;
  ClosedSurface out;
  for (const std::vector<mesher::Facet>& one : shells_of(facets)) {
    Shell shell = shell_of(one, fill == Fill::kDistinct || (automatic && mostly_cancels(one)));
    if (automatic ? shell.closed() : by_parity ? shell.parity.empty() : shell.winding.empty()) {
      const bool parity = automatic ? shell.distinct || !shell.winding.empty() : by_parity;
      add_closed(out, {&shell}, parity ? By::kParity : By::kWinding, Needle({}, 0), float32);
      continue;
    }
    add_ends(ends, shell.distinct || by_parity ? shell.parity : shell.winding);
    open.push_back(std::move(shell));
  }
  const Needle needle(ends, tau);

  // Edges that a shell uses an odd number of times are those that are left by parity.
  std::vector<Stitched> alone;
  for (const Shell& s : open) alone.push_back(needle.stitch(s.parity, By::kParity));
  std::vector<size_t> group(open.size());
  for (size_t i = 0; i < open.size(); ++i) group[i] = i;
  for (size_t i = 0; i < open.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      if (share_an_edge(alone[i].before, alone[j].before) || share_an_edge(alone[i].left, alone[j].left)) {
        const size_t gone = group[j];
        std::replace(group.begin(), group.end(), gone, group[i]);
      }
  for (size_t g = 0; g < open.size(); ++g) {
    std::vector<const Shell*> members;
    Chain winding, parity;
    for (size_t i = 0; i < open.size(); ++i) {
      if (group[i] != g) continue;
      members.push_back(&open[i]);
      winding.insert(open[i].winding.begin(), open[i].winding.end());
      parity.insert(open[i].parity.begin(), open[i].parity.end());
    }
    if (members.empty()) continue;
    const bool has_distinct = std::any_of(members.begin(), members.end(), [](const Shell* s) { return s->distinct; });
    const bool evenodd =
        automatic ? has_distinct || needle.stitch(parity, By::kParity).left.size() < needle.stitch(winding, By::kWinding).left.size() : by_parity;
    add_closed(out, members, evenodd ? By::kParity : By::kWinding, needle, float32);
  }
  return out;
}

}  // namespace

ClosedSurface closed(const std::vector<mesher::Facet>& facets, Fill fill, double tau, bool float32) {
  ClosedSurface out = closed_by_shell(facets, fill, tau, float32);
  size_t boundary = 0;
  for (const JoinedShell& s : out.shells) boundary += s.boundary;
  if (out.stitches > 64 * boundary) throw std::length_error("oracle: too many stitches");
  return out;
}

double stitch_in_file(double stitch, const mesher::Matrix& m) {
  double longest = 0;
  for (int column = 0; column < 3; ++column) longest = std::max(longest, length(m[column], m[4 + column], m[8 + column]));
  return stitch / longest;
}

}  // namespace teracell::oracle
