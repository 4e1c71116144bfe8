// Facets that are read in blocks, on several threads, against those that are read one after another.
#include <atomic>
#include <limits>

#include "store/base/background.hpp"
#include "tests/support/every_way.hpp"
#include "tests/support/random.hpp"
#include "tests/support/surfaces.hpp"

namespace teracell::mesher {
namespace {

// As read() and refusal(), but in blocks on several threads.
struct InBlocks {
  SurfaceFile file;
  surfaces::Facets facets;
  std::string refusal;
};
InBlocks read_in_blocks(const std::string& bytes, int threads) {
  InBlocks out;
  Background helper(threads > 1);
  std::atomic<int> at_work = 0;
  bool entered = false, asked = false;
  const FacetBlocks blocks{.threads = threads,
                           .idle = &helper,
                           .wanted =
                               [&](bool float32) {
                                 CHECK(entered);
                                 CHECK(float32);
                                 return asked = true;
                               },
                           .take = [&](const std::function<std::span<const Facet>()>& next, int worker) -> std::function<void()> {
                             if (worker < 0 || worker >= threads || ++at_work > threads) throw std::logic_error("too many at work");
                             std::vector<Facet> here;
                             for (auto some = next(); !some.empty(); some = next()) {
                               if (here.size() % FacetBlocks::kSome != 0) throw std::logic_error("a part within was short");
                               here.insert(here.end(), some.begin(), some.end());
                             }
                             --at_work;
                             return [&, here] {
                               if (!out.facets.empty() && out.facets.size() % FacetBlocks::kFacets != 0)
                                 throw std::logic_error("a block within was short");
                               for (const Facet& f : here) out.facets.push_back(f.vertex);
                             };
                           }};
  const FacetSink none = [](std::span<const Facet>) { throw std::logic_error("a facet in no block"); };
  Input input("mesh", bytes);
  try {
    out.file = read_facets(input, "", none, {.enter_patch = [&](uint32_t) { entered = true; }, .blocks = &blocks});
    CHECK(asked);
  } catch (const InputError& e) {
    out.refusal = e.what();
  }
  return out;
}

TEST_CASE("Binary STL: blocks hold the same facets in the same order, and refuse what is refused without them", "[threads]") {
  std::mt19937_64 random(7);
  constexpr size_t kLeast = 4 * FacetBlocks::kFacets;  // fewer come one by one
  const auto [threads, unit, count] = GENERATE_COPY(table<int, VectorUnit, size_t>(
      {{1, VectorUnit::kPlain, kLeast + 1}, {2, VectorUnit::kAvx2, kLeast}, {5, VectorUnit::kAvx512, kLeast + FacetBlocks::kFacets - 1}}));
  const testing::OnVectorUnit on(unit);
  surfaces::Facets facets(count);
  for (auto& f : facets)
    for (Vec3& v : f)
      for (double& x : v) x = random() % 9 == 0 ? -0.0 : static_cast<float>(testing::random_in(random, -1e6, 1e6));
  const std::string whole = surfaces::binary_stl(facets);
  for (const bool zip : {false, true}) {
    const auto packed = [&](const std::string& bytes) { return zip ? surfaces::gzipped(bytes) : bytes; };
    for (const std::string& more : {std::string(), std::string(300'000, 'x')}) {
      const InBlocks found = read_in_blocks(packed(whole + more), threads);
      REQUIRE(found.refusal.empty());
      const surfaces::Result expected = surfaces::read(packed(whole + more));
      REQUIRE((found.facets == expected.facets));
      REQUIRE(found.file.facets == count);
      REQUIRE(found.file.hash == expected.file.hash);
      REQUIRE(found.file.warnings == expected.file.warnings);
      size_t negative = 0;
      for (const auto& f : found.facets)
        for (const Vec3& v : f)
          for (const double x : v) negative += x == 0 && std::signbit(x);
      REQUIRE(negative == 0);
    }
    for (const size_t size : {size_t{84}, size_t{133}, whole.size() / 2, whole.size() - 1}) {
      std::string cut = packed(whole.substr(0, size));
      if (zip && random() % 2 == 0) cut.resize(cut.size() / 2);
      REQUIRE(!surfaces::refusal(cut).empty());
      REQUIRE(read_in_blocks(cut, threads).refusal == surfaces::refusal(cut));
    }
    // The first of several coordinates that are none is named, in whichever block it lies, also where the file is cut short behind it.
    const float none = zip ? std::numeric_limits<float>::infinity() : std::numeric_limits<float>::quiet_NaN();
    std::string bad = whole;
    for (const size_t facet : {random() % count, random() % count})
      bad.replace(84 + 50 * facet + 12 + 4 * (random() % 9), 4, surfaces::bytes_of(none));
    REQUIRE_THAT(surfaces::refusal(packed(bad)), Catch::Contains(": facet "));
    REQUIRE(read_in_blocks(packed(bad), threads).refusal == surfaces::refusal(packed(bad)));
    bad = packed(bad);
    bad.resize(bad.size() / 2);
    REQUIRE(read_in_blocks(bad, threads).refusal == surfaces::refusal(bad));
  }
}

}  // namespace
}  // namespace teracell::mesher
