#include "mesher/closing/closing.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "mesher/closing/extrude.hpp"
#include "mesher/scene/placement.hpp"
#include "mesher/surface/read_facets.hpp"
#include "store/base/error.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {
namespace {

// The memory that closing a surface may take, however small the budget.
constexpr uint64_t kLeastMemory = uint64_t{1} << 24;

std::string text(const Vec3& p) { return fmt::format("({}, {}, {})", p[0], p[1], p[2]); }

bool by_parity(ShellRule rule) { return rule == ShellRule::kEvenodd || rule == ShellRule::kDistinct; }

// Groups edges that run the same way in two facets: edges that share a vertex are in one group.
std::vector<Flip> group_flips(const std::vector<BoundaryEdge>& edges, const SceneBody& body) {
  std::unordered_map<uint32_t, size_t> group_of;  // by the edges' connected component, found as the shell of degenerate facets
  ShellCounter graph;
  for (const BoundaryEdge& e : edges) graph.add(vertex_hashes({{e.from, e.to, e.to}}));
  std::vector<Flip> flips;
  for (const BoundaryEdge& e : edges) {
    const auto [it, fresh] = group_of.try_emplace(graph.shell_of(vertex_hash(e.from)), flips.size());
    if (fresh) flips.push_back({moved(e.from, body), 0});
    ++flips[it->second].edges;
  }
  return flips;
}

// Whether other parts of the file use any boundary edge of this part.
bool touches_other_parts(const SceneBody& body, const Surface& surface, const std::vector<BoundaryEdge>& edges, const Budget& budget) {
  const auto key = [](const Vec3& a, const Vec3& b) { return std::pair(std::min(a, b), std::max(a, b)); };
  std::vector<std::pair<std::pair<Vec3, Vec3>, uint64_t>> uses;
  for (const BoundaryEdge& e : edges) uses.push_back({key(e.from, e.to), e.uses});
  std::ranges::sort(uses);
  bool found = false;
  std::vector<uint64_t> in_all(uses.size());
  read_facets(body.mesh, "",
              [&](std::span<const Facet> facets) {
                for (const Facet& f : facets)
                  for (int i = 0; i < 3; ++i) {
                    const auto edge = key(f.vertex[i], f.vertex[(i + 1) % 3]);
                    const auto it = std::ranges::lower_bound(uses, edge, {}, [](const auto& u) { return u.first; });
                    if (it != uses.end() && it->first == edge) found |= ++in_all[it - uses.begin()] > it->second;
                  }
              },
              {.budget = budget, .units = surface.units, .kept = surface.kept, .cad = surface.cad});
  return found;
}

class BodyCloser {
 public:
  BodyCloser(const SceneBody& body, const Surface& surface, const ClosingGrid& grid, const Budget& budget)
      : body_(body), surface_(surface), grid_(grid), budget_(budget) {}

  ClosedBody run() {
    out_.stitch = body_.stitch.value_or(grid_.shortest_edge / 4);
    if (is_simple()) return std::move(out_);
    find_boundary();
    choose_rules();
    stitch();
    if (body_.closing.way == Closing::Way::kStrict) refuse_what_is_open();
    if (out_.was_open && !body_.part.empty() && !counted_once_ && surface_.look_around)
      out_.cut_from_others = touches_other_parts(body_, surface_, edges_, budget_);
    edges_ = {};
    taking_part_ = {};
    close_what_is_open();
    describe_rules();
    return std::move(out_);
  }

 private:
  bool automatic() const { return body_.fill == Fill::kAuto; }

  // Nearly all bodies are closed, and no search for facets that lie on each other is needed.
  bool is_simple() {
    const bool closed =
        body_.fill == Fill::kEvenodd ? surface_.boundary.undirected_boundary_is_empty() : surface_.boundary.directed_boundary_is_empty();
    if (!closed || body_.fill == Fill::kDistinct || (automatic() && surface_.opposites)) return false;
    out_.fill.push_back(
        {automatic() ? Fill::kNonzero : body_.fill, std::nullopt, automatic() ? "closed: every edge is matched by its reverse" : "asked for"});
    return true;
  }

  std::vector<BoundaryEdge> edges_of(const FacetPass& facets) const {
    return boundary_edges(facets, std::max(budget_.bytes / 4, kLeastMemory), body_.mesh.string());
  }

  // Finds the boundary, and the shells in the same pass.
  void find_boundary() {
    shells_ = std::make_shared<Shells>(surface_.count, budget_, !surface_.in_memory);
    if (surface_.boundary.directed_boundary_is_empty()) {
      surface_.facets([&](const Facet& f) { shells_->add(f); });
    } else {
      bool first = true;
      edges_ = edges_of([&](const std::function<void(const Facet&)>& f) {
        const bool with_shells = std::exchange(first, false);
        surface_.facets([&](const Facet& facet) {
          if (with_shells) shells_->add(facet);
          f(facet);
        });
      });
      if (edges_.empty()) throw InputError(fmt::format("{}: the file changed while it was read", body_.mesh.string()));
    }
    shells_->finish();
  }

  // Chooses the rules that are known before stitching, and the edges that take part in it.
  void choose_rules() {
    rules_.assign(shells_->count(), body_.fill);
    bool repeats = body_.fill == Fill::kDistinct;
    if (automatic())
      for (uint32_t s = 0; s < shells_->count(); ++s)
        if (shells_->is_double(s)) rules_[s] = Fill::kDistinct, repeats = true;
    counted_once_ = repeats;
    if (repeats)
      edges_ = edges_of([&](const std::function<void(const Facet&)>& f) {
        uint64_t i = 0;
        surface_.facets([&](const Facet& facet) {
          if (rules_[shells_->of_facet(i)] != Fill::kDistinct || !shells_->repeats(i)) f(facet);
          ++i;
        });
      });

    std::vector<Vec3> ends;
    for (const BoundaryEdge& e : edges_) ends.push_back(e.from);
    const std::vector<uint32_t> shell = shells_->of(ends);
    std::vector<bool> has_odd(shells_->count());
    for (size_t i = 0; i < edges_.size(); ++i)
      if (edges_[i].odd()) has_odd[shell[i]] = true;
    for (size_t i = 0; i < edges_.size(); ++i) {
      const uint32_t s = shell[i];
      if (rules_[s] == Fill::kAuto && !has_odd[s]) rules_[s] = Fill::kEvenodd;  // closed by parity
      if (!edges_[i].odd() && rules_[s] != Fill::kDistinct) flips_.push_back(edges_[i]);
      if (edges_[i].odd() || !by_parity(rules_[s])) taking_part_.push_back({edges_[i], s});
    }
  }

  void stitch() {
    const double scale = longest_column(body_.matrix);
    out_.was_open = !taking_part_.empty();
    stitched_ = stitch_boundary(taking_part_, rules_, out_.stitch / scale, body_.mesh.string());
    out_.added = std::move(stitched_.facets);
    out_.seams = stitched_.seams;
    out_.seams.length *= scale;
    out_.seams.widest_gap *= scale;
    std::vector<BoundaryEdge> flips;  // in the file and between stitched patches
    const auto key = [](const BoundaryEdge& e) { return std::pair(std::min(e.from, e.to), std::max(e.from, e.to)); };
    for (const auto* list : {&flips_, &stitched_.flips}) flips.insert(flips.end(), list->begin(), list->end());
    std::ranges::sort(flips, {}, key);
    flips.erase(std::ranges::unique(flips, {}, key).begin(), flips.end());
    out_.flips = group_flips(flips, body_);
  }

  void refuse_what_is_open() const {
    uint64_t count = 0;
    const BoundaryEdge* first = nullptr;
    Vec3 lo{}, hi{};
    bool parity = false;
    for (const Stitched::Group& group : stitched_.groups)
      for (const BoundaryEdge& e : group.left) {
        if (!first) first = &e, lo = hi = e.from, parity = group.by_parity;
        ++count;
        for (const Vec3* p : {&e.from, &e.to})
          for (int d = 0; d < 3; ++d) lo[d] = std::min(lo[d], (*p)[d]), hi[d] = std::max(hi[d], (*p)[d]);
      }
    if (!first) return;
    throw InputError(fmt::format(
        "{}: body '{}' is not closed: every edge should be {}, but after stitching over {:.6g} there {} that {} not, within the box {} to {}; the first "
        "runs from {} to {} (coordinates of the mesh). Close the surface, set a longer \"stitch\", or set \"closing\": \"cap\" (for terrain \"closing\": {{\"extrude\": "
        "\"-z\"}}){}{}",
        body_.mesh.string(), body_.name, parity ? "used an even number of times" : "matched by its reverse", out_.stitch,
        (count == 1 ? "is " : "are ") + plural(count, "edge"), count == 1 ? "is" : "are", text(lo), text(hi), text(first->from), text(first->to),
        !parity && !out_.flips.empty() ? ". Some facets are oriented the other way round: orient them alike, or set \"fill\": \"auto\" or \"evenodd\""
                                       : "",
        body_.part.empty() ? "" : fmt::format(". Part '{}' may be cut off from parts of the file that the scene leaves out", body_.part)));
  }

  void close_what_is_open() {
    for (Stitched::Group& group : stitched_.groups) {
      const bool parity = group.by_parity;
      const std::vector<Loop> loops = cut_into_loops(std::exchange(group.left, {}), parity);
      std::vector<bool> extruded(loops.size());
      std::vector<Loop> placed;
      if (body_.closing.way == Closing::Way::kExtrude) {
        for (const Loop& loop : loops) {
          Loop& p = placed.emplace_back();
          for (const Vec3& v : loop) p.push_back(moved(v, body_));
        }
        extruded = outer_loops(placed, body_.closing.axis, parity);
      }
      Caps caps;
      for (size_t i = 0; i < loops.size(); ++i) {
        if (extruded[i]) extrude_loop(placed[i], body_.closing.axis, grid_.beyond[body_.closing.up], out_.walls[parity], caps.holes);
        else cap_loop(loops[i], surface_.float32, body_.matrix, caps);
      }
      out_.added[parity].insert(out_.added[parity].end(), caps.facets.begin(), caps.facets.end());
      out_.holes.insert(out_.holes.end(), caps.holes.begin(), caps.holes.end());
    }
    std::ranges::stable_sort(out_.holes, std::ranges::greater{}, &Hole::diameter);
  }

  void describe_rules() {
    std::array<uint64_t, 4> shells{};
    uint64_t doubled = 0, gone = 0;
    for (uint32_t s = 0; s < shells_->count(); ++s) {
      const ShellRule rule = stitched_.rule[s];
      ++shells[static_cast<size_t>(rule)];
      if (rule == Fill::kDistinct) doubled += shells_->facets(s), gone += shells_->cancelled(s);
    }
    const auto describe = [&](Fill rule, const std::string& why) {
      if (const uint64_t n = shells[static_cast<size_t>(rule)]; n > 0) out_.fill.push_back({rule, n, body_.fill == rule ? "asked for" : why});
    };
    describe(Fill::kNonzero, out_.was_open || !flips_.empty() ? "facets are oriented alike" : "closed: every edge is matched by its reverse");
    describe(Fill::kEvenodd, "some facets are oriented the other way round, and by parity fewer edges stay open than by winding number");
    describe(
        Fill::kDistinct,
        fmt::format("{} of {} facets lie on others of opposite orientation and would cancel, so each place counts once and parity decides the inside",
                    gone, doubled));
    const bool uniform = out_.fill.size() == 1 && out_.fill[0].rule != Fill::kDistinct;
    if (!uniform) out_.rules = std::make_shared<FacetRules>(std::move(shells_), std::move(stitched_.rule));
  }

  const SceneBody& body_;
  const Surface& surface_;
  const ClosingGrid& grid_;
  const Budget& budget_;
  ClosedBody out_;
  std::shared_ptr<Shells> shells_;
  std::vector<BoundaryEdge> edges_, flips_;
  std::vector<ShellRule> rules_;
  bool counted_once_ = false;  // edges_ is without facets that repeat others
  std::vector<OpenEdge> taking_part_;
  Stitched stitched_;
};

}  // namespace

ClosedBody close_body(const SceneBody& body, const Surface& surface, const ClosingGrid& grid, const Budget& budget) {
  return BodyCloser(body, surface, grid, budget).run();
}

}  // namespace teracell::mesher
