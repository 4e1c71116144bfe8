// glTF and GLB.
#include "tests/support/assembly_files.hpp"

using namespace teracell;
using namespace teracell::mesher;
using namespace teracell::surfaces;
using Catch::Contains;

namespace {

const std::string kOneNode = R"("nodes":[{"mesh":0}])";

std::string base64(const std::string& bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t bits = 0;
    for (size_t k = 0; k < 3; ++k) bits = bits << 8 | (i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0);
    for (size_t k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : kDigits[bits >> (18 - 6 * k) & 63];
  }
  return out;
}

}  // namespace

TEST_CASE("glTF: facets of the default scene, in metres, single precision where nothing moves them") {
  const Result r = read(gltf(kOneNode));
  CHECK(r.facets == tetrahedron());
  CHECK(r.file.float32);
  CHECK(r.file.format == "GLB");
  CHECK(r.file.unit == "m");
  CHECK(r.file.patches == std::vector<std::string>{"/tet"});
  const std::string two = R"("nodes":[{"mesh":0,"name":"a"},{"mesh":0,"name":"b","translation":[1,0,0]}],"scenes":[{"nodes":[0]},{"nodes":[1]}])";
  CHECK(read(gltf(two)).file.patches == std::vector<std::string>{"/a"});
  const Result second = read(gltf(two + R"(,"scene":1)"));
  CHECK(second.file.patches == std::vector<std::string>{"/b"});
  CHECK_FALSE(second.file.float32);
  const Result mm = read(gltf(kOneNode), "", {}, nullptr, "mm");
  CHECK(mm.facets[3][2] == Vec3{0, 0, 500});
  CHECK_FALSE(mm.file.float32);
}

TEST_CASE("glTF: nodes within nodes; quaternions, scales, mirrors, matrices; translations are converted") {
  const Result r = read(gltf(R"("nodes":[{"name":"root","translation":[0,0,2],"children":[1,2]},
      {"name":"x","mesh":0,"rotation":[0,0,2,2],"scale":[3,1,1]},{"name":"x","mesh":0,"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 4,0,0,1]}])"),
                        "", {}, nullptr, "cm");
  REQUIRE(r.facets.size() == 8);
  CHECK(r.file.patches == std::vector<std::string>{"/root/x", "/root/x#2"});
  const double c = 1 - 2 * (2 / std::sqrt(8.0)) * (2 / std::sqrt(8.0));
  for (size_t i = 0; i < 4; ++i) {
    const auto f = tetrahedron()[i];
    for (size_t k = 0; k < 3; ++k) {
      CHECK(r.facets[i][k][0] == Approx(100 * (c * 3 * f[k][0] - f[k][1])).margin(1e-12));
      CHECK(r.facets[i][k][1] == Approx(300 * f[k][0]).margin(1e-12));
      CHECK(r.facets[i][k][2] == 100 * f[k][2] + 200);
      const Vec3& v = f[k == 0 ? 0 : 3 - k];
      CHECK(r.facets[4 + i][k] == Vec3{400 - 100 * v[0], 100 * v[1], 100 * v[2] + 200});
    }
  }
}

TEST_CASE("glTF: strips, fans, and triangles without indices; points and lines are left out") {
  const auto with = [](int mode) {
    return R"({"asset":{"version":"2.0"},"accessors":[{"bufferView":0,"componentType":5126,"count":5,"type":"VEC3"}],"bufferViews":[{"buffer":0,"byteLength":60}],
      "buffers":[{"byteLength":60}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":)" +
           std::to_string(mode) + "}]}]}";
  };
  std::string buffer;
  for (int i = 0; i < 5; ++i) buffer += bytes_of(static_cast<float>(i)) + bytes_of(static_cast<float>(i * i)) + bytes_of(0.f);
  const auto triangles = [&](int mode) {
    std::vector<std::array<double, 3>> out;
    for (const auto& f : read(glb(with(mode), buffer)).facets) out.push_back({f[0][0], f[1][0], f[2][0]});
    return out;
  };
  using T = std::vector<std::array<double, 3>>;
  CHECK(triangles(4) == T{{0, 1, 2}});
  CHECK(triangles(5) == T{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}});
  CHECK(triangles(6) == T{{1, 2, 0}, {2, 3, 0}, {3, 4, 0}});
  CHECK_THAT(refusal(glb(with(1), buffer)), Contains("holds no facet"));
  CHECK_THAT(refusal(glb(with(7), buffer)), Contains("meshes[0]: expected a mode of 0 to 6, found 7"));
}

TEST_CASE("glTF: sparse accessors, numbers that are integers, strides, data in the text") {
  const std::string buffer = tetrahedron_buffer() + bytes_of(uint16_t{3}) + std::string(2, '\0') + bytes_of(0.f) + bytes_of(0.f) + bytes_of(2.f);
  const std::string sparse =
      replaced(replaced(gltf_json(kOneNode), R"("type":"VEC3")",
                        R"("type":"VEC3","sparse":{"count":1,"indices":{"bufferView":2,"componentType":5123},"values":{"bufferView":3}})"),
               R"("byteLength":24})", R"("byteLength":24},{"buffer":0,"byteOffset":72,"byteLength":2},{"buffer":0,"byteOffset":76,"byteLength":12})");
  CHECK(read(glb(sparse, buffer)).facets[3][2] == Vec3{0, 0, 2});

  std::string bytes;  // x, y, z and a byte between, as 8-bit numbers with a sign
  for (const int8_t v : {0, 0, 0, 9, 127, 0, 0, 9, 0, 127, 0, 9, 0, 0, -128, 9}) bytes += bytes_of(v);
  bytes += tetrahedron_buffer().substr(48);
  std::string quantized = R"({"asset":{"version":"2.0"},"extensionsRequired":["KHR_mesh_quantization"],
    "accessors":[{"bufferView":0,"componentType":5120,"normalized":true,"count":4,"type":"VEC3"},{"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}],
    "bufferViews":[{"buffer":0,"byteLength":15,"byteStride":4},{"buffer":0,"byteOffset":16,"byteLength":24}],"buffers":[{"byteLength":40}],)" +
                          kTetrahedronMesh + "," + kOneNode + "}";
  const Result r = read(glb(quantized, bytes));
  CHECK(r.facets[3] == std::array<Vec3, 3>{{{1, 0, 0}, {0, 1, 0}, {0, 0, -1}}});
  CHECK_FALSE(r.file.float32);

  const std::string indices =
      replaced(replaced(gltf_json(kOneNode), R"("type":"SCALAR")",
                        R"("type":"SCALAR","sparse":{"count":1,"indices":{"bufferView":2,"componentType":5121},"values":{"bufferView":3}})"),
               R"("byteLength":24})", R"("byteLength":24},{"buffer":0,"byteOffset":72,"byteLength":1},{"buffer":0,"byteOffset":74,"byteLength":2})");
  const std::string replacing = tetrahedron_buffer() + std::string(1, '\2') + std::string(1, '\0') + bytes_of(uint16_t{3});
  CHECK(read(glb(indices, replacing)).facets[0] == std::array<Vec3, 3>{tetrahedron()[0][0], tetrahedron()[0][1], Vec3{0, 0, 0.5}});
  CHECK_THAT(refusal(glb(replaced(indices, R"("componentType":5121})", R"("componentType":5126})"), replacing + "ab")),
             Contains("accessors[1]: sparse: expected indices of 8, 16 or 32 bits without a sign"));

  const std::string text = replaced(gltf_json(kOneNode), R"({"byteLength":72})",
                                    R"({"byteLength":72,"uri":"data:application/octet-stream;base64,)" + base64(tetrahedron_buffer()) + "\"}");
  const Result in_text = read(text);
  CHECK(in_text.facets == tetrahedron());
  CHECK(in_text.file.format == "glTF");
}

TEST_CASE("glTF: what is wrong is named with its place") {
  const auto json = [](const std::string& old, const std::string& by) { return glb(replaced(gltf_json(kOneNode), old, by), tetrahedron_buffer()); };
  CHECK_THAT(refusal(json(R"("count":12)", R"("count":13)")),
             Contains("accessors[1]: expected 13 elements of 2 bytes, 2 apart, within the 24 bytes of bufferViews[1] from 0 on"));
  CHECK_THAT(refusal(json(R"("count":4,)", R"("count":4294967296,)")), Contains("accessors[0]: expected 4294967296 elements"));
  CHECK_THAT(refusal(json(R"("byteOffset":48,)", R"("byteOffset":60,)")),
             Contains("buffers[0]: cut short: expected 24 bytes from 60 on, found 72 bytes in all"));
  CHECK_THAT(refusal(json(R"("indices":1)", R"("indices":7)")), Contains("expected the number of an accessor, found 7 of 2"));
  CHECK_THAT(refusal(json(R"("POSITION":0)", R"("POSITION":1)")), Contains("accessors[1]: expected the type VEC3, found 'SCALAR'"));
  CHECK_THAT(refusal(json(R"("version":"2.0")", R"("version":"1.0")")), Contains("expected version 2 of glTF, found \"1.0\""));
  CHECK_THAT(refusal(json(R"("nodes":[)", R"("extensionsRequired":["KHR_draco_mesh_compression"],"nodes":[)")),
             Contains("without the extension 'KHR_draco_mesh_compression'"));
  CHECK_THAT(refusal(gltf(R"("nodes":[{"mesh":0,"children":[1]},{"mesh":0,"children":[1]}])")), Contains("node 1 has several"));
  CHECK_THAT(refusal(gltf(R"("scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"children":[0]}])")), Contains("node 0 has several"));
  CHECK_THAT(refusal(gltf(R"("nodes":[{"mesh":3}])")), Contains("expected the number of a mesh, found 3 of 1"));
  CHECK_THAT(refusal(gltf(R"("nodes":[{"mesh":0,"matrix":[1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]}])")),
             Contains("nodes[0]: matrix: expected a matrix whose last row is 0 0 0 1"));
  CHECK_THAT(refusal(gltf(R"("nodes":[{"mesh":0,"rotation":[0,0,0,0]}])")), Contains("nodes[0]: rotation: expected a quaternion other than 0 0 0 0"));
  CHECK_THAT(refusal(gltf(R"("nodes":[{"mesh":0,"rotation":[1e155,0,0,1e155]}])")), Contains("rotation: expected a quaternion whose length is from"));
  CHECK_THAT(refusal(gltf(R"("nodes":[{"mesh":0,"translation":[1,0,0],"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}])")),
             Contains("nodes[0]: matrix: expected no translation beside it"));
  CHECK_THAT(refusal(json(R"({"byteLength":72})", R"({"byteLength":90})")), Contains("buffers[0]: cut short: expected 90 bytes, found 72"));
  CHECK(read(gltf(R"("nodes":[{"mesh":0},{"mesh":7},{"children":[9]}],"scenes":[{"nodes":[0]},{"nodes":[1,2]}])")).facets == tetrahedron());
  CHECK_THAT(refusal(gltf(R"("nodes":[{"mesh":0,"scale":[1e300,1,1]}])")), Contains("part '/tet': a vertex where the part stands"));
  const auto beside = [&](const std::string& uri) {
    return refusal(replaced(gltf_json(kOneNode), R"({"byteLength":72})", R"({"byteLength":72,"uri":")" + uri + "\"}"));
  };
  CHECK_THAT(beside("../a.bin"), Contains("buffers[0]: expected a file in the folder of this one, or below it, found '../a.bin'"));
  CHECK_THAT(beside("/etc/passwd"), Contains("found '/etc/passwd'"));
  CHECK_THAT(beside("%2e%2e/a.bin"), Contains("expected a file in the folder of this one"));
  CHECK_THAT(beside("a.bin"), Contains("the file 'a.bin' is missing"));
  CHECK_THAT(refusal(gltf_json(kOneNode)), Contains("the buffer is missing"));
  CHECK_THAT(beside("data:application/octet-stream;base64,AA"), Contains("cut short"));
}

TEST_CASE("glTF: cut short anywhere, or with any byte changed, it is refused or read, and nothing else") {
  const std::string whole = gltf(kOneNode);
  for (size_t bytes = 1; bytes < whole.size(); bytes += 3) CHECK_FALSE(refusal(std::string(whole.data(), bytes)).empty());
  for (size_t at = 0; at < whole.size(); at += 2) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x15);
    CHECK_NOTHROW(refusal(damaged));
  }
}
