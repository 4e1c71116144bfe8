// What the run of a part found comes back as it was, with what the CAD kernel said.
#include "mesher/run/part_found.hpp"

#include "store/base/error.hpp"
#include "tests/support/test.hpp"

namespace teracell::mesher {
namespace {

SurfacesFound found_of_step() {
  SurfacesFound found;
  found.scene.materials = {{"air", "#00000000"}, {"steel", "#102030"}};
  for (const char* file : {"a.stl", "b.step"}) {
    SceneBody& body = found.scene.bodies.emplace_back();
    body.name = body.mesh_text = file, body.mesh = file;
  }
  found.bodies.bodies.resize(2);
  found.bodies.bodies[0].file.format = "STL";
  SurfaceFile& file = found.bodies.bodies[1].file;
  file.format = "STEP";
  file.cad = std::make_shared<const CadFacts>(CadFacts{"OpenCASCADE 7.6.3", "00ff", "ff00", 0.125, 12.5, {CadShape{6, 1, true, 2, 3, 4.0, 5.0}}});
  file.cad_parts = {{"/as1/nut", 8, {10, 0, true, 291.5, 384.25, 291.75, std::nullopt}}, {"/as1/ナット", 1, {3, 2, false, -1, 2, std::nullopt, 0.0}}};
  found.counts.resize(2);
  return found;
}

TEST_CASE("What the CAD kernel said of the parts taken goes to whoever merges", "[parts][cad]") {
  const SurfacesFound found = found_of_step();
  CastTotals totals;
  const Bytes bytes = encode_found(totals, &found);
  const PartFound read = decode_found(bytes, "found");
  REQUIRE(read.surfaces);
  CHECK_FALSE(read.surfaces->bodies.bodies[0].file.cad);
  const SurfaceFile& file = read.surfaces->bodies.bodies[1].file;
  REQUIRE(file.cad);
  CHECK(file.cad->kernel == "OpenCASCADE 7.6.3");
  CHECK(file.cad->key == "00ff");
  CHECK(file.cad->hash == "ff00");
  CHECK(file.cad->deflection == 0.125);
  CHECK(file.cad->angle == 12.5);
  REQUIRE(file.cad_parts.size() == 2);
  for (size_t i = 0; i < 2; ++i) {
    const CadPart &is = file.cad_parts[i], &was = found.bodies.bodies[1].file.cad_parts[i];
    CHECK(is.path == was.path);
    CHECK(is.instances == was.instances);
    CHECK(is.shape.faces == was.shape.faces);
    CHECK(is.shape.faces_without_facets == was.shape.faces_without_facets);
    CHECK(is.shape.closed == was.shape.closed);
    CHECK(is.shape.facet_volume == was.shape.facet_volume);
    CHECK(is.shape.facet_area == was.shape.facet_area);
    CHECK(is.shape.kernel_volume == was.shape.kernel_volume);
    CHECK(is.shape.sender_volume == was.shape.sender_volume);
  }
  CHECK(encode_found(read.totals, &*read.surfaces) == bytes);
}

TEST_CASE("What was found, cut at any byte, is refused", "[parts][cad]") {
  const SurfacesFound found = found_of_step();
  const Bytes bytes = encode_found({}, &found);
  for (size_t i = 0; i < bytes.size(); ++i) {
    const Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(i));
    INFO(i);
    REQUIRE_THROWS_AS(decode_found(cut, "found"), FormatError);
  }
}

}  // namespace
}  // namespace teracell::mesher
