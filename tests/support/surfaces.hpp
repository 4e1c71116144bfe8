// Surfaces as bytes in every format, and what reading them gives: the fixture of the readers' tests.
#pragma once
#include <unistd.h>

#include "mesher/surface/read_facets.hpp"
#include "mesher/surface/reader.hpp"
#include "store/base/error.hpp"
#include "tests/support/descriptors.hpp"
#include "tests/support/gzip.hpp"

namespace teracell::surfaces {

using testing::gzipped;

using Facets = std::vector<std::array<Vec3, 3>>;

inline Facets tetrahedron() {
  const Vec3 o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 0.5};
  return {{o, y, x}, {o, x, z}, {o, z, y}, {x, y, z}};
}

template <class T>
inline std::string bytes_of(T v, std::endian order = std::endian::little) {
  std::string s(reinterpret_cast<const char*>(&v), sizeof v);
  if (order != std::endian::native) std::reverse(s.begin(), s.end());
  return s;
}

inline std::string binary_stl(const Facets& facets, std::string header = "made by a test") {
  header.resize(80);
  std::string s = header + bytes_of(static_cast<uint32_t>(facets.size()));
  for (const auto& facet : facets) {
    for (int i = 0; i < 3; ++i) s += bytes_of(0.f);
    for (const Vec3& v : facet)
      for (double x : v) s += bytes_of(static_cast<float>(x));
    s.append(2, char{0});
  }
  return s;
}

inline std::string ascii_stl(const Facets& facets, const std::string& name) {
  std::ostringstream s;
  s << "solid " << name << "\n";
  for (const auto& facet : facets) {
    s << " facet normal 0 0 0\n  outer loop\n";
    for (const Vec3& v : facet) s << "   vertex " << v[0] << " " << v[1] << " " << v[2] << "\n";
    s << "  endloop\n endfacet\n";
  }
  s << "endsolid " << name << "\n";
  return s.str();
}

inline const std::string kObj = "# a tetrahedron\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0.5\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

inline std::string ply_header(const std::string& format, const std::string& scalar = "float") {
  return "ply\nformat " + format + " 1.0\ncomment made by a test\nelement vertex 4\nproperty " + scalar + " x\nproperty " + scalar + " y\nproperty " +
         scalar + " z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n";
}
inline const std::string kPlyBody = "0 0 0\n1 0 0\n0 1 0\n0 0 0.5\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

template <class Scalar>
inline std::string binary_ply(std::endian order) {
  std::string s = ply_header(order == std::endian::little ? "binary_little_endian" : "binary_big_endian", sizeof(Scalar) == 4 ? "float" : "double");
  for (const Scalar x : {0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 0.5}) s += bytes_of(static_cast<Scalar>(x), order);
  for (const std::array<int32_t, 3> face : {std::array{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}) {
    s += '\3';
    for (int32_t i : face) s += bytes_of(i, order);
  }
  return s;
}

struct Result {
  mesher::SurfaceFile file;
  Facets facets;
  std::optional<uint64_t> expected;  // facets that the reader announced
};

inline Result read(const std::string& bytes, const std::string& part = "", const Budget& budget = {}, Background* helper = nullptr,
                   const std::string& units = "") {
  Result r;
  mesher::Input input("mesh", bytes);
  r.file = read_facets(input, part,
                       [&](std::span<const mesher::Facet> some) {
                         for (const mesher::Facet& f : some) r.facets.push_back(f.vertex);
                       },
                       {.budget = budget, .units = units, .helper = helper, .expect = [&](uint64_t facets) {
                          if (r.expected || !r.facets.empty()) throw std::logic_error("announced late");
                          r.expected = facets;
                        }});
  return r;
}

// The message of the InputError; empty when there was none.
inline std::string refusal(const std::string& bytes, const std::string& part = "") {
  try {
    read(bytes, part);
    return "";
  } catch (const InputError& e) {
    return e.what();
  }
}

inline std::string replaced(std::string text, const std::string& old, const std::string& by) {
  const size_t at = text.find(old);
  REQUIRE(at != std::string::npos);
  return text.replace(at, old.size(), by);
}

// The same coordinate through a text format.
inline double through_obj(const std::string& word) { return read("v 0 0 0\nv 1 0 0\nv 0 1 " + word + "\nf 1 2 3\n").facets[0][2][2]; }
inline std::string one_facet_stl(const std::string& word) {
  return "solid\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 " + word + "\nendloop\nendfacet\nendsolid\n";
}
inline double through_stl(const std::string& word) { return read(one_facet_stl(word)).facets[0][2][2]; }

class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& bytes) : path(std::filesystem::temp_directory_path() / ("teracell-facets-" + std::to_string(getpid()))) {
    std::ofstream(path, std::ios::binary) << bytes;
  }
  ~TemporaryFile() { std::filesystem::remove(path); }
  const std::filesystem::path path;
};

}  // namespace teracell::surfaces
