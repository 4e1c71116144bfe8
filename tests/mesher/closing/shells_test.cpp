// Which facets hang together and which lie on each other, in memory and by batches.
#include "mesher/closing/shells.hpp"
#include "mesher/closing/boundary.hpp"
#include "tests/support/cube_grid.hpp"
#include "tests/support/every_way.hpp"

namespace teracell::mesher {
namespace {

using shapes::Facets;

Shells shells_of(const Facets& facets, bool bounded) {
  Budget budget;
  budget.bytes = 1;  // 4096 facets a batch
  Shells out(facets.size(), budget, bounded);
  for (const Facet& f : facets) out.add(f);
  out.finish();
  return out;
}

// Long strips of facets, whose ends come far apart in the file, and boxes that are given again the other way round.
Facets many_shells(uint64_t seed) {
  std::mt19937_64 random(seed);
  Facets out;
  for (int s = 0; s < 40; ++s)
    for (int i = 0; i < 300; ++i) {
      const Vec3 a = {double(s), double(i), 0}, b = {double(s), double(i + 1), 0}, c = {s + 0.5, i + 0.5, 1};
      if (i == 150 && s % 2 == 0) continue;  // every other strip is in two
      out.push_back({{a, b, c}});
    }
  for (int k = 0; k < 50; ++k) {
    const Facets box = shapes::box({100.0 + 2 * k, 0, 0}, {101.0 + 2 * k, 1, 1});
    out.insert(out.end(), box.begin(), box.end());
    const Facets again = shapes::flip(box);
    out.insert(out.end(), again.begin(), again.begin() + k % 13);
  }
  std::ranges::shuffle(out, random);
  return out;
}

TEST_CASE("Shells are those that joining equal vertices one by one gives, in one batch and in several") {
  const Facets facets = many_shells(1);
  std::map<Vec3, size_t> at;
  std::vector<size_t> parent(facets.size());
  const auto root = [&](size_t i) {
    while (parent[i] != i) i = parent[i];
    return i;
  };
  for (size_t i = 0; i < facets.size(); ++i) {
    parent[i] = i;
    for (const Vec3& v : facets[i].vertex) {
      const auto [it, fresh] = at.try_emplace(v, i);
      const size_t a = root(it->second), b = root(i);
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  std::map<size_t, uint32_t> number;  // by the first facet
  for (size_t i = 0; i < facets.size(); ++i) number.try_emplace(root(i), static_cast<uint32_t>(number.size()));
  for (const bool bounded : {false, true}) {
    const Shells shells = shells_of(facets, bounded);
    REQUIRE(shells.count() == 60 + 50);
    std::vector<Vec3> vertices;
    for (size_t i = 0; i < facets.size(); ++i) {
      REQUIRE(shells.of_facet(i) == number.at(root(i)));
      vertices.push_back(facets[i].vertex[i % 3]);
    }
    const std::vector<uint32_t> of = shells.of(vertices);
    for (size_t i = 0; i < facets.size(); ++i) REQUIRE(of[i] == number.at(root(i)));
  }
}

TEST_CASE("Facets that lie on an earlier one repeat it; a shell is double when half of its facets cancel") {
  const Facets facets = many_shells(2);
  for (const bool bounded : {false, true}) {
    const Shells shells = shells_of(facets, bounded);
    std::map<std::vector<Vec3>, std::pair<uint32_t, int>> seen;  // by sorted vertices: shell, how many
    for (size_t i = 0; i < facets.size(); ++i) {
      std::vector<Vec3> v(facets[i].vertex.begin(), facets[i].vertex.end());
      std::ranges::sort(v);
      auto& [shell, count] = seen[v];
      REQUIRE(shells.repeats(i) == (count > 0));
      shell = shells.of_facet(i);
      ++count;
    }
    std::vector<uint64_t> twice(shells.count());
    for (const auto& [v, s] : seen) twice[s.first] += s.second == 2;
    for (uint32_t s = 0; s < shells.count(); ++s) {
      CHECK(shells.cancelled(s) == 2 * twice[s]);
      CHECK(shells.is_double(s) == (4 * twice[s] >= 12 && twice[s] > 0 && 4 * twice[s] >= shells.facets(s)));
    }
  }
}

TEST_CASE("A facet given twice the same way round cancels nothing, three times with one opposite cancels two") {
  const Facets box = shapes::box({0, 0, 0}, {1, 1, 1});
  Facets facets = shapes::join({box, {box[0], box[1]}, {box[1]}});
  facets.push_back(shapes::flip({box[1]})[0]);
  const Shells shells = shells_of(facets, false);
  CHECK(shells.count() == 1);
  CHECK(shells.cancelled(0) == 2);
  CHECK_FALSE(shells.is_double(0));
}

TEST_CASE("A closed surface that is given twice with opposite facets has the cells of the surface, whatever the memory") {
  const testing::TempFolder folder;
  const Grid grid = cube_grid_of(-5, 0.5, 20);
  const Facets sphere = shapes::sphere({0, 0, 0}, 4, 3), far = shapes::box({-4.9, -4.9, -4.9}, {-3.1, -3.1, -3.1});
  const auto expected = oracle::materials({{sphere}, {far}}, grid);
  Scene scene = testing::scene_of(folder, {{shapes::join({sphere, far, shapes::flip(sphere)})}}, grid);
  scene.bodies[0].fill = Fill::kAuto;
  MeshOptions options;
  for (const uint64_t memory : {~uint64_t{0}, uint64_t{1}}) {
    options.memory = memory;
    testing::for_axes(scene, options, [&](const GridReader& reader, const auto& report) {
      REQUIRE((testing::all_cells(reader) == expected));
      const auto& body = report["bodies"][0];
      CHECK(body["fill"][0]["rule"] == "nonzero");
      CHECK(body["fill"][1]["rule"] == "distinct");
      CHECK(body["duplicates"] == sphere.size());
      CHECK(body["opposite"] == sphere.size());
    });
  }
}

}  // namespace
}  // namespace teracell::mesher
