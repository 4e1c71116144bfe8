// Planes of random scenes hold the rules that users read; plane_rules.hpp judges them.
#include "mesher/planes/make_planes.hpp"

#include <random>

#include "tests/mesher/planes/plane_rules.hpp"
#include "tests/support/random.hpp"

namespace teracell::mesher {
namespace {

using testing::judge;
using testing::RuledBody;
using testing::Verdict;

class RandomScene {
 public:
  explicit RandomScene(uint64_t seed) : random_(seed) {}

  // Boxes, plates, cylinders and balls; some turned by a quarter or by 37 degrees, some touching, some nearly so, some mirrored to the other side.
  void fill() {
    scene.units = "mm";
    scene.materials = {{"air", ""}, {"steel", ""}, {"copper", ""}};
    AutoPlanes rules;
    rules.finest = std::exp(real(std::log(0.02), std::log(1)));
    rules.coarsest = rules.finest * std::exp(real(std::log(2), std::log(60)));
    rules.growth = real(1.1, 2.5);
    rules.snap = static_cast<AutoPlanes::Snap>(pick(3));
    rules.pad = pick(4);
    const int count = 1 + pick(12);
    const bool mirrored = chance(0.3);
    for (int i = 0; i < count; ++i) add(body(rules.finest), mirrored);
    if (chance(0.5)) rules.resolution["b0"] = within(rules.finest);
    if (chance(0.3)) rules.resolution["copper"] = within(rules.finest);
    if (rules.snap == AutoPlanes::Snap::kThirds) rules.metals = {chance(0.5) ? "copper" : "b0"};
    for (int d = 0; d < 3; ++d) {
      scene.axis[d].made = rules;
      if (mirrored || chance(0.5)) scene.axis[d].min = -60, scene.axis[d].max = 60;
      if (scene.axis[d].min && !mirrored)
        for (int i = pick(4); i > 0; --i) scene.axis[d].made->fixed.push_back(real(-60, 60));
    }
  }

  MadePlanes made() {
    std::vector<FlatFaces> flat;
    std::vector<ShapeOfBody> shapes;
    Vec3 all_lo, all_hi;
    all_lo.fill(HUGE_VAL), all_hi.fill(-HUGE_VAL);
    for (const RuledBody& b : bodies) {
      FlatFaceSearch search({0, 0, 0});
      Vec3 lo, hi;
      lo.fill(HUGE_VAL), hi.fill(-HUGE_VAL);
      for (const Facet& f : b.facets) {
        search.take(f.vertex, area(f));
        for (const Vec3& v : f.vertex)
          for (int d = 0; d < 3; ++d) lo[d] = std::min(lo[d], v[d]), hi[d] = std::max(hi[d], v[d]);
      }
      flat.push_back(std::move(search).found());
      shapes.push_back({lo, hi, nullptr});
      for (int d = 0; d < 3; ++d) all_lo[d] = std::min(all_lo[d], lo[d]), all_hi[d] = std::max(all_hi[d], hi[d]);
    }
    for (size_t b = 0; b < shapes.size(); ++b) shapes[b].faces = &flat[b];
    return make_planes(scene, shapes, all_lo, all_hi);
  }

  void shuffle() {
    std::vector<size_t> order(bodies.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::ranges::shuffle(order, random_);
    const auto old_bodies = bodies;
    const auto old_scene = scene.bodies;
    for (size_t i = 0; i < order.size(); ++i) bodies[i] = old_bodies[order[i]], scene.bodies[i] = old_scene[order[i]];
  }

  Scene scene;
  std::vector<RuledBody> bodies;

 private:
  double real(double lo, double hi) { return std::uniform_real_distribution<>(lo, hi)(random_); }
  int pick(int n) { return static_cast<int>(random_() % static_cast<uint64_t>(n)); }
  bool chance(double p) { return real(0, 1) < p; }

  CellsWithin within(double finest) {
    CellsWithin out;
    if (chance(0.6)) out.step = finest * real(2, 20);
    if (!out.step || chance(0.5)) out.across = 1 + pick(12);
    return out;
  }

  shapes::Facets body(double finest) {
    Vec3 lo, hi;
    for (int d = 0; d < 3; ++d) {
      lo[d] = chance(0.3) ? std::round(real(-40, 30)) : real(-40, 30);
      if (!edges_.empty() && chance(0.3)) lo[d] = edges_[random_() % edges_.size()] + (chance(0.5) ? 0 : finest * real(-2, 2));
      hi[d] = lo[d] + (chance(0.2) ? finest * real(0.1, 3) : real(0.5, 25));
      edges_.push_back(lo[d]), edges_.push_back(hi[d]);
    }
    const Vec3 middle = {(lo[0] + hi[0]) / 2, (lo[1] + hi[1]) / 2, (lo[2] + hi[2]) / 2};
    switch (pick(5)) {
      case 0: return shapes::prism(middle, real(1, 10), 3 + pick(30), hi[2] - lo[2]);
      case 1: return shapes::sphere(middle, real(1, 10), 2);
      case 2: return turned(shapes::box(lo, hi), rotation({0, 0, 1}, 37));
      case 3: return turned(shapes::box(lo, hi), rotation({1, 0, 0}, 90));
      default: return shapes::box(lo, hi);
    }
  }

  static shapes::Facets turned(shapes::Facets facets, const Matrix& m) {
    SceneBody body;
    body.matrix = m;
    for (Facet& f : facets)
      for (Vec3& v : f.vertex)
        v = {m[0] * v[0] + m[1] * v[1] + m[2] * v[2] + m[3], m[4] * v[0] + m[5] * v[1] + m[6] * v[2] + m[7],
             m[8] * v[0] + m[9] * v[1] + m[10] * v[2] + m[11]};
    return facets;
  }

  void add(const shapes::Facets& facets, bool mirrored) {
    const uint32_t material = 1 + pick(2);
    const std::string name = "b" + std::to_string(bodies.size());
    bodies.push_back({name, scene.materials[material].name, facets});
    if (mirrored) {  // through the middle of the domain
      shapes::Facets& own = bodies.back().facets;
      for (shapes::Facets other = shapes::flip(facets); Facet & f : other) {
        for (Vec3& v : f.vertex)
          for (double& x : v) x = -x;
        own.push_back(f);
      }
    }
    SceneBody& b = scene.bodies.emplace_back();
    b.name = name, b.material = material;
  }

  std::mt19937_64 random_;
  std::vector<double> edges_;
};

std::vector<PlaneBreach> of_axis(const PlanesReport& report, int axis) {
  std::vector<PlaneBreach> out;
  for (const PlaneBreach& b : report.breaches)
    if (b.axis == axis) out.push_back(b);
  return out;
}

TEST_CASE("Planes of random scenes hold every rule, or list where two of them collide; they have few cells", "[planes]") {
  constexpr int kScenes = 1000;
  double ratios = 0;
  int axes = 0, symmetric = 0, with_breaches = 0, many = 0;
  for (int seed = 0; seed < kScenes; ++seed) {
    RandomScene random(static_cast<uint64_t>(seed));
    random.fill();
    const MadePlanes made = random.made();
    for (int d = 0; d < 3; ++d) {
      INFO("scene " << seed << ", axis " << d);
      const SceneAxis& axis = random.scene.axis[d];
      const auto breaches = of_axis(made.report, d);
      const Verdict v =
          judge({*axis.made, axis.min ? std::optional(std::array{*axis.min, *axis.max}) : std::nullopt, d}, random.bodies, made.planes[d], breaches);
      for (const std::string& words : v.broken) FAIL_CHECK(words);
      const double most = 1.15 * v.ideal + static_cast<double>(v.gaps);
      many += v.cells > most;
      CHECK(v.cells <= 1.2 * most);
      ratios += v.cells / v.ideal, ++axes;
      symmetric += v.symmetric, with_breaches += !breaches.empty();
    }
  }
  INFO("cells / S " << ratios / axes << ", " << symmetric << " symmetric, " << with_breaches << " with breaches, " << many << " with many cells");
  CHECK(ratios / axes < 1.03);
  CHECK(symmetric > 100);
  CHECK(with_breaches > 100);
  CHECK(many <= 3);  // where the other rules leave no way to fewer
}

// The x axis of boxes, each with a step of its own.
struct Line {
  struct Box {
    double lo, hi, step;
  };
  double lo, hi, coarsest, growth;  // the finest cell is 1 wide
  std::vector<Box> boxes;
  std::vector<double> fixed = {};

  struct Made {
    std::vector<double> planes;
    std::vector<PlaneBreach> breaches;
    Verdict verdict;
    bool few() const { return verdict.cells <= 1.15 * verdict.ideal + static_cast<double>(verdict.gaps); }
  };
  Made made() const {
    Scene scene;
    scene.units = "mm";
    scene.materials = {{"air", ""}, {"steel", ""}};
    AutoPlanes rules;
    rules.finest = 1, rules.coarsest = coarsest, rules.growth = growth, rules.snap = AutoPlanes::Snap::kNone, rules.fixed = fixed;
    const FlatFaces no_faces{};
    std::vector<RuledBody> bodies;
    std::vector<ShapeOfBody> shapes;
    for (const Box& b : boxes) {
      SceneBody& body = scene.bodies.emplace_back();
      body.name = "b" + std::to_string(bodies.size()), body.material = 1;
      rules.resolution[body.name].step = b.step;
      bodies.push_back({body.name, "steel", shapes::box({b.lo, 0, 0}, {b.hi, 1, 1})});
      shapes.push_back({{b.lo, 0, 0}, {b.hi, 1, 1}, &no_faces});
    }
    scene.axis[0].made = rules, scene.axis[0].min = lo, scene.axis[0].max = hi;
    const MadePlanes out = make_planes(scene, shapes, {lo, 0, 0}, {hi, 1, 1});
    return {out.planes[0], out.report.breaches, judge({rules, std::array{lo, hi}, 0}, bodies, out.planes[0], out.report.breaches)};
  }
};

TEST_CASE("A resolution within a gap costs few cells, wherever it lies and however far a cell reaches beyond it", "[planes]") {
  const std::vector<Line> lines = {{0, 13.69561247, 10, 2, {{6.17976448, 11.07721634, 8}}},
                                   {0, 40.59050212, 20, 2, {{2.94109368, 7.32392170, 8}}},
                                   {-9.267, 13.189, 24.5, 1.3, {{1.4, 6.4, 4}}},
                                   {-3.5, 47.463, 10, 1.2, {{4.24872639, 7.46298164, 8}}},
                                   {0, 31.56246012, 20, 2, {{14.67795305, 17.39077338, 8}}, {21.54899135}}};
  for (const Line& line : lines) {
    INFO("from " << line.lo << " to " << line.hi);
    const auto made = line.made();
    for (const std::string& words : made.verdict.broken) FAIL_CHECK(words);
    CHECK(made.breaches.empty());
    CHECK(made.few());
  }
}

TEST_CASE("A symmetric axis has a plane or a whole cell in its middle", "[planes]") {
  const double gap = 8.048730314993575, face = 12.252344457496218;
  const std::vector<Line> lines = {{-8.05, 8.05, 10, 2, {{1.6, 8.05, 2}, {-8.05, -1.6, 2}}},
                                   {-8.05, 8.05, 10, 10, {{1.6, 8.05, 2}, {-8.05, -1.6, 2}}},
                                   {-8.051, 8.051, 10, 2, {{1.6, 8.05, 2}, {-8.05, -1.6, 2}}},
                                   {-8.1, 8.1, 10, 2, {{1.9, 9, 2.02}, {-9, -1.9, 2.02}}},
                                   {-52.25234445749622, 52.25234445749622, 10, 10, {{1.6, 9, 2}, {-9, -1.6, 2}}, {-face, -gap, gap, face}}};
  for (const Line& line : lines) {
    INFO("to " << line.hi << ", growth " << line.growth);
    const auto made = line.made();
    for (const std::string& words : made.verdict.broken) FAIL_CHECK(words);
    CHECK(made.verdict.symmetric);
    CHECK(made.breaches.empty());
    CHECK(made.few());
  }
}

TEST_CASE("Random axes with resolutions within gaps hold every rule, symmetric or not", "[planes]") {
  constexpr int kLines = 2000;
  std::mt19937_64 random(7);
  const auto real = [&](double lo, double hi) { return std::uniform_real_distribution<>(lo, hi)(random); };
  int many = 0;
  for (int i = 0; i < kLines; ++i) {
    const bool symmetric = i % 2 == 0;
    Line line = {0, real(3, 60), real(2, 20), std::array{1.2, 1.3, 1.5, 2.0, 3.0, 10.0}[random() % 6], {}};
    if (symmetric) line.lo = -line.hi;
    const auto add = [&](auto& list, auto item, auto mirrored) {
      list.push_back(item);
      if (symmetric) list.push_back(mirrored);
    };
    for (auto n = random() % 3; n > 0; --n) {
      const double lo = real(0, line.hi), hi = lo + real(0.5, 20), step = real(2, 8);
      add(line.boxes, Line::Box{lo, hi, step}, Line::Box{-hi, -lo, step});
    }
    for (auto n = random() % 3; n > 0; --n) {
      const double at = real(0, line.hi);
      add(line.fixed, at, -at);
    }
    INFO("line " << i);
    const auto made = line.made();
    for (const std::string& words : made.verdict.broken) FAIL_CHECK(words);
    many += !made.few();
  }
  INFO(many << " with many cells");
  CHECK(many <= 4);  // where the other rules leave no way to fewer
}

TEST_CASE("The order of bodies changes no plane", "[planes]") {
  for (int seed = 0; seed < 50; ++seed) {
    RandomScene random(static_cast<uint64_t>(1000 + seed));
    random.fill();
    const auto first = random.made().planes;
    random.shuffle();
    INFO("scene " << seed);
    CHECK(random.made().planes == first);
  }
}

}  // namespace
}  // namespace teracell::mesher
