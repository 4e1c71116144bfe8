// Facets on disk: what is put into bins comes back, and lies where the rays need it.
#include "mesher/tiles/bins.hpp"

#include <malloc.h>
#include <unistd.h>

#include <map>

#include "store/base/error.hpp"
#include "tests/mesher/tiles/tile_grids.hpp"
#include "tests/support/disk.hpp"
#include "tests/support/meshed.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

Facet unmoved(const Facet& f, uint32_t) { return f; }
// Takes facets of odd layers elsewhere. Rounds nothing in tests that compare bits: both sides move once.
Facet moved_if_odd(Facet f, uint32_t layer) {
  if (layer % 2 != 0)
    for (Vec3& v : f.vertex) std::swap(v[0], v[1]), v[2] += 1;
  return f;
}

struct Added {
  Facet facet;
  uint32_t layer;  // a number of its own, so that it is known again
  FacetBins::Origin origin = FacetBins::kOfFile;
  bool ignored = false;
};

std::vector<Added> numbered(const std::vector<Facet>& facets) {
  std::vector<Added> out;
  for (const Facet& f : facets) out.push_back({f, static_cast<uint32_t>(out.size())});
  return out;
}

struct Filling {
  uint64_t budget = 1, expected = 0;  // so bins are as small as can be, and all but one are split later
  bool float32 = false, own_writer = false;
  FacetBins::Move move = unmoved;
};

std::unique_ptr<FacetBins> filled(const Metadata& meta, const std::vector<Added>& facets, const TempFolder& folder, const Filling& how = {}) {
  auto out = std::make_unique<FacetBins>(meta, how.expected, how.expected, how.float32, Budget{how.budget, folder.path()}, how.own_writer, how.move,
                                         std::vector<uint8_t>{});
  FacetBins::Ready ready;
  for (const Added& f : facets) out->make_ready({&f.facet, 1}, f.layer | (f.ignored ? kIgnored : 0), f.origin, 0, ready);
  out->add(ready);
  out->finish();
  return out;
}

// Calls f with the bins that lie in the grid.
template <class F>
void for_each_bin(const Metadata& meta, const FacetBins& bins, F&& f) {
  const GridRays rays(meta);
  std::vector<TreePlace> places = {rays.root()};
  while (!places.empty()) {
    const TreePlace at = places.back();
    places.pop_back();
    if (!bins.is_split(at)) {
      f(at);
      continue;
    }
    for (uint32_t k = 0; k < 16; ++k) {
      const TreePlace child{at.depth - 1, at.cu * 4 + k % 4, at.cv * 4 + k / 4};
      if (child.cu * rays.size(child.depth) < rays.shape.nu && child.cv * rays.size(child.depth) < rays.shape.nv) places.push_back(child);
    }
  }
}

struct Taken {
  TreePlace place;
  struct {
    Facet facet, placed;
    RayRange rays;
    uint32_t layer, bins;
    bool at_home, leads, added, ignored;
  } facet;
};

std::vector<Taken> take_all(const Metadata& meta, FacetBins& bins, bool parts = false) {
  std::vector<Taken> out;
  for_each_bin(meta, bins, [&](const TreePlace& place) {
    const size_t before = out.size();
    bins.take(place, [&](const BinnedFacets& some) {
      for (size_t i = 0; i < some.facets.size(); ++i) {
        const BinnedFacets::One& f = some.facets[i];
        out.push_back({place, {some.in_file(f), some.placed(i), f.rays, some.layer, f.bins, f.at_home, f.leads, some.added, some.ignored}});
      }
    });
    if (!parts) REQUIRE(out.size() - before == bins.facets(place));
  });
  return out;
}

bool same_bits(const Facet& a, const Facet& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

// By layer: in which bins each facet was found.
std::vector<std::vector<Taken>> by_facet(const std::vector<Taken>& taken, size_t facets) {
  std::vector<std::vector<Taken>> out(facets);
  for (const Taken& t : taken) out.at(t.facet.layer).push_back(t);
  return out;
}

// What must hold of all bins, however they came about. `found`: what was taken from them, with numbers of facets for layers.
void expect_taken(const Metadata& meta, const std::vector<Added>& facets, const FacetBins& bins, const std::vector<Taken>& found,
                  const FacetBins::Move& move) {
  const GridRays rays(meta);
  std::vector<TreePlace> places;
  for_each_bin(meta, bins, [&](const TreePlace& place) { places.push_back(place); });
  const auto taken = by_facet(found, facets.size());
  for (size_t i = 0; i < facets.size(); ++i) {
    const Added& added = facets[i];
    const Facet where = added.origin == FacetBins::kPlaced ? added.facet : move(added.facet, added.layer);
    int homes = 0;
    for (const Taken& t : taken[i]) {
      REQUIRE(same_bits(t.facet.facet, added.facet));
      REQUIRE(same_bits(t.facet.placed, where));
      REQUIRE(t.facet.added == (added.origin != FacetBins::kOfFile));
      REQUIRE(t.facet.ignored == added.ignored);
      REQUIRE((t.facet.at_home ? t.facet.bins == taken[i].size() : t.facet.bins > 1 && taken[i].size() > 1));
      const uint64_t side = rays.size(t.place.depth);
      const auto lies_along = [&](uint32_t first, uint32_t last, uint32_t count, uint64_t at) {  // in rays, the last one included
        return std::min(first, count - 1) < (at + 1) * side && std::min(last, count - 1) >= at * side;
      };
      const RayRange lies = rays.range_of(where, 0);
      REQUIRE((lies_along(lies.u0, lies.u1, rays.shape.nu, t.place.cu) && lies_along(lies.v0, lies.v1, rays.shape.nv, t.place.cv)));
      const RayRange expected = added.ignored ? RayRange{} : rays.range_of(where, 0);
      REQUIRE((t.facet.rays.u0 == expected.u0 && t.facet.rays.u1 == expected.u1 && t.facet.rays.v0 == expected.v0 && t.facet.rays.v1 == expected.v1));
      homes += t.facet.at_home;
    }
    REQUIRE(homes == 1);
    std::map<std::pair<uint64_t, uint64_t>, int> leading;  // by group, in which the facet has one or several bins
    for (const Taken& t : taken[i]) {
      if (t.place.depth < 0)
        leading[{t.place.cu * rays.size(t.place.depth) / rays.size(0), t.place.cv * rays.size(t.place.depth) / rays.size(0)}] += t.facet.leads;
      else REQUIRE(t.facet.leads);
    }
    for (const auto& [group, bins_that_lead] : leading) REQUIRE(bins_that_lead == 1);
    // In each bin with a ray that it meets it lies once, in any other not twice.
    const RayRange met = exact_range(meta, where);
    for (const TreePlace& place : places) {
      const uint64_t size = rays.size(place.depth), u = place.cu * size, v = place.cv * size;
      const auto times = std::ranges::count_if(
          taken[i], [&](const Taken& t) { return t.place.depth == place.depth && t.place.cu == place.cu && t.place.cv == place.cv; });
      REQUIRE(times <= 1);
      if (met.u0 < u + size && met.u1 > u && met.v0 < v + size && met.v1 > v && !met.empty()) REQUIRE(times == 1);
    }
  }
}

void expect_bins(const Metadata& meta, const std::vector<Added>& facets, FacetBins& bins, const FacetBins::Move& move) {
  const std::vector<Taken> taken = take_all(meta, bins);
  expect_taken(meta, facets, bins, taken, move);
}

TEST_CASE("Facets come back bit for bit from every bin with a ray that they meet, and are at home in one, whatever the budget", "[threads]") {
  const TempFolder folder;
  std::mt19937_64 random(1);
  for (const Metadata& meta : tile_grids()) {
    std::vector<Added> facets = numbered(facets_over(random, meta, 1100));
    for (Added& f : facets) {
      f.origin = f.layer % 7 == 0 ? FacetBins::kAdded : f.layer % 11 == 0 ? FacetBins::kPlaced : FacetBins::kOfFile;
      f.ignored = f.layer % 13 == 0;
    }
    for (const Filling& how :
         {Filling{}, Filling{1, facets.size(), false, true}, Filling{1 << 20, 100 * facets.size()}, Filling{uint64_t{1} << 40, facets.size()}}) {
      for (const auto& move : {FacetBins::Move(unmoved), FacetBins::Move(moved_if_odd)}) {
        Filling filling = how;
        filling.move = move;
        CAPTURE(how.budget, how.expected);
        expect_bins(meta, facets, *filled(meta, facets, folder, filling), move);
        if (how.budget != 1) break;
      }
    }
  }
}

// Facets far smaller than a cell.
std::vector<Facet> dense_facets(std::mt19937_64& random, const Vec3& lo, const Vec3& hi, size_t count) {
  std::vector<Facet> out(count);
  for (Facet& f : out)
    for (int d = 0; d < 3; ++d) {
      const double at = random_in(random, lo[d], hi[d]);
      for (Vec3& v : f.vertex) v[d] = at + random_in(random, 0, 0.2);
    }
  return out;
}
std::vector<Facet> large_facets(std::mt19937_64& random, const Vec3& lo, const Vec3& hi, size_t count) {
  std::vector<Facet> out(count);
  for (Facet& f : out)
    for (Vec3& v : f.vertex)
      for (int d = 0; d < 3; ++d) v[d] = random_in(random, lo[d], hi[d]);
  return out;
}

// Each facet by its coordinates, which are its own.
using Numbers = std::map<std::array<double, 9>, uint32_t>;
std::array<double, 9> key_of(const Facet& f) { return std::bit_cast<std::array<double, 9>>(f); }

TEST_CASE("Facets that come as blocks lie in the bins in which they would lie one by one, also where a bin is split or they are moved") {
  const TempFolder folder;
  std::mt19937_64 random(7);
  const bool float32 = GENERATE(true, false), moves = GENERATE(false, true);
  for (const Metadata& meta : tile_grids()) {
    constexpr uint32_t kLayer = 9;  // of body 4: odd, so it is moved
    std::vector<Facet> all = facets_over(random, meta, 500);
    for (int i = 0; i < 3; ++i) {  // facets that come together mostly lie near each other
      Vec3 lo, hi;
      for (int d = 0; d < 3; ++d) {
        const double width = (meta.grid.axis[d].max() - meta.grid.axis[d].min()) / 9;
        lo[d] = random_in(random, meta.grid.axis[d].min(), meta.grid.axis[d].max() - width), hi[d] = lo[d] + width;
      }
      std::ranges::copy(dense_facets(random, lo, hi, 600), std::back_inserter(all));
    }
    if (float32)
      for (Facet& f : all)
        for (Vec3& vertex : f.vertex)
          for (double& x : vertex) x = static_cast<float>(x);
    Numbers numbers;
    std::vector<Facet> facets;
    std::vector<Added> added;
    for (const Facet& f : all)
      if (numbers.try_emplace(key_of(f), static_cast<uint32_t>(facets.size())).second) facets.push_back(f), added.push_back({f, kLayer});
    const FacetBins::Move move = moves ? moved_if_odd : FacetBins::Move();
    for (const auto& [budget, expected] : {std::pair<uint64_t, uint64_t>(1, 0), {1, facets.size()}, {uint64_t{1} << 40, facets.size()}})
      for (const bool single : {float32, false}) {  // bins may have double precision for another body's sake
        FacetBins bins(meta, expected, expected, single, Budget{budget, folder.path()}, false, move, {});
        UnfilledVector<uint8_t> blocks;
        const auto welder = std::make_unique<FacetWelder>();
        for (size_t first = 0, count; first < facets.size(); first += count) {
          count = std::min<size_t>(1 + random() % FacetWelder::kMost, facets.size() - first);
          welder->weld(std::span<const Facet>(facets).subspan(first, count));
          welder->append_to(blocks, float32);
        }
        FacetBins::Ready ready;
        bins.make_ready(blocks, float32, kLayer, 0, ready);
        bins.add(ready);
        bins.finish();
        std::vector<Taken> taken = take_all(meta, bins);
        for (Taken& t : taken) {
          REQUIRE(t.facet.layer == kLayer);
          t.facet.layer = numbers.at(key_of(t.facet.facet));
        }
        CAPTURE(budget, expected, single);
        expect_taken(meta, added, bins, taken, moves ? move : unmoved);
      }
  }
}

TEST_CASE("A part lies in bins as its facets do, whether it is small or spread over the grid, beside facets of their own") {
  const TempFolder folder;
  std::mt19937_64 random(5);
  const auto [budget, move] = GENERATE(table<uint64_t, FacetBins::Move>({{1, unmoved}, {1, moved_if_odd}, {uint64_t{1} << 40, unmoved}}));
  std::vector<Metadata> grids = tile_grids();
  const Axis wide = Axis::uniform(0, 1, 0, 256, 0.5);
  grids.push_back(tile_grid(2, wide, wide, wide, 4));
  for (const Metadata& meta : grids) {
    const bool across = &meta == &grids.back();  // parts of small facets lie across borders of large bins
    constexpr uint32_t kParts = 60, kFacets = 40;
    std::vector<Added> facets;
    std::map<std::string, uint32_t> numbers;  // by the bits of the facet
    for (uint32_t part = 0; part < kParts; ++part)
      for (Facet& f : across ? dense_facets(random, {100, 70, 100}, {150, 120, 150}, kFacets) : facets_over(random, meta, kFacets)) {
        facets.push_back({part % 3 == 0 || facets.size() % kFacets == 0 || across ? f : facets.back().facet, part});
        if (part % 3 != 0)
          for (Vec3& v : facets.back().facet.vertex) v[facets.size() % 3] += 0.01 * static_cast<double>(1 + facets.size() % 7);
        const Facet& added = facets.back().facet;
        numbers.emplace(std::string(reinterpret_cast<const char*>(&added), sizeof added), static_cast<uint32_t>(facets.size() - 1));
      }
    REQUIRE(numbers.size() == facets.size());
    FacetBins bins(meta, facets.size(), 0, false, Budget{budget, folder.path()}, false, move, {});
    for (uint32_t part = 0; part < kParts; ++part) {
      const std::span<const Added> of_part(facets.data() + part * kFacets, kFacets);
      BinnedPart whole{kFacets, {HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, part, 0, [of_part](const auto& f) {
                         for (const Added& added : of_part) f(added.facet);
                       }};
      FacetBins::Ready ready;
      for (const Added& added : of_part) {
        if (part % 5 == 0) bins.make_ready({&added.facet, 1}, part, FacetBins::kOfFile, 0, ready);
        for (const Vec3& v : move(added.facet, part).vertex)
          for (size_t d = 0; d < 3; ++d) whole.lo[d] = std::min(whole.lo[d], v[d]), whole.hi[d] = std::max(whole.hi[d], v[d]);
      }
      bins.add(ready);
      if (part % 5 != 0) bins.add(whole);
    }
    bins.finish();
    std::vector<Taken> taken = take_all(meta, bins, true);
    for (Taken& t : taken) {
      REQUIRE(facets[numbers.at(std::string(reinterpret_cast<const char*>(&t.facet.facet), sizeof(Facet)))].layer == t.facet.layer);
      t.facet.layer = numbers.at(std::string(reinterpret_cast<const char*>(&t.facet.facet), sizeof(Facet)));
    }
    expect_taken(meta, facets, bins, taken, move);
  }
}

TEST_CASE("A bin with more facets than are loaded at once is split, as far as the tree goes") {
  const TempFolder folder;
  const Axis axis = Axis::uniform(0, 1, 0, 130, 0.5);
  const Metadata meta = tile_grid(2, axis, axis, axis, 2);  // groups of 8 x 8 rays, a root of 512 x 512
  const TreePlace root = GridRays(meta).root();
  REQUIRE(root.depth == 3);
  std::vector<Facet> facets(1024, Facet{{Vec3{1, 1, 1}, {3, 1, 1}, {1, 3, 1}}});
  REQUIRE_FALSE(filled(meta, numbered(facets), folder)->is_split(root));
  facets.push_back(facets.back());
  const auto bins = filled(meta, numbered(facets), folder);
  for (int depth = 3; depth > 0; --depth) REQUIRE(bins->is_split({depth, 0, 0}));
  REQUIRE(bins->facets({0, 0, 0}) == facets.size());
  REQUIRE(bins->facets({0, 1, 0}) == 0);
  REQUIRE(bins->facets({2, 3, 3}) == 0);
  REQUIRE(take_all(meta, *bins).size() == facets.size());
}

TEST_CASE("A group of tiles with more facets than are loaded at once has several bins, unless most facets would lie in many of them") {
  const TempFolder folder;
  std::mt19937_64 random(6);
  const auto [rays, chunk] = GENERATE(table<int64_t, uint32_t>({{100, 16}, {70, 12}, {30, 64}, {27, 256}}));
  const Metadata meta = tile_grid(1, Axis::uniform(0, 1, 0, rays, 0.5), Axis::uniform(2, 1, 0, rays / 2, 0.5), Axis::uniform(0, 1, 0, 8, 0), chunk);
  Vec3 lo, hi;
  for (int d = 0; d < 3; ++d) lo[d] = meta.grid.axis[d].min(), hi[d] = meta.grid.axis[d].max();
  for (const uint64_t expected : {uint64_t{0}, uint64_t{20'000}}) {
    std::vector<Facet> all = dense_facets(random, lo, hi, 20'000);
    std::ranges::copy(large_facets(random, lo, hi, 10), std::back_inserter(all));
    const std::vector<Added> facets = numbered(all);
    const auto bins = filled(meta, facets, folder, {.expected = expected});
    uint64_t largest = 0;
    bins->for_each_bin(GridRays(meta).root(), [&](const TreePlace& place) {
      REQUIRE(place.depth < 0);
      largest = std::max(largest, bins->facets(place));
    });
    REQUIRE(largest <= 1024);
    expect_bins(meta, facets, *bins, unmoved);
  }
  const std::vector<Added> large = numbered(large_facets(random, lo, hi, 2000));
  const auto bins = filled(meta, large, folder);
  uint64_t sum = 0;
  bins->for_each_bin(GridRays(meta).root(), [&](const TreePlace& place) { sum += bins->facets(place); });
  REQUIRE(sum < 2 * large.size());
  expect_bins(meta, large, *bins, unmoved);

  // A part is spread over bins, too.
  const std::vector<Facet> of_part = dense_facets(random, lo, hi, 20'000);
  FacetBins parts(meta, of_part.size(), 0, false, Budget{1, folder.path()}, false, unmoved, {});
  parts.add({of_part.size(), lo, hi, 0, 0, [&](const auto& f) { std::ranges::for_each(of_part, f); }});
  FacetBins::Ready ready;
  for (const Facet& f : dense_facets(random, lo, hi, 1500)) parts.make_ready({&f, 1}, 0, FacetBins::kOfFile, 0, ready);
  parts.add(ready);
  parts.finish();
  parts.for_each_bin(GridRays(meta).root(), [&](const TreePlace& place) { REQUIRE(parts.facets(place) <= 1024); });
}

TEST_CASE("Facets that share a vertex share a bin, beside the grid too") {
  const TempFolder folder;
  std::mt19937_64 random(2);
  const Metadata meta = tile_grids()[2];
  std::vector<Facet> facets = facets_over(random, meta, 1200);
  for (size_t i = 1; i < facets.size(); ++i)
    if (i % 2 == 1) facets[i].vertex[i % 3] = facets[i - 1].vertex[random_int(random, 0, 2)];
  const auto bins = filled(meta, numbered(facets), folder);
  const auto taken = by_facet(take_all(meta, *bins), facets.size());
  const auto key = [](const Taken& t) { return std::tuple(t.place.depth, t.place.cu, t.place.cv); };
  for (size_t i = 1; i < facets.size(); i += 2)
    REQUIRE(std::ranges::any_of(taken[i],
                                [&](const Taken& t) { return std::ranges::any_of(taken[i - 1], [&](const Taken& s) { return key(s) == key(t); }); }));
}

TEST_CASE("Facets with the same vertices are at home in the same bin, however they are turned") {
  const TempFolder folder;
  std::mt19937_64 random(3);
  const Metadata meta = tile_grids()[3];
  std::vector<Facet> facets = facets_over(random, meta, 600);
  for (size_t i = 0; i < 600; ++i) {
    facets.push_back(facets[i]);
    std::ranges::shuffle(facets.back().vertex, random);
  }
  const auto bins = filled(meta, numbered(facets), folder);
  std::vector<TreePlace> home(facets.size());
  for (const Taken& t : take_all(meta, *bins))
    if (t.facet.at_home) home[t.facet.layer] = t.place;
  for (size_t i = 0; i < 600; ++i)
    REQUIRE((home[i].depth == home[i + 600].depth && home[i].cu == home[i + 600].cu && home[i].cv == home[i + 600].cv));
}

TEST_CASE("Single precision takes half the room, and gives back coordinates that are single ones") {
  const TempFolder folder;
  std::mt19937_64 random(4);
  const Metadata meta = tile_grids()[1];
  std::vector<Facet> facets = facets_over(random, meta, 1000);
  for (Facet& f : facets)
    for (Vec3& v : f.vertex)
      for (double& x : v) x = static_cast<float>(x);
  Filling how{.expected = facets.size(), .float32 = true};
  const auto bins = filled(meta, numbered(facets), folder, how), doubles = filled(meta, numbered(facets), folder, {.expected = facets.size()});
  REQUIRE(bins->bytes() < doubles->bytes() * 2 / 3);
  expect_bins(meta, numbered(facets), *bins, unmoved);
}

TEST_CASE("A byte of the temporary file that changed, or is gone, is an error and no facet") {
  const TempFolder folder;
  std::mt19937_64 random(7);
  const Metadata meta = tile_grids()[0];
  const std::vector<Added> facets = numbered(facets_over(random, meta, 100));
  constexpr uint64_t budget = 10'000;  // so little that they don't stay in memory
  const auto fill = [&] { return filled(meta, facets, folder, {.budget = budget, .expected = facets.size()}); };
  const auto bytes = static_cast<off_t>(fill()->bytes());
  REQUIRE(bytes > 100 * 72);  // facets that share no vertices
  for (const off_t at : {off_t{0}, off_t{71}, off_t{72}, off_t{5000}, bytes - 1}) {
    const auto bins = fill();
    REQUIRE(!bins->in_memory());
    const int fd = temporary_file(folder);
    uint8_t byte;
    REQUIRE(::pread(fd, &byte, 1, at) == 1);
    byte ^= 1;
    REQUIRE(::pwrite(fd, &byte, 1, at) == 1);
    REQUIRE_THROWS_AS(take_all(meta, *bins), IoError);
  }
  const auto bins = fill();
  REQUIRE(::ftruncate(temporary_file(folder), bytes - 1) == 0);
  REQUIRE_THROWS_AS(take_all(meta, *bins), IoError);
}

TEST_CASE("Bins that are full hold no memory for their facets, however many they are") {
  const TempFolder folder;
  const Axis axis = Axis::uniform(0, 1, 0, 512, 0.5);
  const Metadata meta = tile_grid(2, axis, axis, axis, 2);
  std::vector<Facet> facets;
  for (double y = 1; y < 511; y += 1.5)
    for (double x = 1; x < 511; x += 1.5) facets.push_back({{Vec3{x, y, 1}, {x + 0.5, y, 1}, {x, y + 0.5, 1}}});
  const auto in_use = [] {
    const struct mallinfo2 all = ::mallinfo2();
    return static_cast<int64_t>(all.uordblks + all.hblkhd);
  };
  const std::vector<Added> added = numbered(facets);
  const int64_t before = in_use();
  const auto bins = filled(meta, added, folder, {.expected = added.size() / 64});  // so most bins are split when all others are full
  const int64_t after = in_use();
  REQUIRE(!bins->in_memory());
  int64_t count = 0;
  for_each_bin(meta, *bins, [&](const TreePlace& at) { count += bins->facets(at) > 0 ? 1 : 0; });
  REQUIRE(count >= 256);
  CHECK(after - before < count * 1024);  // buffers take 4096 bytes each at least
}

TEST_CASE("No facets are a bin without facets, and need no room") {
  const TempFolder folder;
  for (const Metadata& meta : tile_grids()) {
    const auto bins = filled(meta, {}, folder);
    REQUIRE(take_all(meta, *bins).empty());
    REQUIRE(bins->bytes() == 0);
  }
}

TEST_CASE("A facet goes into the one bin of a grid whose rays need as many bits as a number has") {
  const Metadata meta = tile_grid(2, Axis::uniform(0, 1, 0, 2'000'000'000, 0.5), Axis::uniform(0, 1, 0, 4, 0.5), Axis::uniform(0, 1, 0, 4, 0.5), 64);
  const TempFolder folder;
  const auto bins = filled(meta, numbered({Facet{{Vec3{1000.2, 0.2, 1}, Vec3{1009, 1.2, 2}, Vec3{1005, 3.9, 3}}}}), folder);
  CHECK(bins->facets(GridRays(meta).root()) == 1);
}

TEST_CASE("A group is split if most of its facets are small, in whatever order they come") {
  const Metadata meta = tile_grid(2, Axis::uniform(0, 1, 0, 256, 0.5), Axis::uniform(0, 1, 0, 256, 0.5), Axis::uniform(0, 1, 0, 9, 0.5), 64);
  for (const bool mostly_small : {false, true}) {
    std::mt19937_64 random(1);
    std::vector<Facet> facets;
    for (int i = 0; i < 4000; ++i) {
      const bool small = mostly_small ? i % 32 != 0 : i % 8 == 0;
      const double size = small ? 1 : 200, u = small ? random_in(random, 0, 256) : 128, v = small ? random_in(random, 0, 256) : 128;
      Facet& f = facets.emplace_back();
      for (Vec3& p : f.vertex) p = {u + random_in(random, -size, size), v + random_in(random, -size, size), random_in(random, 0, 9)};
    }
    for (const bool shuffled : {false, true}) {
      if (shuffled) std::ranges::shuffle(facets, random);
      const TempFolder folder;
      CHECK(filled(meta, numbered(facets), folder)->is_split({0, 0, 0}) == mostly_small);
    }
  }
}

}  // namespace
}  // namespace teracell::mesher
