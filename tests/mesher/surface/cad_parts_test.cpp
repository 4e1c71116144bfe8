// What the CAD kernel says of parts, where their volumes don't agree, and facets by the colour of their faces.
#include "mesher/surface/cad_parts.hpp"

#include "mesher/surface/reader.hpp"
#include "tests/support/test.hpp"

namespace teracell::mesher {
namespace {

using Catch::Contains;

Matrix moved_by(double x, double scale = 1) { return {scale, 0, 0, x, 0, scale, 0, 0, 0, 0, scale, 0}; }

// Two shapes of three facets: the first has a red face between two others, the second no colours.
PartTree tree_of(const std::vector<PartNode::Use>& uses) {
  Shapes shapes({});
  for (const bool colored : {true, false}) {
    const uint32_t set = shapes.begin_vertices(false);
    for (const Vec3& v : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) shapes.add_vertex(v);
    shapes.begin_shape();
    for (const auto& [color, triangle] : {std::pair{"", std::array{0u, 2u, 1u}}, {"#ff0000", {0u, 1u, 3u}}, {"#123456", {0u, 3u, 2u}}}) {
      if (colored) shapes.begin_group(color);
      shapes.add_triangle(set, triangle);
    }
  }
  std::vector<PartNode> nodes(2);
  nodes[0].name = "plate", nodes[0].shape = 0;
  nodes[1].name = "nut", nodes[1].shape = 1;
  return PartTree("a.step", std::move(shapes), std::move(nodes), uses);
}

CadFacts facts_of(const std::vector<CadShape>& shapes, double deflection = 0.01) { return {"OpenCASCADE", "key", "hash", deflection, 12, shapes}; }
CadShape closed_shape(double facets, std::optional<double> kernel, std::optional<double> sender = std::nullopt) {
  return {6, 0, true, facets, 10, kernel, sender};
}

std::vector<uint32_t> all_of(const PartTree& tree) {
  std::vector<uint32_t> out(tree.parts().size());
  std::iota(out.begin(), out.end(), 0);
  return out;
}

TEST_CASE("Parts of one shape and scale are one entry, under the first one's path, with the measures of one instance", "[cad]") {
  const PartTree tree =
      tree_of({{1, moved_by(0), "a"}, {0, moved_by(5), ""}, {1, moved_by(9), "b"}, {1, moved_by(3, 2), "large"}, {1, moved_by(7, -1), "mirrored"}});
  const std::vector<CadPart> parts = cad_parts(tree, all_of(tree), facts_of({closed_shape(1, 2), closed_shape(3, 4, 5)}));
  REQUIRE(parts.size() == 3);
  CHECK(parts[0].path == "/a");
  CHECK(parts[0].instances == 3);
  CHECK(parts[0].shape.facet_volume == 3);
  CHECK(parts[1].path == "/plate");
  CHECK(parts[1].shape.kernel_volume == 2);
  CHECK_FALSE(parts[1].shape.sender_volume);
  CHECK(parts[2].path == "/large");
  CHECK(parts[2].instances == 1);
  CHECK(parts[2].shape.facet_volume == 24);
  CHECK(*parts[2].shape.kernel_volume == 32);
  CHECK(*parts[2].shape.sender_volume == 40);
  CHECK(parts[2].shape.facet_area == Approx(40));
  CHECK(cad_parts(tree, {1}, facts_of({closed_shape(1, 2), closed_shape(3, 4)})).size() == 1);
}

TEST_CASE("A warning names the part and both volumes where any two of the three differ by more than 2 deflections on its area", "[cad]") {
  const auto warnings = [](const CadShape& shape) { return cad_warnings({{"/as1/nut", 8, shape}}, facts_of({})); };
  CHECK(warnings(closed_shape(100, 100.1, 99.95)).empty());
  CHECK(warnings(closed_shape(100, std::nullopt)).empty());
  CHECK_THAT(warnings(closed_shape(100, 100.21)).at(0),
             Contains("/as1/nut") && Contains("100.21") && Contains("the CAD kernel") && Contains("the facets"));
  CHECK_THAT(warnings(closed_shape(100, std::nullopt, 80)).at(0), Contains("80 by the sender") && Contains("100 by the facets"));
  CHECK_THAT(warnings(closed_shape(100, 100, 120)).at(0), Contains("120 by the sender"));
  CHECK(warnings(closed_shape(100, 100, 120)).size() == 1);
  CHECK(warnings(closed_shape(-100, 100)).empty());
  // An open shell has no volume.
  CHECK(warnings({6, 0, false, 3, 10, std::nullopt, std::nullopt}).empty());
  CHECK(warnings({6, 0, false, 3, 10, 100.0, std::nullopt}).empty());
  CHECK(warnings({6, 0, false, 3, 10, 100.0, 120.0}).size() == 1);
  CHECK(warnings(closed_shape(100, NAN)).size() == 1);
}

TEST_CASE("Of many parts whose volumes don't agree the first are named and the others counted", "[cad]") {
  const std::vector<CadPart> parts(50, {"/nut", 1, closed_shape(1, 2)});
  const auto warnings = cad_warnings(parts, facts_of({}));
  CHECK(warnings.size() < 50);
  CHECK_THAT(warnings.back(), Contains(fmt::format("{} ", 50 - (warnings.size() - 1))) && Contains("more"));
}

// What a body gets: the patches, and of each facet the number of its patch.
std::pair<std::vector<std::string>, std::vector<uint32_t>> patches_of(bool face_patches) {
  PartTree tree = tree_of({{0, moved_by(0), ""}, {1, moved_by(5), ""}, {0, moved_by(9), ""}});
  SurfaceFile file;
  std::vector<uint32_t> of_facet;
  uint32_t patch = ~0u;
  const PartGlob glob("");
  const FacetSink sink = [&](std::span<const Facet> facets) { of_facet.insert(of_facet.end(), facets.size(), patch); };
  const ReadOptions options = {.face_patches = face_patches, .enter_patch = [&](uint32_t p) { patch = p; }};
  FacetStream out(glob, sink, options);
  out.add_parts(tree, file, options);
  out.finish("a.step", file);
  return {file.patches, of_facet};
}

TEST_CASE("With face_patches the faces of a colour of their own are a patch behind their part's path, by the word for the colour", "[cad][patches]") {
  const auto [names, of_facet] = patches_of(true);
  REQUIRE(of_facet.size() == 9);
  std::vector<std::string> is;
  for (const uint32_t p : of_facet) is.push_back(names.at(p));
  CHECK(is ==
        std::vector<std::string>{"/plate", "/plate:red", "/plate:#123456", "/nut", "/nut", "/nut", "/plate#2", "/plate#2:red", "/plate#2:#123456"});
}

TEST_CASE("Without face_patches a part is one patch, whatever its faces' colours", "[cad][patches]") {
  const auto [names, of_facet] = patches_of(false);
  std::vector<std::string> is;
  for (const uint32_t p : of_facet) is.push_back(names.at(p));
  CHECK(is == std::vector<std::string>{"/plate", "/plate", "/plate", "/nut", "/nut", "/nut", "/plate#2", "/plate#2", "/plate#2"});
}

}  // namespace
}  // namespace teracell::mesher
