// Which body wins, what its cells are called, and how materials rank.
#include "mesher/scene/labels.hpp"

#include "tests/support/test.hpp"

namespace teracell::mesher {
namespace {

Scene scene_of(const std::vector<std::string>& materials, const std::vector<std::pair<uint32_t, int64_t>>& bodies, LabelBy by = LabelBy::kMaterial) {
  Scene scene;
  scene.materials.push_back({"air", "#00000000"});
  for (const std::string& name : materials) scene.materials.push_back({name, "#112233"});
  for (const auto& [material, priority] : bodies) {
    SceneBody body;
    body.name = "body" + std::to_string(scene.bodies.size());
    body.material = material;
    body.priority = priority;
    scene.bodies.push_back(body);
  }
  scene.label_by = by;
  return scene;
}

std::vector<uint32_t> ranks(const Labels& labels) {
  std::vector<uint32_t> out;
  for (const MaterialInfo& m : labels.materials) out.push_back(m.rank);
  return out;
}

TEST_CASE("The highest priority wins, of equal ones the later body") {
  CHECK(make_labels(scene_of({"a"}, {{1, 0}, {1, 0}, {1, 0}})).rank == std::vector<uint32_t>{2, 1, 0});
  CHECK(make_labels(scene_of({"a"}, {{1, 5}, {1, -5}, {1, 0}})).rank == std::vector<uint32_t>{0, 2, 1});
  CHECK(make_labels(scene_of({"a"}, {{1, 3}, {1, 7}, {1, 3}, {1, 7}})).rank == std::vector<uint32_t>{3, 1, 2, 0});
  constexpr int64_t least = std::numeric_limits<int64_t>::min(), most = std::numeric_limits<int64_t>::max();
  CHECK(make_labels(scene_of({"a"}, {{1, least}, {1, most}, {1, 0}})).rank == std::vector<uint32_t>{2, 0, 1});
}

TEST_CASE("Any two bodies of a scene are ordered as their priorities and places say") {
  std::mt19937_64 random(1);
  std::vector<std::pair<uint32_t, int64_t>> bodies;
  for (int i = 0; i < 200; ++i) bodies.push_back({1, static_cast<int64_t>(random() % 9) - 4});
  const Labels labels = make_labels(scene_of({"a"}, bodies));
  for (size_t a = 0; a < bodies.size(); ++a)
    for (size_t b = 0; b < a; ++b) REQUIRE((labels.rank[a] < labels.rank[b]) == (bodies[a].second >= bodies[b].second));
  REQUIRE(std::ranges::max(labels.rank) == bodies.size() - 1);
}

TEST_CASE("By material, a label is the material's number, and bodies of one material have one label") {
  const Labels labels = make_labels(scene_of({"steel", "oil"}, {{2, 0}, {1, 0}, {2, 9}, {0, 1}}));
  CHECK(labels.of_body == std::vector<Label>{2, 1, 2, 0});
  CHECK(labels.labels == std::vector<LabelInfo>{{0, ""}, {1, ""}, {2, ""}});
}

TEST_CASE("By body, every body has a label of its own that knows its material and name, the background's bodies too") {
  const Labels labels = make_labels(scene_of({"steel", "oil"}, {{2, 0}, {1, 0}, {2, 9}, {0, 1}}, LabelBy::kBody));
  CHECK(labels.of_body == std::vector<Label>{1, 2, 3, 4});
  CHECK(labels.labels == std::vector<LabelInfo>{{0, ""}, {2, "body0"}, {1, "body1"}, {2, "body2"}, {0, "body3"}});
}

TEST_CASE("By overlap, every body has two labels: that of its cells, and behind it that of those which lie in other bodies as well") {
  const Labels labels = make_labels(scene_of({"steel", "oil"}, {{2, 0}, {0, 1}}, LabelBy::kOverlap));
  CHECK(labels.of_body == std::vector<Label>{1, 3});
  CHECK(labels.of_overlap == std::vector<Label>{2, 4});
  CHECK(labels.labels == std::vector<LabelInfo>{{0, ""}, {2, "body0"}, {2, "body0", true}, {0, "body1"}, {0, "body1", true}});
  for (const LabelBy by : {LabelBy::kMaterial, LabelBy::kBody}) {
    const Labels alike = make_labels(scene_of({"steel", "oil"}, {{2, 0}, {0, 1}}, by));
    CHECK(alike.of_overlap == alike.of_body);
  }
}

TEST_CASE("A material ranks as its strongest body; those without one come after, in the scene's order; the background is last") {
  // 1: body 0 and body 3; 2: no body; 3: body 1; 4: no body; 5: body 2
  const std::vector<std::pair<uint32_t, int64_t>> bodies = {{1, 0}, {3, 5}, {5, 1}, {1, 2}};
  for (const LabelBy by : {LabelBy::kMaterial, LabelBy::kBody, LabelBy::kOverlap}) {
    const Labels labels = make_labels(scene_of({"a", "b", "c", "d", "e"}, bodies, by));
    CHECK(ranks(labels) == std::vector<uint32_t>{5, 1, 3, 0, 4, 2});
  }
}

TEST_CASE("The background is last though the strongest body carries it") {
  CHECK(ranks(make_labels(scene_of({"a", "b"}, {{1, 0}, {0, 99}}))) == std::vector<uint32_t>{2, 0, 1});
}

TEST_CASE("Materials keep name, color and number; a scene without bodies has labels all the same") {
  const Labels labels = make_labels(scene_of({"a", "b"}, {}));
  CHECK(labels.materials == std::vector<MaterialInfo>{{"air", "#00000000", 2}, {"a", "#112233", 0}, {"b", "#112233", 1}});
  CHECK(labels.labels.size() == 3);
  CHECK(labels.rank.empty());
}

}  // namespace
}  // namespace teracell::mesher
