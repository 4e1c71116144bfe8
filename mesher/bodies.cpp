#include "mesher/bodies.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include <fmt/format.h>

#include "mesher/closure.hpp"
#include "store/error.hpp"

namespace teracell {
namespace {

std::string text(const Vec3& p) { return fmt::format("({}, {}, {})", p[0], p[1], p[2]); }

// What a facet in memory costs: itself, its place among the rays, its numbers in the lists of the tiling, its survey.
constexpr uint64_t kBytesPerFacet = 160, kBytesPerFacetOfShells = 20;

// What closing a surface may take, however small the budget.
constexpr uint64_t kLeastMemory = uint64_t{1} << 24;

// The one pass over the bodies' facets: is one closed, and what box and projections have all where their matrices put them?
struct Study {
  BoundaryProof proof;
  Vec3 lo{HUGE_VAL, HUGE_VAL, HUGE_VAL}, hi{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, area{};

  void take(const Facet& facet, const SceneBody& body, bool moves) {
    proof.add(facet);
    std::array<Vec3, 3> p = facet.vertex;
    for (Vec3& q : p) {
      if (moves) q = moved(q, body);
      for (int d = 0; d < 3; ++d) {
        lo[d] = std::min(lo[d], q[d]);
        hi[d] = std::max(hi[d], q[d]);
      }
    }
    for (int w = 0; w < 3; ++w) {
      const int u = (w + 1) % 3, v = (w + 2) % 3;
      area[w] += std::abs((p[1][u] - p[0][u]) * (p[2][v] - p[0][v]) - (p[1][v] - p[0][v]) * (p[2][u] - p[0][u])) / 2;
    }
  }
};

// What is spilled is read again, so it must be there again.
void expect_files(const Scene& scene, size_t last) {
  for (size_t b = 0; b <= last; ++b)
    if (std::filesystem::is_other(scene.bodies[b].mesh))
      throw InputError(fmt::format("{}: expected a file, as the surfaces don't fit into the memory given and must be read twice; found a pipe or a device: "
                                   "save it as a file, or allow more with --memory",
                                   scene.bodies[b].mesh.string()));
}

// Edges that run the same way in two facets, grouped where they meet.
std::vector<Flip> group_flips(const std::vector<BoundaryEdge>& edges, const Matrix& matrix) {
  std::unordered_map<uint32_t, size_t> group_of;  // by shell number of the edges as a graph
  Survey graph;
  for (const BoundaryEdge& e : edges)
    if (!e.odd()) graph.add({{e.from, e.to, e.to}}, false);
  std::vector<Flip> flips;
  for (const BoundaryEdge& e : edges) {
    if (e.odd()) continue;
    const auto [it, fresh] = group_of.try_emplace(graph.shell_of(e.from), flips.size());
    if (fresh) flips.push_back({transform(matrix, e.from), 0});
    ++flips[it->second].edges;
  }
  return flips;
}

// Of the boundary of the part taken: does any edge belong to other parts of the file?
bool touches_other_parts(const SceneBody& body, const std::array<std::vector<BoundaryEdge>, 2>& edges, const Budget& budget) {
  const auto key = [](const Vec3& a, const Vec3& b) { return std::pair(std::min(a, b), std::max(a, b)); };
  std::vector<std::pair<std::pair<Vec3, Vec3>, uint64_t>> uses;
  for (const auto& list : edges)
    for (const BoundaryEdge& e : list) uses.push_back({key(e.from, e.to), e.uses});
  std::ranges::sort(uses);
  bool found = false;
  std::vector<uint64_t> in_all(uses.size());
  read_facets(body.mesh, "", [&](std::span<const Facet> facets) {
    for (const Facet& f : facets)
      for (int i = 0; i < 3; ++i) {
        const auto edge = key(f.vertex[i], f.vertex[(i + 1) % 3]);
        const auto it = std::ranges::lower_bound(uses, edge, {}, [](const auto& u) { return u.first; });
        if (it != uses.end() && it->first == edge) found |= ++in_all[it - uses.begin()] > it->second;
      }
  }, budget);
  return found;
}

[[noreturn]] void refuse_open(const SceneBody& body, const BodyFacets& found, bool evenodd, const std::vector<BoundaryEdge>& edges) {
  Vec3 lo = edges[0].from, hi = lo;
  for (const BoundaryEdge& e : edges)
    for (const Vec3* p : {&e.from, &e.to})
      for (int d = 0; d < 3; ++d) lo[d] = std::min(lo[d], (*p)[d]), hi[d] = std::max(hi[d], (*p)[d]);
  throw InputError(fmt::format(
      "{}: body '{}' is not closed: expected every edge to be {}, found {} edge{} that {} not, within the box {} to {}; the first runs from {} to {} "
      "(coordinates of the mesh). Close the surface, or let it be closed with closing cap{}{}",
      body.mesh.string(), body.name, evenodd ? "used an even number of times" : "matched by its reverse", edges.size(),
      edges.size() == 1 ? "" : "s", edges.size() == 1 ? "is" : "are", text(lo), text(hi), text(edges[0].from), text(edges[0].to),
      !evenodd && !found.flips.empty() ? "; some facets are oriented the other way round: orient them alike or use fill auto or evenodd" : "",
      found.cut_from_others ? fmt::format("; part '{}' is cut off from parts that were left out", body.part) : ""));
}

// In a shell with a flip parity leaves fewer edges open, in every other one as many: an edge that is used an odd number
// of times is always one that its reverse doesn't match. Moves the edges of the former to the second list, if they bound
// the parity, and their facets to the layer of parity.
void split_by_shell(const SceneBody& body, size_t b, const Budget& budget, Bodies& bodies, BodyFacets& found, std::array<std::vector<BoundaryEdge>, 2>& edges) {
  const uint64_t need = found.file.facets * kBytesPerFacetOfShells;
  if (!bodies.in_memory && need > std::max(budget.bytes / 2, kLeastMemory))
    throw InputError(fmt::format("{}: some facets are oriented the other way round, and telling the shells of so large a surface apart takes {} MB of memory: "
                                 "allow twice that with --memory, or say which fill rule it has",
                                 body.mesh.string(), need / 1000000));
  Survey survey;
  for_each_facet(body, found, bodies, budget, [&](const Facet& f) { survey.add(f, false); });
  std::vector<Vec3> flips;
  for (const BoundaryEdge& e : edges[0])
    if (!e.odd()) flips.push_back(e.from);
  found.shells = std::make_shared<ShellRules>(std::move(survey), flips);
  ShellRules& shells = *found.shells;
  std::erase_if(edges[0], [&](const BoundaryEdge& e) {
    const bool moves = shells.evenodd(e.from);
    if (moves && e.odd()) edges[1].push_back(e);
    return moves;
  });
  if (bodies.in_memory)
    bodies.facets->for_each(found.first, found.first + found.file.facets, [&](SceneFacet& f) { f.layer = layer_of(b, shells.evenodd(f.facet.vertex[0])); });
  found.rules[0].used = shells.evenodd_shells() < shells.shells();
  found.rules[1] = {true, "some facets are oriented the other way round: so fewer edges stay open than by winding number", {}};
}

// Gives every shell its fill rule and closes what is open.
void close_body(const SceneBody& body, size_t b, const BoundaryProof& proof, const Budget& budget, Bodies& bodies, BodyFacets& found) {
  if (body.kind == Kind::kSheet) return;
  const bool evenodd = body.fill == Fill::kEvenodd, automatic = body.fill == Fill::kAuto;
  const bool closed = evenodd ? proof.undirected_boundary_is_empty() : proof.directed_boundary_is_empty();
  found.rules[evenodd] = {true, !automatic ? "asked for" : closed ? "closed: every edge is matched by its reverse" : "facets are oriented alike", {}};
  if (closed) return;

  std::array<std::vector<BoundaryEdge>, 2> edges;  // of shells by winding number, by parity
  edges[0] = boundary_edges([&](const auto& f) { for_each_facet(body, found, bodies, budget, f); },
                            std::max(budget.bytes / 4, kLeastMemory), body.mesh.string());
  if (edges[0].empty()) throw InputError(fmt::format("{}: the file changed while it was read", body.mesh.string()));
  found.flips = group_flips(edges[0], body.matrix);
  if (automatic && !found.flips.empty()) split_by_shell(body, b, budget, bodies, found, edges);
  if (evenodd) {
    std::erase_if(edges[0], [](const BoundaryEdge& e) { return !e.odd(); });
    edges[0].swap(edges[1]);
  }
  found.cut_from_others = !body.part.empty() && touches_other_parts(body, edges, budget);
  for (const bool parity : {false, true}) {
    if (edges[parity].empty()) continue;
    if (body.closing.way == Closing::Way::kStrict) refuse_open(body, found, parity, edges[parity]);
    Caps& caps = found.rules[parity].caps;
    caps = cap_boundary(edges[parity], parity, found.file.float32, body.matrix);
    if (bodies.in_memory) bodies.facets->append_all(caps.facets, layer_of(b, parity));
  }
}

}  // namespace

ShellRules::ShellRules(Survey shells, std::span<const Vec3> vertices) : shells_(std::move(shells)), evenodd_(shells_.vertices()) {
  for (const Vec3& v : vertices) {
    const uint32_t shell = shells_.shell_of(v);
    evenodd_shells_ += !evenodd_[shell];
    evenodd_[shell] = true;
  }
}

uint64_t Bodies::facet_count() const {
  uint64_t count = 0;
  for (const BodyFacets& b : bodies) count += b.file.facets;
  return count;
}

bool Bodies::float32() const {
  return std::ranges::all_of(bodies, [](const BodyFacets& b) { return b.file.float32; });
}

std::vector<SurveyTotals> Bodies::survey_totals() {
  helper->finish_all();
  std::vector<SurveyTotals> out;
  for (Survey& survey : surveys) out.push_back(survey.totals());
  return out;
}

Bodies read_bodies(const Scene& scene, int threads, const Budget& budget, const std::function<void(double)>& tick) {
  Bodies out;
  const auto study = std::make_shared<Study>();  // its jobs may outlive this function, when it throws
  out.helper = std::make_unique<Background>(threads > 1);
  const uint64_t most = budget.bytes / 8 * 5 / kBytesPerFacet;
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    const bool moves = body.matrix != kIdentity;
    const uint32_t layer = layer_of(b, body.fill == Fill::kEvenodd);
    const Study all = std::exchange(*study, {});
    study->area = all.area;
    Survey* const survey = &out.surveys.emplace_back();
    BodyFacets found;
    found.first = out.facets->size();
    found.file = read_facets(body.mesh, body.part, [&](std::span<const Facet> facets) {
      if (out.in_memory && out.facets->size() + facets.size() > most) {
        expect_files(scene, b);
        out.helper->finish();
        out.helper->drop_later();
        out.in_memory = false;
        out.facets = std::make_shared<FacetStore>();
        out.surveys.clear();
      }
      if (out.in_memory) {
        while (!facets.empty()) {
          const std::span<const SceneFacet> stored = out.facets->append(facets, layer);
          facets = facets.subspan(stored.size());
          out.helper->run([study, &body, stored, moves] {
            for (const SceneFacet& f : stored) study->take(f.facet, body, moves);
          });
          out.helper->run_later([survey, stored] {
            for (const SceneFacet& f : stored) survey->add(f.facet);
          });
        }
      } else {
        out.helper->run([study, &body, moves, copy = std::vector<Facet>(facets.begin(), facets.end())] {
          for (const Facet& f : copy) study->take(f, body, moves);
        });
      }
      tick(static_cast<double>(b) / static_cast<double>(scene.bodies.size()));
    }, budget, out.helper.get());
    out.helper->finish();
    found.lo = study->lo, found.hi = study->hi;
    for (int d = 0; d < 3; ++d) study->lo[d] = std::min(study->lo[d], all.lo[d]), study->hi[d] = std::max(study->hi[d], all.hi[d]);
    close_body(body, b, study->proof, budget, out, found);
    out.bodies.push_back(std::move(found));
  }
  out.lo = study->lo;
  out.hi = study->hi;
  out.area = study->area;
  return out;
}

void for_each_facet(const SceneBody& body, const BodyFacets& found, const Bodies& bodies, const Budget& budget,
                    const std::function<void(const Facet&)>& f) {
  if (bodies.in_memory) return bodies.facets->for_each(found.first, found.first + found.file.facets, [&](const SceneFacet& s) { f(s.facet); });
  read_again(body, found, budget, [&](std::span<const Facet> facets) {
    for (const Facet& facet : facets) f(facet);
  });
}

void read_again(const SceneBody& body, const BodyFacets& found, const Budget& budget, const FacetSink& sink) {
  const SurfaceFile file = read_facets(body.mesh, body.part, sink, budget);
  if (file.hash != found.file.hash)
    throw InputError(fmt::format("{}: the file changed while it was meshed: its hash was {} and is {} now", body.mesh.string(), found.file.hash, file.hash));
}

Vec3 moved(const Vec3& p, const SceneBody& body) {
  Vec3 q = transform(body.matrix, p);
  for (double& x : q)
    if (!(std::abs(x) >= 1e-75 && std::abs(x) <= 1e75))  // rare: 0 is fine, and -0 becomes +0
      x = checked_coordinate(x, fmt::format("{}: a vertex after the matrix of body '{}'", body.mesh.string(), body.name));
  return q;
}

}  // namespace teracell
