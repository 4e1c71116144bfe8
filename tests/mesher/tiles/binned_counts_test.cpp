// The counts of surfaces that are looked at bin by bin, against maps and union-find over all their facets.
#include "mesher/tiles/binned_counts.hpp"

#include <map>

#include "mesher/closing/closing.hpp"
#include "tests/mesher/tiles/tile_grids.hpp"
#include "tests/support/counted.hpp"
#include "tests/support/meshed.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

struct Binned {
  Facet facet;
  uint32_t layer;
  bool at_home;
  uint32_t bins;
};

// Where a facet lies by the rule of bins: in each bin with a place of a vertex; at home where its least vertex is.
struct Bins {
  int bins;
  double width;  // along x
  int bin_of(const Vec3& v) const { return std::clamp(static_cast<int>(v[0] / width), 0, bins - 1); }

  template <class F>
  void for_each(const Facet& f, F&& call) const {
    const auto [lo, hi] = std::minmax({bin_of(f.vertex[0]), bin_of(f.vertex[1]), bin_of(f.vertex[2])});
    const int home = bin_of(std::min({f.vertex[0], f.vertex[1], f.vertex[2]}));
    for (int bin = lo; bin <= hi; ++bin) call(bin, Binned{f, 0, bin == home, static_cast<uint32_t>(hi - lo + 1)});
  }
};

Counted as_counted(const SurfaceCounts& t) { return {t.degenerate, t.duplicates, t.opposite, t.shells}; }

// Adds facets of a bin as blocks, each of facets that come one after another, with some equal vertices twice. Those of one layer come together.
void add_as_blocks(std::span<const Binned> facets, std::mt19937_64& random, BinnedCounter::Bin& bin) {
  const bool alone = random() % 2 == 0;  // each block has facets of one layer
  for (uint32_t block = 1; !facets.empty(); ++block) {
    size_t count = std::min<size_t>(facets.size(), 1 + random() % 200);
    const auto same_layer = [&](size_t from) {
      size_t to = from;
      while (to < count && facets[to].layer == facets[from].layer) ++to;
      return to;
    };
    if (alone) count = same_layer(0);
    std::vector<Vec3> vertices;
    std::vector<BinnedFacets::One> ones;
    std::map<Vec3, uint32_t> numbers;
    for (const Binned& f : facets.first(count)) {
      BinnedFacets::One& one = ones.emplace_back();
      one.bins = f.bins, one.at_home = f.at_home;
      for (int i = 0; i < 3; ++i) {
        const auto next = static_cast<uint32_t>(vertices.size());
        const auto [known, is_new] = numbers.try_emplace(f.facet.vertex[i], next);
        if (!is_new && random() % 8 == 0) known->second = next;
        one.vertices[i] = known->second;
        if (known->second == next) vertices.push_back(f.facet.vertex[i]);
      }
    }
    for (size_t from = 0; from < count;) {
      const size_t to = same_layer(from), here = std::min<size_t>(to - from, 1 + random() % 100);
      BinnedFacets some;
      some.facets = std::span(ones).subspan(from, here);
      some.vertices = vertices;
      some.block = block, some.of_block = same_layer(0) == count, some.layer = facets[from].layer;
      bin.add(some);
      from += here;
    }
    facets = facets.subspan(count);
  }
}

// Facets of different bodies come in turn, those of each in their order, by which the first of equal ones is known.
void mix_bodies(std::vector<Binned>& facets, std::mt19937_64& random) {
  std::map<uint32_t, std::vector<Binned>> by_body;
  std::vector<uint32_t> turns;
  for (const Binned& f : facets) by_body[body_of_layer(f.layer)].push_back(f), turns.push_back(body_of_layer(f.layer));
  std::ranges::shuffle(turns, random);
  std::map<uint32_t, size_t> taken;
  for (size_t i = 0; i < turns.size(); ++i) facets[i] = by_body[turns[i]][taken[turns[i]]++];
}

// Of each body, from bins that are finished in a random order.
std::vector<Counted> by_bins(const std::vector<std::vector<Facet>>& bodies, const Bins& bins, std::mt19937_64& random) {
  std::vector<std::vector<Binned>> content(bins.bins);
  for (uint32_t b = 0; b < bodies.size(); ++b)
    for (const Facet& f : bodies[b])
      bins.for_each(f, [&](int bin, Binned binned) {
        binned.layer = layer_of(b, bin % 2 == 0);
        content[bin].push_back(binned);
      });
  for (std::vector<Binned>& facets : content) mix_bodies(facets, random);
  std::ranges::shuffle(content, random);
  BinnedCounter survey(std::vector<bool>(bodies.size(), true));
  for (const auto& facets : content) {
    BinnedCounter::Bin bin(survey, facets.size());
    add_as_blocks(facets, random, bin);
    bin.finish();
  }
  REQUIRE(survey.waiting() == 0);
  std::vector<Counted> out;
  for (const SurfaceCounts& t : survey.totals()) out.push_back(as_counted(t));
  return out;
}

TEST_CASE("Counts by bins are those of the whole surface, however many bins there are and whatever their order") {
  std::mt19937_64 random(1);
  for (const int size : {3, 40, 600})
    for (const int bins : {1, 2, 7, 50}) {
      const std::vector<Facet> facets = tangle(random, 800, size);
      CAPTURE(size, bins);
      REQUIRE(by_bins({facets}, {bins, static_cast<double>(size) / bins}, random) == std::vector{counted(facets)});
    }
}

TEST_CASE("Bodies are counted apart though they share vertices and bins") {
  std::mt19937_64 random(2);
  const std::vector<Facet> one = tangle(random, 300, 30), two = tangle(random, 500, 30);
  REQUIRE(by_bins({one, two, {}, one}, {6, 5}, random) == std::vector<Counted>{counted(one), counted(two), {}, counted(one)});
}

TEST_CASE("A shell through all bins is one, in whatever order its parts are found to hang together") {
  std::mt19937_64 random(3);
  std::vector<Facet> facets;  // five chains side by side
  for (int c = 0; c < 5; ++c)
    for (int i = 0; i < 60; ++i) facets.push_back({{Vec3{double(i), double(2 * c), 0}, {double(i + 1), double(2 * c), 0}, {i + 0.5, 2 * c + 1., 0}}});
  for (int order = 0; order < 5; ++order) {
    REQUIRE(by_bins({facets}, {20, 3}, random)[0].shells == 5);
    std::ranges::shuffle(facets, random);
  }
  facets.push_back({{Vec3{60, 0, 0}, {60, 2, 0}, {61, 8, 0}}});  // joins two of them at their ends
  REQUIRE(by_bins({facets}, {20, 3}, random)[0].shells == 4);
}

// Counts one facet twice, the second time as `change` makes it.
Counted counted_twice(const std::function<void(BinnedFacets&)>& change) {
  BinnedCounter survey({true});
  BinnedCounter::Bin bin(survey, 2);
  const std::vector<Vec3> vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<BinnedFacets::One> facet = {{.vertices = {0, 1, 2}}};
  BinnedFacets some;
  some.facets = facet, some.vertices = vertices, some.block = 1;
  bin.add(some);
  change(some);
  bin.add(some);
  bin.finish();
  return as_counted(survey.totals()[0]);
}

TEST_CASE("Facets that close a hole are no facets of the file's") {
  REQUIRE(counted_twice([](BinnedFacets& f) { f.added = true; }) == Counted{0, 0, 0, 1});
}

TEST_CASE("A facet that counts for nothing among the crossings is counted all the same") {
  REQUIRE(counted_twice([](BinnedFacets& f) { f.ignored = true; }) == Counted{0, 1, 0, 1});
}

TEST_CASE("Counts by the bins of a grid, of which many facets see no ray, are those of the whole surface") {
  const TempFolder folder;
  std::mt19937_64 random(4);
  const Axis axis = Axis::uniform(3, 0.25, 0, 150, 0.5);  // over a part of the surface
  const Metadata meta = tile_grid(2, axis, axis, axis, 2);
  const std::vector<Facet> facets = tangle(random, 1500, 60);
  FacetBins bins(meta, 0, 0, false, {1, folder.path()}, false, [](const Facet& f, uint32_t) { return f; }, {});
  FacetBins::Ready ready;
  bins.make_ready(facets, 0, FacetBins::kOfFile, 0, ready);
  bins.add(ready);
  bins.finish();
  BinnedCounter survey({true});
  std::vector<TreePlace> places = {GridRays(meta).root()};
  int leaves = 0;
  while (!places.empty()) {
    const TreePlace at = places.back();
    places.pop_back();
    if (bins.is_split(at)) {
      for (uint32_t k = 0; k < 16; ++k) places.push_back({at.depth - 1, at.cu * 4 + k % 4, at.cv * 4 + k / 4});
      continue;
    }
    BinnedCounter::Bin bin(survey, bins.facets(at));
    bins.take(at, [&](const BinnedFacets& some) { bin.add(some); });
    bin.finish();
    ++leaves;
  }
  REQUIRE(leaves > 1);
  REQUIRE(as_counted(survey.totals()[0]) == counted(facets));
}

}  // namespace
}  // namespace teracell::mesher
