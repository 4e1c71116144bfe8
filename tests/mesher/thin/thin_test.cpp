// What lies between sample points, counted and kept, against rational arithmetic.
#include "tests/support/cube_grid.hpp"
#include "tests/support/every_way.hpp"
#include "tests/support/ties.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;
using oracle::Body;
using oracle::Rule;
using shapes::Facets;

// What is lost of a body or a material along an axis.
struct Lost {
  uint64_t number = 0;
  double length = 0;
  uint32_t widest = 0;
  Vec3 at{};

  void add(uint32_t width, double unit, const Vec3& place) {
    ++number;
    if (width * unit > length) length = width * unit, widest = width, at = place;  // intervals come in order
  }
};

struct Expected {
  std::vector<uint32_t> cells;                                // with those kept
  std::vector<std::array<Lost, 3>> lost;                      // of each body
  std::map<std::pair<uint32_t, int>, Lost> gaps;              // by material and axis
  std::vector<std::array<std::pair<uint64_t, Vec3>, 3>> pairs;  // of each body: along each axis how many, and the first
};

double place_of_sub_position(const Axis& axis, int64_t i, uint32_t k) {
  return axis.centre(i) + (k / 65536.0) * (axis.centre(i + 1) - axis.centre(i));
}

// Of bodies that all keep their thin parts. Interval by interval, every sub-position where something changes.
Expected expected_of(const std::vector<Body>& bodies, const Grid& grid) {
  const Index3 n = grid.cells();
  const auto number = [&](const Index3& c) { return static_cast<size_t>((c[2] * n[1] + c[1]) * n[0] + c[0]); };
  const auto inside = [&](size_t b, int winding) { return bodies[b].rule == Rule::kNonzero ? winding != 0 : winding % 2 != 0; };
  using Key = std::tuple<int, int64_t, int64_t, int64_t>;  // axis, z, y, x
  std::vector<std::vector<int>> windings;
  std::map<Key, std::vector<std::vector<std::pair<uint32_t, int>>>> intervals;  // of each body
  Expected out;
  out.lost.resize(bodies.size());
  out.pairs.resize(bodies.size());
  std::vector<std::vector<bool>> owned;
  for (size_t b = 0; b < bodies.size(); ++b) {
    windings.push_back(oracle::winding_numbers(bodies[b].facets, grid, bodies[b].facets[0].vertex[0]));
    owned.emplace_back();
    for (const int w : windings[b]) owned[b].push_back(inside(b, w));
    for (const oracle::Interval& interval : oracle::intervals(bodies[b].facets, grid)) {
      auto& steps = intervals[{interval.axis, interval.lower[2], interval.lower[1], interval.lower[0]}];
      steps.resize(bodies.size());
      steps[b] = interval.steps;
    }
  }
  for (const auto& [key, steps] : intervals) {
    const auto& [axis, z, y, x] = key;
    const Index3 lower = {x, y, z};
    Index3 upper = lower;
    ++upper[axis];
    const auto place = [&](double w) {
      Vec3 p = {grid.axis[0].centre(x), grid.axis[1].centre(y), grid.axis[2].centre(z)};
      p[axis] = w;
      return p;
    };
    std::vector<uint32_t> ks = {0, 65536};  // between two of these nothing changes
    for (const auto& of_body : steps)
      for (const auto& [k, step] : of_body) ks.push_back(k);
    std::ranges::sort(ks);
    ks.erase(std::unique(ks.begin(), ks.end()), ks.end());
    const auto winding_at = [&](size_t b, uint32_t k) {
      int w = windings[b][number(lower)];
      for (const auto& [from, step] : steps[b])
        if (from <= k) w += step;
      return w;
    };
    const auto material_at = [&](uint32_t k) {
      uint32_t material = 0;
      int64_t priority = std::numeric_limits<int64_t>::min();
      for (size_t b = 0; b < bodies.size(); ++b)
        if (bodies[b].priority >= priority && inside(b, winding_at(b, k))) material = bodies[b].material, priority = bodies[b].priority;
      return material;
    };
    struct Run {
      uint32_t from, to;
    };
    const auto runs = [&](auto&& is) {
      std::vector<Run> found;
      for (size_t i = 0; i + 1 < ks.size(); ++i) {
        if (!is(ks[i])) continue;
        if (!found.empty() && found.back().to == ks[i]) found.back().to = ks[i + 1];
        else found.push_back({ks[i], ks[i + 1]});
      }
      return found;
    };
    const auto tally = [&](Lost& lost, const std::vector<Run>& found) {
      const auto widest = std::ranges::max_element(found, {}, [](const Run& r) { return r.to - r.from; });
      const Axis& line = grid.axis[axis];
      const double cell = line.is_graded() ? line.centre(upper[axis]) - line.centre(lower[axis]) : line.step();
      lost.add(widest->to - widest->from, cell / 65536,
               place(place_of_sub_position(grid.axis[axis], lower[axis], widest->from + (widest->to - widest->from) / 2)));
    };
    for (size_t b = 0; b < bodies.size(); ++b) {
      REQUIRE(winding_at(b, 65536) == windings[b][number(upper)]);
      if (auto& [pairs, first] = out.pairs[b][axis]; steps[b].size() > 1) {
        if (pairs == 0) first = place(place_of_sub_position(grid.axis[axis], lower[axis], 32768));
        pairs += steps[b].size() / 2;
      }
      if (inside(b, winding_at(b, 0)) || inside(b, winding_at(b, 65536))) continue;
      const auto found = runs([&](uint32_t k) { return inside(b, winding_at(b, k)); });
      if (found.empty()) continue;
      tally(out.lost[b][axis], found);
      const bool above = place_of_sub_position(grid.axis[axis], lower[axis], found[0].from) >= grid.axis[axis].plane(upper[axis]);
      owned[b][number(above ? upper : lower)] = true;
    }
    const uint32_t around = material_at(0);
    if (around == 0 || around != material_at(65536)) continue;
    if (const auto found = runs([&](uint32_t k) { return material_at(k) == 0; }); !found.empty()) tally(out.gaps[{around, axis}], found);
  }
  out.cells.resize(windings[0].size());
  for (size_t i = 0; i < out.cells.size(); ++i) {
    int64_t priority = std::numeric_limits<int64_t>::min();
    for (size_t b = 0; b < bodies.size(); ++b)
      if (owned[b][i] && bodies[b].priority >= priority) out.cells[i] = bodies[b].material, priority = bodies[b].priority;
  }
  return out;
}

Scene keeping(const TempFolder& folder, const std::vector<Body>& bodies, const Grid& grid) {
  Scene scene = scene_of(folder, bodies, grid);
  for (SceneBody& body : scene.bodies) body.thin = Thin::kKeep;
  return scene;
}

void expect_lost(const nlohmann::ordered_json& found, const Lost& expected) {
  REQUIRE(found["number"] == expected.number);
  REQUIRE(found["widest_65536ths"] == expected.widest);
  REQUIRE(found["widest"] == expected.length);
  if (expected.number > 0) REQUIRE(found["at"].get<Vec3>() == expected.at);
  else REQUIRE(found["at"].is_null());
}

void expect_thin(const GridReader& reader, const nlohmann::ordered_json& report, const Expected& expected) {
  REQUIRE(all_cells(reader) == expected.cells);
  const int ray_axis = reader.meta().ray_axis;
  for (size_t b = 0; b < expected.lost.size(); ++b) {
    const auto& body = report["bodies"][b];
    for (int axis = 0; axis < 3; ++axis) expect_lost(body["lost"][axis_name(axis)], expected.lost[b][axis]);
    const auto& [pairs, first] = expected.pairs[b][ray_axis];
    REQUIRE(body["lost_stretches"]["axis"] == axis_name(ray_axis));
    REQUIRE(body["lost_stretches"]["number"] == pairs);
    if (pairs > 0) REQUIRE(body["lost_stretches"]["at"].get<Vec3>() == first);
    else REQUIRE(body["lost_stretches"]["at"].is_null());
  }
  REQUIRE(report["lost_gaps"].size() == expected.gaps.size());
  for (const auto& gap : report["lost_gaps"]) {
    const auto material = static_cast<uint32_t>(std::stoul(gap["material"].get<std::string>().substr(1)));
    expect_lost(gap, expected.gaps.at({material, *axis_named(gap["axis"].get<std::string>())}));
  }
}

// Along each axis, by each engine.
void expect_exact_thin(const std::vector<Body>& bodies, const Grid& grid) {
  const TempFolder folder;
  const Expected expected = expected_of(bodies, grid);
  for_engines_and_axes(keeping(folder, bodies, grid), {.thin = true},
                       [&](const GridReader& reader, const auto& report) { expect_thin(reader, report, expected); });
}

// Bodies of a few cells, of less than one, and shells full of ties.
std::vector<Body> thin_scene(std::mt19937_64& random, int n) {
  std::vector<Body> bodies;
  for (int b = random_int(random, 1, 4); b > 0; --b) {
    std::vector<Facets> shells;
    for (const Facets& t : shapes::random_tetrahedra(random, random_int(random, 1, 6), 0, n, 0.125)) shells.push_back(t);
    for (int i = random_int(random, 0, 4); i > 0; --i) {  // plates
      Vec3 lo, hi;
      for (int d = 0; d < 3; ++d) lo[d] = random_int(random, -4, 8 * n) / 8.0, hi[d] = lo[d] + random_int(random, 1, 8 * n) / 8.0;
      const int d = random_int(random, 0, 2);
      hi[d] = lo[d] + random_int(random, 1, 4) / 16.0;
      shells.push_back(shapes::box(lo, hi));
    }
    if (random_int(random, 0, 1) == 0) shells.push_back(shapes::shell_of_ties(random, n));
    Body body{shapes::join(shells)};
    if (random_int(random, 0, 2) == 0) body.rule = Rule::kEvenodd;
    body.material = static_cast<uint32_t>(random_int(random, 1, 2));
    body.priority = random_int(random, 0, 1);
    bodies.push_back(std::move(body));
  }
  return bodies;
}

TEST_CASE("Lost stretches and gaps are those of rational arithmetic, and kept cells hold them, by every engine along every axis", "[thin]") {
  for_seeds(0, rounds(25), [](auto& random) {
    const int n = random_int(random, 3, 7);
    const Grid grid = shapes::grid_of_ties(random, n);
    expect_exact_thin(thin_scene(random, n), grid);
  });
}

TEST_CASE("Needles, and plates that miss sub-positions by a rounding, are kept as rational arithmetic says", "[thin]") {
  for_seeds(100, 4, [](auto& random) {
    expect_exact_thin(
        {{shapes::join(shapes::decimal_tetrahedra(random, 4))}, {shapes::join(shapes::decimal_tetrahedra(random, 2)), Rule::kEvenodd, 2}},
        cube_grid_of(0, 1.1 / 5, 5));
    expect_exact_thin({{shapes::join({shapes::needle(random), shapes::sheet(random)})}}, cube_grid_of(0, 1, 10));
  });
}

TEST_CASE("A plate a tenth of a cell thick is kept without a hole, however it lies", "[thin]") {
  const TempFolder folder;
  const Grid grid = cube_grid_of(0, 1, 20);
  for (const int d : {0, 1, 2})
    for (const double at : {7.2, 6.95, 7.0, 7.5, 7.95}) {
      Vec3 lo = {2.25, 2.25, 2.25}, hi = {17.25, 17.25, 17.25};
      lo[d] = at, hi[d] = at + 0.1;
      const Scene scene = keeping(folder, {{shapes::box(lo, hi)}}, grid);
      const auto report = mesh_quietly(scene, folder / "g.tcell");
      INFO("across " << axis_name(d) << " at " << at);
      REQUIRE(report["bodies"][0]["cells"] == 225);
      const auto& lost = report["bodies"][0]["lost"][axis_name(d)];
      REQUIRE(lost["number"] == (at == 7.5 ? 0 : 225));  // on the sample points it is not lost
      if (at != 7.5) REQUIRE(lost["widest"].get<double>() == Approx(0.1).margin(1e-4));
    }
}

TEST_CASE("The widest of what is lost is the longest, not the one with the largest share of its cell", "[thin]") {
  const TempFolder folder;
  const Grid grid{{Axis::uniform(0, 1, 0, 4, 0.5), Axis::uniform(0, 1, 0, 4, 0.5), Axis::graded({0, 1, 2, 12, 22}, 0.5)}};
  const Facets plates = shapes::join({shapes::box({1, 1, 0.75}, {3, 3, 1.25}), shapes::box({1, 1, 10}, {3, 3, 13})});  // 0.5 of 1 and 3 of 10
  for_axes(scene_of(folder, {{plates}}, grid), {.thin = true}, [](const GridReader&, const auto& report) {
    const auto& lost = report["bodies"][0]["lost"]["z"];
    CHECK(lost["number"] == 8);
    CHECK(lost["widest"].template get<double>() == Approx(3).margin(0.001));
    CHECK(lost["at"][2].template get<double>() == Approx(11.5).margin(0.001));
  });
}

TEST_CASE("A gap narrower than a cell is counted by its material with --thin", "[thin]") {
  const TempFolder folder;
  const Grid grid = cube_grid_of(0, 1, 10);
  const Facets halves = shapes::join({shapes::box({1, 1, 1}, {9, 9, 4.75}), shapes::box({1, 1, 5}, {9, 9, 9})});
  for_axes(scene_of(folder, {{halves}}, grid), {.thin = true}, [](const GridReader&, const auto& report) {
    REQUIRE(report["lost_gaps"].size() == 1);
    const auto& gap = report["lost_gaps"][0];
    CHECK(gap["material"] == "m1");
    CHECK(gap["axis"] == "z");
    CHECK(gap["number"] == 64);
    CHECK(gap["widest_65536ths"] == 16384);
    CHECK(gap["widest"] == 0.25);
    CHECK(gap["at"] == nlohmann::json({1.5, 1.5, 4.875}));
    for (const char* name : {"x", "y", "z"}) CHECK(report["bodies"][0]["lost"][name]["number"] == 0);
  });
  CHECK_FALSE(mesh_quietly(scene_of(folder, {{halves}}, grid), folder / "g.tcell").contains("lost_gaps"));
}

TEST_CASE("What is lost and kept does not depend on threads, memory or borders of tiles", "[thin]") {
  std::mt19937_64 random(300);
  const TempFolder folder;
  const Grid grid = shapes::uneven_grid(37, 20, 34);
  const std::vector<Body> bodies = {{shapes::join(shapes::random_tetrahedra(random, 40, 0, 18, 0.125))},
                                    {shapes::shell_of_ties(random, 16), Rule::kEvenodd, 2},
                                    {shapes::box({0.1, 0.2, 3.3}, {17, 18, 3.4}), Rule::kNonzero, 1}};
  const Expected expected = expected_of(bodies, grid);
  for_chunks_threads_and_memory(keeping(folder, bodies, grid), {.thin = true},
                                [&](const GridReader& reader, const auto& report) { expect_thin(reader, report, expected); });
}

TEST_CASE("Without thin keep no cell changes, and only pairs along the rays are counted", "[thin]") {
  std::mt19937_64 random(400);
  const TempFolder folder;
  const Grid grid = cube_grid_of(0, 1, 8);
  const std::vector<Body> bodies = thin_scene(random, 8);
  const Expected expected = expected_of(bodies, grid);
  for_axes(scene_of(folder, bodies, grid), {}, [&](const GridReader& reader, const auto& report) {
    REQUIRE(all_cells(reader) == oracle::materials(bodies, grid));
    for (size_t b = 0; b < bodies.size(); ++b) {
      CHECK(report["bodies"][b]["lost_stretches"]["number"] == expected.pairs[b][reader.meta().ray_axis].first);
      CHECK_FALSE(report["bodies"][b].contains("lost"));
    }
  });
}

TEST_CASE("A body with few cells or none says why", "[thin]") {
  const TempFolder folder;
  const Grid grid = cube_grid_of(0, 1, 10);
  const auto warnings = [&](const std::vector<Body>& bodies) {
    const auto report = mesh_quietly(scene_of(folder, bodies, grid), folder / "g.tcell", {.axis = 2});
    std::string all;
    for (const auto& w : report["warnings"]) all += w.get<std::string>() + "\n";
    return all;
  };
  const Facets ball = shapes::sphere({5, 5, 5}, 3, 3);
  CHECK(warnings({{ball}}).empty());
  const std::string plate = warnings({{shapes::box({1, 1, 3.6}, {9, 9, 3.7})}});
  CHECK_THAT(plate,
             Catch::Contains("owns no cell") && Catch::Contains("8 x 8 x 0.1 cells") && Catch::Contains("64 times") && Catch::Contains("keep"));
  CHECK_THAT(warnings({{shapes::box({11, 1, 1}, {12, 2, 2})}}), Catch::Contains("outside the domain") && Catch::Contains("x from 11 to 12"));
  CHECK_THAT(warnings({{ball}, {shapes::box({1, 1, 1}, {9, 9, 9}), Rule::kNonzero, 2}}), Catch::Contains("owns no cell: stronger bodies own"));
  const Facets square = {{{Vec3{1, 1, 3}, Vec3{9, 1, 3}, Vec3{9, 9, 3}}}, {{Vec3{1, 1, 3}, Vec3{9, 9, 3}, Vec3{1, 9, 3}}}};
  CHECK_THAT(warnings({{square}}), Catch::Contains("open and flat") && Catch::Contains("\"kind\": \"sheet\""));
  CHECK_THAT(warnings({{shapes::box({1, 1, 1}, {3, 2, 2})}}), Catch::Contains("owns only 2 cells") && Catch::Contains("2 x 1 x 1 cells"));
  const std::string many = warnings(std::vector<Body>(25, Body{shapes::box({11, 1, 1}, {12, 2, 2})}));
  CHECK(std::ranges::count(many, '\n') == 21);
  CHECK_THAT(many, Catch::Contains("5 more bodies"));
}

}  // namespace
}  // namespace teracell::mesher
