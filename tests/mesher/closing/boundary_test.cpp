// Closed or not, and where not: the proof by hashes against edges counted in a map.
#include "mesher/closing/boundary.hpp"

#include "store/base/error.hpp"
#include "tests/support/every_way.hpp"
#include "tests/support/shapes.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;
using shapes::Facets;

struct Uses {
  int64_t net = 0;  // from the lesser vertex to the greater one, less those the other way
  uint64_t all = 0;
};
using CountedEdges = std::map<std::pair<Vec3, Vec3>, Uses>;

CountedEdges count_edges(const Facets& facets) {
  CountedEdges out;
  for (const Facet& f : facets)
    for (int i = 0; i < 3; ++i) {
      const Vec3 &a = f.vertex[i], &b = f.vertex[(i + 1) % 3];
      if (a == b) continue;
      Uses& uses = out[std::minmax(a, b)];
      uses.net += a < b ? 1 : -1;
      ++uses.all;
    }
  return out;
}

// Some facets are added one by one, and others together, on any vector unit; those of the second half to a proof of their own.
BoundaryProof proof_of(const Facets& facets) {
  std::array<BoundaryProof, 2> halves;
  std::vector<std::array<VertexHash, 3>> together;
  std::mt19937_64 random(facets.size());
  for (size_t i = 0; i < facets.size(); ++i) {
    if (random() % 5 == 0) halves[2 * i / facets.size()].add(vertex_hashes(facets[i]));
    else together.push_back(vertex_hashes(facets[i]));
    if (random() % 50 != 0 && i + 1 != facets.size()) continue;
    const OnVectorUnit on(static_cast<VectorUnit>(random() % 3));
    halves[2 * i / facets.size()].add(std::exchange(together, {}));
  }
  halves[0].add(halves[1]);
  return halves[0];
}

// As the proof says it must be.
void expect_proof(const Facets& facets) {
  bool directed = true, undirected = true;
  for (const auto& [edge, uses] : count_edges(facets)) {
    directed &= uses.net == 0;
    undirected &= uses.all % 2 == 0;
  }
  const BoundaryProof proof = proof_of(facets);
  REQUIRE(proof.directed_boundary_is_empty() == directed);
  REQUIRE(proof.undirected_boundary_is_empty() == undirected);
}

std::vector<BoundaryEdge> edges_of(const Facets& facets, uint64_t memory, int* passes = nullptr) {
  const FacetPass pass = [&](const auto& f) {
    if (passes) ++*passes;
    for (const Facet& facet : facets) f(facet);
  };
  return boundary_edges(pass, memory, "surface.stl");
}

void expect_edges(const std::vector<BoundaryEdge>& found, const Facets& facets) {
  CountedEdges expected = count_edges(facets);
  std::erase_if(expected, [](const auto& e) { return e.second.net == 0; });
  REQUIRE(found.size() == expected.size());
  auto next = expected.begin();  // ascending by the lesser vertex, then the greater one
  for (const BoundaryEdge& e : found) {
    const auto& [edge, uses] = *next++;
    REQUIRE(std::pair(e.from, e.to) == (uses.net > 0 ? edge : std::pair(edge.second, edge.first)));
    REQUIRE(e.net == static_cast<uint64_t>(std::abs(uses.net)));
    REQUIRE(e.uses == uses.all);
    REQUIRE(e.odd() == (uses.all % 2 != 0));
  }
}

Facets shuffled(Facets facets, uint64_t seed) {
  std::mt19937_64 random(seed);
  std::ranges::shuffle(facets, random);
  return facets;
}

TEST_CASE("A closed surface has no boundary of either kind, in any order of its facets, moved and inside out too") {
  const Facets sphere = shapes::sphere({0.1, 0.2, 0.3}, 1, 3);
  for (const Facets& facets :
       {sphere, shapes::flip(sphere), shuffled(sphere, 1), shapes::join({sphere, sphere}), shapes::box({0, 0, 0}, {1, 2, 3})}) {
    REQUIRE(proof_of(facets).directed_boundary_is_empty());
    REQUIRE(proof_of(facets).undirected_boundary_is_empty());
    REQUIRE(edges_of(facets, 1 << 20).empty());
  }
}

TEST_CASE("A missing facet opens both boundaries, a flipped one only the directed one, one given twice the undirected one too") {
  const Facets closed = shapes::sphere({0, 0, 0}, 1, 2);
  for (size_t i = 0; i < closed.size(); i += 7) {
    Facets missing = closed, flipped = closed, twice = closed;
    missing.erase(missing.begin() + static_cast<ptrdiff_t>(i));
    flipped[i] = shapes::flip({closed[i]})[0];
    twice.push_back(closed[i]);
    for (const Facets& facets : {missing, twice}) {
      REQUIRE_FALSE(proof_of(facets).directed_boundary_is_empty());
      REQUIRE_FALSE(proof_of(facets).undirected_boundary_is_empty());
      REQUIRE(edges_of(facets, 1 << 20).size() == 3);
    }
    REQUIRE_FALSE(proof_of(flipped).directed_boundary_is_empty());
    REQUIRE(proof_of(flipped).undirected_boundary_is_empty());
    for (const BoundaryEdge& e : edges_of(flipped, 1 << 20)) REQUIRE((e.net == 2 && e.uses == 2 && !e.odd()));
    expect_proof(missing), expect_proof(flipped), expect_proof(twice);
  }
}

// Facets between few points, cones joined to their edges in part, and facets without area.
Facets half_closed(std::mt19937_64& random) {
  std::vector<Vec3> points(6);
  for (Vec3& v : points) v = {double(random_int(random, 0, 4)), double(random_int(random, 0, 4)), double(random_int(random, 0, 4))};
  const auto any = [&] { return points[random_int(random, 0, 5)]; };
  Facets out;
  for (int i = random_int(random, 1, 12); i > 0; --i) {
    const Facet f{{any(), any(), any()}};
    out.push_back(f);
    if (random_int(random, 0, 2) == 0) continue;
    const Vec3 apex = any();
    for (int k = 0; k < 3; ++k) out.push_back({{f.vertex[(k + 1) % 3], f.vertex[k], apex}});
  }
  return out;
}

TEST_CASE("The proof and the edges are those of counting, whatever the order of the facets and the way round of each") {
  std::mt19937_64 random(2);
  int closed = 0, only_undirected = 0;
  for (size_t round = 0; round < rounds(300); ++round) {
    Facets facets = half_closed(random);
    if (round % 4 == 1) facets[0] = shapes::flip({facets[0]})[0];
    expect_proof(facets);
    closed += proof_of(facets).directed_boundary_is_empty();
    only_undirected += proof_of(facets).undirected_boundary_is_empty() && !proof_of(facets).directed_boundary_is_empty();
    if (round % 8 != 0) continue;  // a pass has 65,536 buckets
    expect_edges(edges_of(facets, 1 << 20), facets);
    expect_edges(edges_of(shuffled(facets, round), 1 << 20), facets);
  }
  REQUIRE(closed > 10);
  REQUIRE(only_undirected > (kSanitized ? 0 : 10));
}

TEST_CASE("An edge between equal vertices has no length and no part in the boundary") {
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0};
  const Facets spike = {{{a, b, b}}};  // a -> b and back
  REQUIRE(proof_of(spike).directed_boundary_is_empty());
  REQUIRE(proof_of({{{{a, a, a}}}}).undirected_boundary_is_empty());
  const Facets closed_by_spikes = {{{a, b, c}}, {{b, a, c}}, {{c, c, b}}};
  REQUIRE(proof_of(closed_by_spikes).directed_boundary_is_empty());
  REQUIRE(edges_of(closed_by_spikes, 1 << 20).empty());
}

TEST_CASE("Less memory takes more passes over the facets and finds the same edges") {
  std::mt19937_64 random(3);
  Facets facets;  // one facet in ten has its boundary to itself
  for (int i = 0; i < 40; ++i) {
    const Facets box = shapes::box({double(2 * i), 0, 0}, {2 * i + 1., 1, 1});
    facets.insert(facets.end(), box.begin(), box.end());
  }
  for (size_t i = 0; i < facets.size(); i += 10) facets[i] = facets[(i + 11) % facets.size()];
  int last = 0;
  for (const uint64_t memory : {uint64_t{1} << 30, uint64_t{20000}}) {
    int passes = 0;
    expect_edges(edges_of(facets, memory, &passes), facets);
    REQUIRE(passes > last);
    last = passes;
  }
  REQUIRE_THROWS_AS(edges_of(facets, 1000), InputError);
}

}  // namespace
}  // namespace teracell::mesher
