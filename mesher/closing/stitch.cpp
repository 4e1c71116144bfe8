#include "mesher/closing/stitch.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "mesher/closing/lengths.hpp"
#include "mesher/closing/point_tree.hpp"
#include "store/base/error.hpp"
#include "store/base/groups.hpp"

namespace teracell::mesher {
namespace {

// How often a shell uses the edge lo - hi: `net` uses more from lo to hi than back. Vertices are numbered in ascending order.
struct Pair {
  uint32_t lo, hi, shell;
  int64_t net;
  bool odd() const { return net % 2 != 0; }
  auto edge() const { return std::pair(lo, hi); }
};

Pair pair_of(uint32_t from, uint32_t to, uint32_t shell, int64_t net) { return from < to ? Pair{from, to, shell, net} : Pair{to, from, shell, -net}; }

class Stitcher {
 public:
  Stitcher(const std::vector<OpenEdge>& edges, std::vector<ShellRule> rules, double stitch, const std::string& name)
      : edges_(edges), rules_(std::move(rules)), stitch_(stitch), name_(name), groups_(rules_.size()) {
    for (const OpenEdge& e : edges_) vertices_.push_back(e.edge.from), vertices_.push_back(e.edge.to);
    std::ranges::sort(vertices_);
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
    representative_.resize(vertices_.size());
    std::iota(representative_.begin(), representative_.end(), 0);
  }

  Stitched run() {
    if (stitch_ > 0) choose_representatives();
    const std::vector<Pair> own = sum_by_shell(first_pairs());
    if (stitch_ > 0) subdivide(own);
    join_shells(own);
    join_shells(sum_by_shell(pieces(own)));
    const std::vector<Pair> met = sum_by_group(own);
    left_ = sum_by_group(pieces(met));
    decide();
    make_facets(met);
    measure_seams();
    return result();
  }

 private:
  // In ascending order, each vertex that is not yet taken becomes the representative of the later vertices near it.
  void choose_representatives() {
    const PointTree tree(vertices_);
    std::vector<bool> taken(vertices_.size());
    for (uint32_t r = 0; r < vertices_.size(); ++r) {
      if (taken[r]) continue;
      tree.near(vertices_[r], vertices_[r], stitch_, [&](uint32_t v) {
        if (v <= r || taken[v] || distance(vertices_[v], vertices_[r]) > stitch_) return;
        taken[v] = true;
        representative_[v] = r;
      });
    }
  }

  uint32_t number(const Vec3& v) const { return static_cast<uint32_t>(std::ranges::lower_bound(vertices_, v) - vertices_.begin()); }
  bool counts_crossings(uint32_t shell) const { return rules_[shell] == ShellRule::kEvenodd || rules_[shell] == ShellRule::kDistinct; }
  // In a shell that counts crossings, an edge counts once.
  int64_t uses(const OpenEdge& e) const { return counts_crossings(e.shell) ? 1 : static_cast<int64_t>(e.edge.net); }

  std::vector<Pair> first_pairs() const {
    std::vector<Pair> out;
    for (const OpenEdge& e : edges_) {
      const uint32_t from = representative_[number(e.edge.from)], to = representative_[number(e.edge.to)];
      if (from != to) out.push_back(pair_of(from, to, e.shell, uses(e)));
    }
    return out;
  }

  // Adds up the uses of each edge by each shell and returns those that do not cancel, in ascending order. Pair::shell is a shell,
  // or the representative of a group of shells.
  std::vector<Pair> sum(std::vector<Pair> pairs, const std::vector<bool>& by_parity) const {
    std::vector<Pair> out;
    std::ranges::sort(pairs, [](const Pair& a, const Pair& b) { return std::tuple(a.lo, a.hi, a.shell) < std::tuple(b.lo, b.hi, b.shell); });
    for (size_t i = 0; i < pairs.size();) {
      Pair p = pairs[i];
      for (++i; i < pairs.size() && pairs[i].edge() == p.edge() && pairs[i].shell == p.shell; ++i) p.net += pairs[i].net;
      if (by_parity[p.shell] ? p.odd() : p.net != 0) out.push_back(p);
    }
    return out;
  }
  std::vector<Pair> sum_by_shell(std::vector<Pair> pairs) const {
    std::vector<bool> by_parity(rules_.size());
    for (uint32_t s = 0; s < rules_.size(); ++s) by_parity[s] = counts_crossings(s);
    return sum(std::move(pairs), by_parity);
  }
  // If one shell of a group counts crossings, all of the group do.
  std::vector<bool> groups_by_parity() {
    std::vector<bool> out(rules_.size());
    for (uint32_t s = 0; s < rules_.size(); ++s)
      if (counts_crossings(s)) out[groups_.of(s)] = true;
    return out;
  }
  std::vector<Pair> sum_by_group(std::vector<Pair> pairs) {
    for (Pair& p : pairs) p.shell = groups_.of(p.shell);
    return sum(std::move(pairs), groups_by_parity());
  }

  // Joins shells that each use the same edge an odd number of times. REQUIRES: sums by shell.
  void join_shells(const std::vector<Pair>& pairs) {
    const Pair* last = nullptr;
    for (const Pair& p : pairs) {
      if (!p.odd()) continue;
      if (last && last->edge() == p.edge()) groups_.join(last->shell, p.shell);
      last = &p;
    }
  }

  // Finds the representatives that lie along each edge, in order from its lesser end to its greater one.
  void subdivide(const std::vector<Pair>& pairs) {
    std::vector<uint32_t> numbers;
    std::vector<Vec3> points;
    for (uint32_t v = 0; v < vertices_.size(); ++v)
      if (representative_[v] == v) numbers.push_back(v), points.push_back(vertices_[v]);
    const PointTree tree(points);
    uint64_t between = 0;
    for (const Pair& p : pairs) {
      if (between_.contains(p.edge())) continue;
      const Vec3 &a = vertices_[p.lo], &b = vertices_[p.hi], e = b - a;
      const double square = dot(e, e);
      std::vector<std::pair<double, uint32_t>> found;
      tree.near(a, b, stitch_, [&](uint32_t i) {
        const uint32_t v = numbers[i];
        const double t = dot(vertices_[v] - a, e) / square;
        if (v == p.lo || v == p.hi || !(t > 0 && t < 1)) return;
        const Vec3 foot = {a[0] + t * e[0], a[1] + t * e[1], a[2] + t * e[2]};
        if (const double away = distance(vertices_[v], foot); away <= stitch_) {
          found.emplace_back(t, v);
          widest_ = std::max(widest_, away);
        }
      });
      std::ranges::sort(found);
      check_count(between += found.size());
      auto& list = between_[p.edge()];
      for (const auto& [t, v] : found) list.push_back(v);
    }
  }

  std::vector<Pair> pieces(const std::vector<Pair>& met) const {
    std::vector<Pair> out;
    for (const Pair& p : met) {
      uint32_t from = p.lo;
      for (const uint32_t v : between(p)) {
        out.push_back(pair_of(from, v, p.shell, p.net));
        from = v;
      }
      out.push_back(pair_of(from, p.hi, p.shell, p.net));
    }
    return out;
  }
  std::span<const uint32_t> between(const Pair& p) const {
    const auto it = between_.find(p.edge());
    return it == between_.end() ? std::span<const uint32_t>{} : it->second;
  }

  // Chooses the rule that leaves fewer edges open: an edge whose net is even is closed by parity.
  void decide() {
    std::vector<bool> by_parity = groups_by_parity(), undecided(rules_.size());
    for (uint32_t s = 0; s < rules_.size(); ++s)
      if (rules_[s] == ShellRule::kAuto) undecided[groups_.of(s)] = true;
    for (const Pair& p : left_)
      if (undecided[p.shell] && !p.odd()) by_parity[p.shell] = true;
    for (uint32_t s = 0; s < rules_.size(); ++s)
      if (rules_[s] != ShellRule::kDistinct) rules_[s] = by_parity[groups_.of(s)] ? ShellRule::kEvenodd : ShellRule::kNonzero;
  }

  void check_count(uint64_t facets) const {
    constexpr uint64_t kMostPerEdge = 64;
    if (facets > kMostPerEdge * edges_.size())
      throw InputError(fmt::format(
          "{}: stitching would take more than {} facets per open edge ({} edges are open), because the stitch length of {:.6g} (in the mesh's "
          "own units) is too long for so fine a mesh. Set a shorter \"stitch\", or 0 for none",
          name_, kMostPerEdge, edges_.size(), stitch_));
  }

  void add(bool parity, int64_t count, const Vec3& a, const Vec3& b, const Vec3& c) {
    if (a == b || b == c || c == a) return;
    for (int64_t k = 0; k < count; ++k) facets_[parity].push_back({{a, b, c}});
    check_count(facets_[0].size() + facets_[1].size());
  }

  void make_facets(const std::vector<Pair>& met) {
    for (const OpenEdge& e : edges_) {
      const bool parity = counts_crossings(e.shell);
      if (parity && !e.edge.odd()) continue;
      const bool forward = !parity || e.edge.from < e.edge.to;
      const Vec3 &a = forward ? e.edge.from : e.edge.to, &b = forward ? e.edge.to : e.edge.from;
      const Vec3 &ra = vertices_[representative_[number(a)]], &rb = vertices_[representative_[number(b)]];
      widest_ = std::max({widest_, distance(a, ra), distance(b, rb)});
      const int64_t count = parity ? 1 : static_cast<int64_t>(e.edge.net);
      add(parity, count, b, a, ra);
      add(parity, count, b, ra, rb);
    }
    for (const Pair& p : met) {
      const bool parity = counts_crossings(p.shell);
      if (parity && !p.odd()) continue;
      const int64_t count = parity ? 1 : std::abs(p.net);
      const bool back = !parity && p.net < 0;
      const Vec3& q = vertices_[p.hi];
      uint32_t from = p.lo;
      for (const uint32_t v : between(p)) {
        const Vec3 &a = vertices_[from], &b = vertices_[v];
        back ? add(parity, count, q, b, a) : add(parity, count, q, a, b);
        from = v;
      }
    }
  }

  // A seam is a connected curve. Both its sides were open, so its length is half the length of the edges that are no longer open.
  void measure_seams() {
    if (stitch_ == 0) return;
    std::map<std::pair<uint32_t, uint32_t>, int64_t> open;  // for each piece of an edge: how many sides of a seam run along it
    for (const OpenEdge& e : edges_) {
      if (counts_crossings(e.shell) && !e.edge.odd()) continue;
      const uint32_t from = representative_[number(e.edge.from)], to = representative_[number(e.edge.to)];
      if (from == to) {
        ++seams_.collapsed;
        continue;
      }
      const Pair p = pair_of(from, to, 0, 1);
      uint32_t last = p.lo;
      const auto use = [&](uint32_t next) {
        open[{std::min(last, next), std::max(last, next)}] += uses(e);
        last = next;
      };
      for (const uint32_t v : between(p)) use(v);
      use(p.hi);
    }
    for (const Pair& p : left_)
      if (!counts_crossings(p.shell) || p.odd()) open[p.edge()] -= counts_crossings(p.shell) ? 1 : std::abs(p.net);
    Groups curves(vertices_.size());
    for (const auto& [edge, closed] : open) {
      if (closed <= 0) continue;
      seams_.length += static_cast<double>(closed) / 2 * distance(vertices_[edge.first], vertices_[edge.second]);
      curves.join(edge.first, edge.second);
    }
    std::vector<uint32_t> roots;
    for (const auto& [edge, closed] : open)
      if (closed > 0) roots.push_back(curves.of(edge.first));
    std::ranges::sort(roots);
    seams_.number = static_cast<uint64_t>(std::unique(roots.begin(), roots.end()) - roots.begin());
    if (seams_.number > 0 || seams_.collapsed > 0) seams_.widest_gap = widest_;
  }

  Stitched result() {
    Stitched out;
    std::vector<uint32_t> number(rules_.size(), ~0u);  // in out.groups, of each group that has a boundary
    for (const Pair& p : left_) {
      const bool parity = counts_crossings(p.shell);
      const uint32_t from = p.net > 0 ? p.lo : p.hi, to = p.net > 0 ? p.hi : p.lo;
      const auto net = static_cast<uint64_t>(std::abs(p.net));
      const BoundaryEdge edge = {vertices_[from], vertices_[to], net, net};
      if (!p.odd()) out.flips.push_back(edge);
      if (parity && !p.odd()) continue;
      uint32_t& n = number[p.shell];
      if (n == ~0u) {
        n = static_cast<uint32_t>(out.groups.size());
        out.groups.push_back({parity, {}});
      }
      out.groups[n].left.push_back(edge);
    }
    out.rule = std::move(rules_);
    out.facets = std::move(facets_);
    out.seams = seams_;
    return out;
  }

  const std::vector<OpenEdge>& edges_;
  std::vector<ShellRule> rules_;
  const double stitch_;
  const std::string& name_;
  std::vector<Vec3> vertices_;  // ascending
  std::vector<uint32_t> representative_;
  Groups groups_;
  std::map<std::pair<uint32_t, uint32_t>, std::vector<uint32_t>> between_;  // lo - hi: the representatives along it
  std::vector<Pair> left_;
  std::array<std::vector<Facet>, 2> facets_;
  double widest_ = 0;
  Seams seams_;
};

}  // namespace

Stitched stitch_boundary(const std::vector<OpenEdge>& edges, std::vector<ShellRule> rules, double stitch, const std::string& name) {
  return Stitcher(edges, std::move(rules), stitch, name).run();
}

}  // namespace teracell::mesher
