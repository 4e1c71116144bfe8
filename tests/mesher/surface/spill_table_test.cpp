// Vertices that don't fit into the memory given: the same facets.
#include "mesher/surface/spill_table.hpp"

#include "tests/support/surfaces.hpp"

using namespace teracell;
using namespace teracell::mesher;
using namespace teracell::surfaces;
using Catch::Contains;

namespace {

const Budget kTiny{1, std::filesystem::temp_directory_path()};
constexpr uint64_t kMany = 3 * VertexTable::kLeastBytes / sizeof(Vec3);  // vertices, three times what such a table holds

Vec3 vertex(uint64_t i) { return {static_cast<double>(i % 1000), static_cast<double>(i / 1000), static_cast<double>(i * i % 97)}; }

// Faces of three and more: next to each other, at both ends of the file, anywhere.
std::vector<std::vector<uint64_t>> some_faces(uint64_t vertices, uint64_t count, std::mt19937_64& random) {
  std::vector<std::vector<uint64_t>> faces(count);
  for (uint64_t f = 0; f < count; ++f) {
    const uint64_t corners = 3 + random() % 4;
    for (uint64_t i = 0; i < corners; ++i) {
      const uint64_t at_ends = i % 2 ? vertices - 1 - i : i;
      faces[f].push_back(f % 3 == 0 ? (f + i) % vertices : f % 3 == 1 ? at_ends : random() % vertices);
    }
  }
  return faces;
}

template <class T>
std::string binary(T v, bool little) {
  return bytes_of(v, little ? std::endian::little : std::endian::big);
}

std::string ply(const std::string& format, const std::vector<std::vector<uint64_t>>& faces) {
  std::string text = fmt::format(
      "ply\nformat {} 1.0\nelement vertex {}\nproperty double x\nproperty float y\nproperty int z\nelement face {}\n"
      "property list uchar uint vertex_indices\nend_header\n",
      format, kMany, faces.size());
  const bool little = format == "binary_little_endian";
  for (uint64_t i = 0; i < kMany; ++i) {
    const Vec3 v = vertex(i);
    text += format == "ascii" ? fmt::format("{} {} {}\n", v[0], v[1], v[2])
                              : binary(v[0], little) + binary(static_cast<float>(v[1]), little) + binary(static_cast<int32_t>(v[2]), little);
  }
  for (const auto& face : faces) {
    text += format == "ascii" ? fmt::format("{}", face.size()) : std::string(1, static_cast<char>(face.size()));
    for (const uint64_t i : face) text += format == "ascii" ? fmt::format(" {}", i) : binary(static_cast<uint32_t>(i), little);
    if (format == "ascii") text += '\n';
  }
  return text;
}

}  // namespace

TEST_CASE("A vertex table gives every vertex back, whatever is asked for while it grows") {
  std::mt19937_64 random(1);
  for (const uint64_t every : {1, 100}) {
    VertexTable table(kTiny);
    bool same = true;
    for (uint64_t i = 0; i < kMany; ++i) {
      table.push_back(vertex(i));
      if (i % every != 0 && i % 20000 > 100) continue;
      const uint64_t j = every == 1 ? i - i % 64 : random() % (i + 1);
      same &= table[j] == vertex(j) && table[i] == vertex(i);
    }
    CHECK(table.size() == kMany);
    for (uint64_t i = 0; i < kMany; ++i) same &= table[i] == vertex(i);
    CHECK(same);
  }
}

TEST_CASE("OBJ: the facets do not depend on the memory given") {
  std::mt19937_64 random(2);
  std::string text;
  for (uint64_t declared = 0; declared < kMany;) {  // faces between the vertices, and behind them
    for (const uint64_t stop = declared + 20000; declared < stop; ++declared) {
      const Vec3 v = vertex(declared);
      text += fmt::format("v {} {} {}\n", v[0], v[1], v[2]);
    }
    for (const auto& face : some_faces(declared, 3000, random)) {
      text += 'f';
      for (const uint64_t i : face) text += random() % 2 ? fmt::format(" {}", i + 1) : fmt::format(" -{}", declared - i);
      text += '\n';
    }
  }
  CHECK((read(text, "", kTiny).facets == read(text).facets));
}

TEST_CASE("PLY: the facets do not depend on the memory given") {
  std::mt19937_64 random(3);
  const auto faces = some_faces(kMany, 20000, random);
  const Facets expected = [&] {
    Facets out;
    for (const auto& face : faces)
      for (size_t i = 2; i < face.size(); ++i) out.push_back({vertex(face[0]), vertex(face[i - 1]), vertex(face[i])});
    return out;
  }();
  for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    const std::string text = ply(format, faces);
    CHECK((read(text, "", kTiny).facets == expected));
    CHECK((read(text).facets == expected));
  }
}

TEST_CASE("A vertex table needs its folder only when it is full, and closes its file") {
  const size_t before = testing::open_descriptors();
  const Budget nowhere{1, "/nowhere"};
  CHECK(read(kObj, "", nowhere).facets == tetrahedron());
  std::string text;
  for (uint64_t i = 0; i < kMany; ++i) text += "v 1 2 3\n";
  try {
    read(text + kObj, "", nowhere);
    FAIL("no error");
  } catch (const IoError& e) {
    CHECK_THAT(e.what(), Contains("/nowhere: no folder for temporary files"));
  }
  CHECK(read(text + kObj, "", kTiny).facets.size() == 4);
  CHECK_THROWS_AS(read(text + "f 0 0 0\n", "", kTiny), InputError);
  CHECK(testing::open_descriptors() == before);
}
