// What is decided once the bodies are read. How options become axes is resolve_grid's (scene_test.cpp).
#include "mesher/run/plan.hpp"

#include "tests/support/test.hpp"

namespace teracell::mesher {
namespace {

Scene scene_on(const Index3& cells, const Vec3& max) {
  Scene scene;
  scene.units = "mm";
  scene.materials = {{"air", "#00000000"}, {"steel", "#8899aa"}};
  scene.bodies.resize(1);
  scene.bodies[0].name = "hull";
  for (int d = 0; d < 3; ++d) scene.axis[d].min = 0, scene.axis[d].max = max[d], scene.axis[d].cells = cells[d];
  return scene;
}

Plan plan_of(const Scene& scene, const Vec3& area, std::optional<int> axis = {}, uint32_t chunk_rays = 64) {
  Bodies bodies;
  bodies.lo = {0, 0, 0}, bodies.hi = {1, 1, 1};
  bodies.area = area;
  return make_plan(scene, bodies, axis, chunk_rays);
}

TEST_CASE("Crossings are expected by the area that faces an axis and the rays on a unit of it") {
  const Plan plan = plan_of(scene_on({10, 40, 80}, {5, 4, 2}), {3, 5, 7});  // 2, 10 and 40 rays per length
  CHECK(plan.rays.crossings[0] == Approx(3 * 10 * 40));
  CHECK(plan.rays.crossings[1] == Approx(5 * 2 * 40));
  CHECK(plan.rays.crossings[2] == Approx(7 * 2 * 10));
}

TEST_CASE("Rays run along the axis with the least work: few crossings, or few rays where nothing is crossed") {
  const Index3 cube = {100, 100, 100};
  CHECK(plan_of(scene_on(cube, {1, 1, 1}), {1, 2, 3}).rays.axis == 0);
  CHECK(plan_of(scene_on(cube, {1, 1, 1}), {2, 1, 3}).rays.axis == 1);
  CHECK(plan_of(scene_on(cube, {1, 1, 1}), {3, 2, 1}).rays.axis == 2);
  CHECK(plan_of(scene_on({1000, 100, 100}, {10, 1, 1}), {0, 0, 0}).rays.axis == 0);
  CHECK(plan_of(scene_on({100, 1000, 100}, {1, 10, 1}), {0, 0, 0}).rays.axis == 1);
  // A crossing costs some 8 rays. Along z there are a million rays without a crossing, along x a hundred thousand with 1e4 or 2e6.
  CHECK(plan_of(scene_on({1000, 1000, 100}, {10, 10, 1}), {1, 99, 0}).rays.axis == 0);
  CHECK(plan_of(scene_on({1000, 1000, 100}, {10, 10, 1}), {200, 999, 0}).rays.axis == 2);
}

TEST_CASE("Of equal axes rays run along z, then y") {
  CHECK(plan_of(scene_on({50, 50, 50}, {1, 1, 1}), {1, 1, 1}).rays.axis == 2);
  CHECK(plan_of(scene_on({50, 50, 50}, {1, 1, 1}), {1, 1, 2}).rays.axis == 1);
  CHECK(plan_of(scene_on({50, 50, 50}, {1, 1, 1}), {0, 0, 0}).rays.axis == 2);
}

TEST_CASE("An axis that is asked for is taken whatever it costs, and said to be asked for") {
  const Scene scene = scene_on({100, 100, 100}, {1, 1, 1});
  for (int axis = 0; axis < 3; ++axis) {
    const Plan plan = plan_of(scene, {9, 1, 5}, axis);
    CHECK(plan.rays.axis == axis);
    CHECK(plan.meta.ray_axis == axis);
    CHECK(plan.rays.asked_for);
    CHECK(plan.rays.crossings[0] == Approx(9 * 100 * 100));
  }
  CHECK_FALSE(plan_of(scene, {9, 1, 5}).rays.asked_for);
  CHECK(plan_of(scene, {9, 1, 5}).meta.ray_axis == 1);
}

TEST_CASE("Chunks are as long as 65,536 cells, and shorter by halves where one would hold more than two million changes, down to 1024") {
  const auto length = [](int64_t along, double crossings_per_ray, uint32_t chunk_rays = 64) {
    // 1000 x 1000 rays along z; the area is in rays.
    return plan_of(scene_on({1000, 1000, along}, {1000, 1000, 1}), {0, 0, crossings_per_ray * 1e6}, 2, chunk_rays).meta.chunk_cells;
  };
  CHECK(length(1000, 2) == 65536);
  CHECK(length(1000000, 2) == 65536);
  CHECK(length(65536, 480) == 65536);  // 64 * 64 * 480 = 1,966,080 changes
  CHECK(length(65536, 500) == 32768);
  CHECK(length(65536, 1000) == 16384);
  CHECK(length(131072, 1000) == 32768);
  CHECK(length(65536, 480, 128) == 16384);  // four times as many rays in a chunk
  CHECK(length(65536, 4e6) == 1024);
  CHECK(length(1000, 600) == 1024);  // a chunk is no longer than the rays, so halving helps only below their length
}

TEST_CASE("The plan's metadata are those of scene, labels and options") {
  Scene scene = scene_on({10, 20, 30}, {1, 2, 3});
  scene.sample = {0, 0.25, 0.5};
  for (const LabelBy by : {LabelBy::kMaterial, LabelBy::kBody, LabelBy::kOverlap}) {
    scene.label_by = by;
    const Plan plan = plan_of(scene, {1, 1, 1}, {}, 16);
    const Labels labels = make_labels(scene);
    CHECK(plan.meta.units == "mm");
    CHECK(plan.meta.chunk_rays == 16);
    CHECK(plan.meta.grid == resolve_grid(scene, {}, {}));
    CHECK(plan.meta.grid.axis[1].sample() == 0.25);
    CHECK(plan.meta.materials == labels.materials);
    CHECK(plan.meta.labels == labels.labels);
    CHECK(plan.labels.of_body == labels.of_body);
    CHECK(plan.labels.rank == labels.rank);
  }
}

TEST_CASE("Links and labels of overlaps exclude each other") {
  Scene scene = scene_on({10, 10, 10}, {1, 1, 1});
  scene.label_by = LabelBy::kOverlap;
  CHECK_THROWS_WITH(make_plan(scene, {}, {}, 64, {}, true), Catch::Contains("links") && Catch::Contains("\"overlap\""));
  CHECK_NOTHROW(make_plan(scene, {}, {}, 64, Subdivision{2, 2, 2}));
}

TEST_CASE("A domain that the scene leaves open is the box of all bodies with its pad") {
  Scene scene = scene_on({1, 1, 1}, {1, 1, 1});
  for (SceneAxis& axis : scene.axis) axis = {};
  scene.longest_cells = 10;
  Bodies bodies;
  bodies.lo = {-1, 0, 2}, bodies.hi = {7, 2, 3};
  const Plan plan = make_plan(scene, bodies, {}, 64);
  CHECK(plan.meta.grid == resolve_grid(scene, bodies.lo, bodies.hi));
  CHECK(plan.meta.grid.cells() == Index3{10, 4, 3});
  CHECK(plan.meta.grid.axis[0].min() == -2);
}

}  // namespace
}  // namespace teracell::mesher
