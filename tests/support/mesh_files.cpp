// The mesh files of shapes.hpp. Coordinates are written so that they read back to the same bits.
#include "mesher/surface/read_facets.hpp"
#include "tests/support/shapes.hpp"

namespace teracell::shapes {
namespace {

void write_file(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw std::runtime_error("can't write " + path.string());
}

// The bytes of an integer or a float in the order asked for.
template <class Number>
void append(std::string& bytes, Number value, Encoding encoding) {
  char raw[sizeof(Number)];
  std::memcpy(raw, &value, sizeof raw);
  std::string text(raw, sizeof raw);
  if ((std::endian::native == std::endian::big) != (encoding == Encoding::kBigEndian)) {
    text.assign(text.rbegin(), text.rend());
  }
  bytes += text;
}

// Vertices told apart by their coordinates, in the order of their first use.
struct Indexed {
  std::vector<Vec3> vertices;
  std::vector<std::array<uint32_t, 3>> facets;

  explicit Indexed(const Facets& all) {
    std::map<Vec3, uint32_t> index;
    for (const mesher::Facet& f : all) {
      std::array<uint32_t, 3> corners;
      for (int i = 0; i < 3; ++i) {
        const auto [it, is_new] = index.try_emplace(f.vertex[i], static_cast<uint32_t>(vertices.size()));
        if (is_new) vertices.push_back(f.vertex[i]);
        corners[i] = it->second;
      }
      facets.push_back(corners);
    }
  }
};

}  // namespace

void write_stl(const std::filesystem::path& path, const Facets& facets, Encoding encoding, const std::string& name) {
  std::string out;
  if (encoding == Encoding::kAscii) {
    out += fmt::format("solid {}\n", name);
    for (const mesher::Facet& f : facets) {
      out += "facet normal 0 0 0\n  outer loop\n";
      for (const Vec3& v : f.vertex) {
        out += fmt::format("    vertex {} {} {}\n", static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]));
      }
      out += "  endloop\nendfacet\n";
    }
    out += fmt::format("endsolid {}\n", name);
  } else {
    out = name;
    out.resize(80, ' ');
    append(out, static_cast<uint32_t>(facets.size()), Encoding::kLittleEndian);
    for (const mesher::Facet& f : facets) {
      for (int i = 0; i < 3; ++i) append(out, 0.0f, Encoding::kLittleEndian);
      for (const Vec3& v : f.vertex) {
        for (const double x : v) append(out, static_cast<float>(x), Encoding::kLittleEndian);
      }
      append(out, uint16_t{0}, Encoding::kLittleEndian);
    }
  }
  write_file(path, out);
}

void write_obj(const std::filesystem::path& path, const Facets& facets) {
  const Indexed mesh(facets);
  std::string out;
  for (const Vec3& v : mesh.vertices) out += fmt::format("v {} {} {}\n", v[0], v[1], v[2]);
  for (const auto& f : mesh.facets) out += fmt::format("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1);
  write_file(path, out);
}

void write_ply(const std::filesystem::path& path, const Facets& facets, Encoding encoding, bool doubles) {
  const Indexed mesh(facets);
  const char* format = encoding == Encoding::kAscii ? "ascii" : encoding == Encoding::kLittleEndian ? "binary_little_endian" : "binary_big_endian";
  const char* type = doubles ? "double" : "float";
  std::string out = fmt::format(
      "ply\nformat {} 1.0\nelement vertex {}\nproperty {} x\nproperty {} y\nproperty {} z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      format, mesh.vertices.size(), type, type, type, mesh.facets.size());
  const bool ascii = encoding == Encoding::kAscii;
  for (const Vec3& v : mesh.vertices) {
    for (const double x : v) {
      const float single = static_cast<float>(x);
      if (ascii) {
        out += doubles ? fmt::format("{} ", x) : fmt::format("{} ", single);
      } else if (doubles) {
        append(out, x, encoding);
      } else {
        append(out, single, encoding);
      }
    }
    if (ascii) out += '\n';
  }
  for (const auto& f : mesh.facets) {
    if (ascii) {
      out += fmt::format("3 {} {} {}\n", f[0], f[1], f[2]);
    } else {
      append(out, uint8_t{3}, encoding);
      for (const uint32_t corner : f) append(out, static_cast<int32_t>(corner), encoding);
    }
  }
  write_file(path, out);
}

Facets facets_in(const std::filesystem::path& path) {
  Facets all;
  mesher::read_facets(path, "", [&](std::span<const mesher::Facet> facets) { all.insert(all.end(), facets.begin(), facets.end()); });
  return all;
}

}  // namespace teracell::shapes
