#include "tools/sample/solid.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <string>

#include "mesher/scene/scene.hpp"
#include "store/base/output_file.hpp"
#include "store/grid/vec3.hpp"

namespace teracell::sample {
namespace {

// A regular polygon of 2 * `rungs` sides about `centre`, counter-clockwise from u towards v.
Section polygon(const Vec3& centre, const Vec3& u, const Vec3& v, double radius, int rungs) {
  const auto corner = [&](int i) {
    const mesher::Matrix turn = mesher::rotation({0, 0, 1}, (i + 0.5) * 180 / rungs);
    const double c = turn[0] * radius, s = turn[4] * radius;
    return Vec3{centre[0] + c * u[0] + s * v[0], centre[1] + c * u[1] + s * v[1], centre[2] + c * u[2] + s * v[2]};
  };
  Section section;
  for (int i = 0; i < rungs; ++i) {
    section.low.push_back(corner(rungs + i));
    section.high.push_back(corner(rungs - 1 - i));
  }
  return section;
}

Vec3 unit(const Vec3& a) {
  const double size = length(a);
  return {a[0] / size, a[1] / size, a[2] / size};
}

void put_le(std::string& out, uint32_t word) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<char>(word >> shift & 0xff));
}

}  // namespace

void Solid::loft(const std::vector<Section>& sections, bool ring) {
  const size_t rungs = sections[0].low.size(), sides = 2 * rungs;
  const auto outline = [&](size_t k, size_t j) -> const Vec3& {
    const Section& s = sections[k % sections.size()];
    return j % sides < rungs ? s.low[j % sides] : s.high[sides - 1 - j % sides];
  };
  for (size_t k = 0; k + 1 < sections.size() + ring; ++k)
    for (size_t j = 0; j < sides; ++j) quad(outline(k, j), outline(k, j + 1), outline(k + 1, j + 1), outline(k + 1, j));
  if (ring) return;
  const Section &first = sections.front(), &last = sections.back();
  for (size_t j = 0; j + 1 < rungs; ++j) {
    quad(first.low[j], first.high[j], first.high[j + 1], first.low[j + 1]);
    quad(last.low[j], last.low[j + 1], last.high[j + 1], last.high[j]);
  }
}

void Solid::box(const Vec3& lo, const Vec3& hi) {
  const auto at = [&](double z) { return Section{{{lo[0], lo[1], z}, {hi[0], lo[1], z}}, {{lo[0], hi[1], z}, {hi[0], hi[1], z}}}; };
  loft({at(lo[2]), at(hi[2])});
}

void Solid::bar(const Vec3& from, const Vec3& to, double radius_from, double radius_to) {
  const Vec3 along = unit({to[0] - from[0], to[1] - from[1], to[2] - from[2]});
  const Vec3 u = unit(cross(std::abs(along[2]) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0}, along)), v = cross(along, u);
  loft({polygon(from, u, v, radius_from, 4), polygon(to, u, v, radius_to, 4)});
}

void Solid::capsule(const Vec3& centre, double half, double radius) {
  constexpr int kRungs = 12,
                kCircles = 9;  // circles of latitude on a hemisphere; the outermost leaves a small flat cap
  std::vector<Section> sections;
  for (int i = -kCircles; i <= kCircles; ++i) {
    if (i == 0) continue;
    const mesher::Matrix turn = mesher::rotation({0, 0, 1}, (std::abs(i) - 1) * 80.0 / (kCircles - 1));
    const double x = half + radius * turn[4];
    sections.push_back(polygon({centre[0] + (i < 0 ? -x : x), centre[1], centre[2]}, {0, 1, 0}, {0, 0, 1}, radius * turn[0], kRungs));
  }
  loft(sections);
}

void Solid::quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto corner = [](const Vec3& p) {  // -0 becomes 0
    return Corner{static_cast<float>(p[0]) + 0.0f, static_cast<float>(p[1]) + 0.0f, static_cast<float>(p[2]) + 0.0f};
  };
  facets_.push_back({corner(a), corner(b), corner(c)});
  facets_.push_back({corner(a), corner(c), corner(d)});
}

void Solid::write_stl(const std::filesystem::path& path) const {
  std::string bytes = "teracell sample";  // must not begin with "solid", which is how ASCII STL does
  bytes.resize(80, ' ');
  bytes.reserve(84 + 50 * facets_.size());
  put_le(bytes, static_cast<uint32_t>(facets_.size()));
  for (const auto& [a, b, c] : facets_) {
    const Vec3 ab = {double{b[0]} - a[0], double{b[1]} - a[1], double{b[2]} - a[2]};
    const Vec3 ac = {double{c[0]} - a[0], double{c[1]} - a[1], double{c[2]} - a[2]};
    for (const double x : unit(cross(ab, ac))) put_le(bytes, std::bit_cast<uint32_t>(static_cast<float>(x) + 0.0f));
    for (const Corner& corner : {a, b, c})
      for (const float x : corner) put_le(bytes, std::bit_cast<uint32_t>(x));
    bytes.append(2, '\0');
  }
  write_whole(path, bytes);
}

void write_whole(const std::filesystem::path& path, const std::string& bytes) {
  OutputFile file(path);
  file.append({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()});
  file.commit();
}

}  // namespace teracell::sample
