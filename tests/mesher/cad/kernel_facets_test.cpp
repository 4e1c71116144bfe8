// The facets that the CAD kernel wrote are read whole, and refused when anything of them is missing.
#include "mesher/cad/kernel_facets.hpp"

#include <fcntl.h>

#include <cstring>
#include <fstream>

#include <nlohmann/json.hpp>

#include "mesher/cad/facets_file.hpp"
#include "store/base/error.hpp"
#include "tests/support/meshed.hpp"

namespace teracell::mesher {
namespace {

using Catch::Contains;
using testing::TempFolder;

const std::vector<Vec3> kCorners = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}};
const std::vector<std::array<uint32_t, 3>> kFaces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

nlohmann::json tetrahedron() {
  return {{"vertices", 4},
          {"groups", {{{"color", ""}, {"triangles", 3}}, {{"color", "#ff0000"}, {"triangles", 1}}}},
          {"faces_without_facets", 0},
          {"closed", true},
          {"facet_volume", 4.0 / 3},
          {"facet_area", 10.0},
          {"kernel_volume", 1.5}};
}

// A file of two shapes.
std::string written(const std::vector<nlohmann::json>& shapes = {tetrahedron(), tetrahedron()}) {
  std::string out(kFacetsMagic);
  const auto put = [&](const void* data, size_t bytes) { out.append(static_cast<const char*>(data), bytes); };
  const std::string head = nlohmann::json({{"shapes", shapes}}).dump();
  const uint64_t size = head.size();
  put(&size, sizeof size);
  out += head;
  for (size_t i = 0; i < shapes.size(); ++i) put(kCorners.data(), 4 * sizeof(Vec3)), put(kFaces.data(), 4 * sizeof kFaces[0]);
  return out;
}

struct Found {
  std::vector<CadShape> facts;
  std::vector<std::vector<std::array<Vec3, 3>>> facets;  // of each shape
  std::vector<std::vector<ColorGroup>> groups;
};

Found read(const std::string& bytes, const Factor& factor = {}, size_t shapes_expected = 2) {
  const TempFolder folder;
  const auto path = folder.path() / "facets";
  std::ofstream(path, std::ios::binary) << bytes;
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  Shapes shapes({});
  Found out;
  out.facts.resize(shapes_expected);
  out.facts[0].sender_volume = 3;
  read_kernel_facets(file, bytes.size(), "a.step", factor, shapes, out.facts);
  for (uint32_t i = 0; i < shapes_expected; ++i) {
    out.groups.push_back(shapes.groups(i));
    auto& facets = out.facets.emplace_back();
    shapes.for_each(i, [&](const Vec3& a, const Vec3& b, const Vec3& c) { facets.push_back({a, b, c}); });
  }
  return out;
}

std::string with(const nlohmann::json& change) {
  nlohmann::json first = tetrahedron();
  first.merge_patch(change);
  return written({first, tetrahedron()});
}

TEST_CASE("Facets, their groups and what is said of them are those that were written", "[cad]") {
  const Found found = read(written());
  for (const auto& facets : found.facets) {
    REQUIRE(facets.size() == 4);
    for (size_t f = 0; f < 4; ++f)
      for (size_t k = 0; k < 3; ++k) CHECK(facets[f][k] == kCorners[kFaces[f][k]]);
  }
  REQUIRE(found.groups[0].size() == 2);
  CHECK((found.groups[0][1].color == "#ff0000" && found.groups[0][1].facets == 1));
  CHECK(
      (found.facts[0].closed && found.facts[0].facet_volume == 4.0 / 3 && found.facts[0].kernel_volume == 1.5 && found.facts[0].sender_volume == 3));
}

TEST_CASE("Another unit moves vertices once and scales volumes and areas", "[cad]") {
  const Found found = read(written(), factor("mm", "um"));
  CHECK(found.facets[1][0][1] == Vec3{0, 2000, 0});
  CHECK(found.facts[0].kernel_volume == 1.5e9);
  CHECK(found.facts[0].sender_volume == 3e9);
  CHECK(found.facts[0].facet_area == 1e7);
}

TEST_CASE("Facets that are cut anywhere, or longer than they say, are refused", "[cad]") {
  const std::string whole = written();
  for (size_t size = 0; size < whole.size(); ++size) {
    INFO(size);
    CHECK_THROWS_AS(read(whole.substr(0, size)), FormatError);
  }
  CHECK_THROWS_WITH(read(whole + "x"), Contains("a.step") && Contains("nothing more"));
}

TEST_CASE("A flipped bit gives an error or other facets, never a crash", "[cad]") {
  const std::string whole = written();
  size_t refused = 0;
  for (size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    std::string damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ 1 << bit % 8);
    try {
      read(damaged);
    } catch (const FormatError&) {
      ++refused;
    } catch (const InputError&) {
      ++refused;
    }
  }
  CHECK(refused > whole.size());
}

TEST_CASE("Numbers that the file can't hold are refused before memory is taken for them", "[cad]") {
  CHECK_THROWS_AS(read(with({{"vertices", 1ull << 40}})), FormatError);
  CHECK_THROWS_AS(read(with({{"groups", {{{"color", ""}, {"triangles", 1ull << 40}}}}})), FormatError);
  CHECK_THROWS_AS(read(with({{"vertices", 3}})), FormatError);
  CHECK_THROWS_AS(read(with({{"vertices", -1}})), FormatError);
  CHECK_THROWS_AS(read(written(), {}, 1), FormatError);
}

}  // namespace
}  // namespace teracell::mesher
