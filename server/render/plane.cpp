#include "server/render/plane.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "server/render/camera.hpp"
#include "store/base/error.hpp"
#include "store/text/words.hpp"

namespace teracell::server {
namespace {

constexpr int64_t kLongerSide = 1024, kLongestSide = int64_t{1} << 20;  // pixels
constexpr RenderOption kPlaneOptions[] = {
    {"plane", "NUMBERS",
     "NX,NY,NZ,D: the points p with (NX, NY, NZ) . p = D; AZIMUTH,ELEVATION,X,Y,Z: through a point, with a normal so many degrees round z and above the "
     "plane of x and y; or three points, as nine numbers"},
    {"pixels", "N", "the longer side of a picture of all of the plane that lies in the grid; default: 1024"},
    {"size", "W,H", "pixels, in place of that"},
    {"centre", "X,Y,Z", "what is in the middle: this point, moved to the plane along its normal; the size is 1024,1024 unless it is given"},
    {"pixel", "LENGTH", "the side of a pixel; default: all of the plane that lies in the grid would fit into the picture"},
    {"level", "L", "show the cells of this level; default: the highest whose cells are at most as wide as a pixel"},
};

// A plane, and the directions of a picture of it: at right angles to each other, with length 1.
struct DirectedPlane {
  Vec3 normal, right, up;
  double offset;  // of its points along the normal
  // So far along right and up.
  Vec3 point(double u, double v) const { return normal * offset + right * u + up * v; }
};

DirectedPlane plane_through(const Vec3& normal, const Vec3& point) {
  DirectedPlane out{.normal = normal, .right = {}, .up = {}, .offset = dot(normal, point)};
  const int sky = std::abs(normal[2]) >= 1 - 1e-12 ? 1 : 2;
  Vec3 up{};
  up[static_cast<size_t>(sky)] = 1;
  out.right = normalised(cross(up, normal));
  out.up = cross(normal, out.right);
  return out;
}

// The rectangle, along right and up, of what a plane has in common with a box. Its lower ends are above its upper ones where there is nothing.
struct Extent {
  double low[2] = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()}, high[2] = {-low[0], -low[1]};
  double width() const { return high[0] - low[0]; }
  double height() const { return high[1] - low[1]; }
  void add(const DirectedPlane& plane, const Vec3& point) {
    const double at[2] = {dot(plane.right, point), dot(plane.up, point)};
    for (int d = 0; d < 2; ++d) low[d] = std::min(low[d], at[d]), high[d] = std::max(high[d], at[d]);
  }
};

Extent extent_in(const DirectedPlane& plane, const Grid& grid) {
  Extent out;
  for (size_t d = 0; d < 3; ++d)
    for (unsigned corner = 0; corner < 4; ++corner) {  // the edges along an axis
      Vec3 a{};
      const size_t others[2] = {(d + 1) % 3, (d + 2) % 3};
      for (size_t e = 0; e < 2; ++e) a[others[e]] = corner >> e & 1 ? grid.axis[others[e]].max() : grid.axis[others[e]].min();
      Vec3 b = a;
      a[d] = grid.axis[d].min(), b[d] = grid.axis[d].max();
      const double from = dot(plane.normal, a) - plane.offset, to = dot(plane.normal, b) - plane.offset;
      if (from == 0) out.add(plane, a);
      if (to == 0) out.add(plane, b);
      if ((from < 0 && to > 0) || (from > 0 && to < 0)) {
        Vec3 met = a;
        met[d] += (b[d] - a[d]) * (from / (from - to));
        out.add(plane, met);
      }
    }
  return out;
}

class PlaneOptions {
 public:
  PlaneOptions(const OptionText& text, const Grid& grid, std::string_view dashes) : text_(text), grid_(grid), words_(dashes) {}

  PlaneView view() const {
    const DirectedPlane plane = plane_of(*text_("plane"));
    const Extent extent = extent_in(plane, grid_);
    if (!(extent.width() > 0 && extent.height() > 0)) words_.refuse("plane", "a plane that meets the grid", *text_("plane"));
    const std::string* const centre = text_("centre");
    PlaneView out;
    double pixel = 0;
    if (const auto size = this->size(centre != nullptr)) {
      const auto [width, height] = *size;
      pixel = pixel_length().value_or(std::max(extent.width() / static_cast<double>(width), extent.height() / static_cast<double>(height)));
      const Vec3 at =
          centre ? words_.point("centre", *centre) : plane.point((extent.low[0] + extent.high[0]) / 2, (extent.low[1] + extent.high[1]) / 2);
      out.i1 = width, out.j1 = height;
      out.corner =
          plane.point(dot(plane.right, at) - static_cast<double>(width) / 2 * pixel, dot(plane.up, at) - static_cast<double>(height) / 2 * pixel);
    } else {
      pixel = pixel_length().value_or(std::max(extent.width(), extent.height()) / static_cast<double>(longer_side()));
      if (const double most = std::max(extent.width(), extent.height()) / pixel; most > static_cast<double>(kLongestSide))
        words_.refuse("pixel", fmt::format("a length with which the picture has at most {} pixels along a side", kLongestSide), *text_("pixel"));
      out.i1 = std::max<int64_t>(1, std::llround(extent.width() / pixel));
      out.j1 = std::max<int64_t>(1, std::llround(extent.height() / pixel));
      out.corner = plane.point(extent.low[0], extent.low[1]);
    }
    out.right = plane.right * pixel, out.up = plane.up * pixel;
    out.level = level(pixel);
    return out;
  }

 private:
  DirectedPlane plane_of(const std::string& text) const {
    constexpr const char* kExpected =
        "4, 5 or 9 numbers up to 1e75: a normal and an offset, two angles and a point, or three points that are not on one line";
    const auto list = split(text, ',');
    std::vector<double> n;
    for (const std::string_view word : list) n.push_back(words_.number("plane", word, kExpected));
    const auto vec = [&](size_t at) { return Vec3{n[at], n[at + 1], n[at + 2]}; };
    Vec3 normal{}, point{};
    if (n.size() == 4) {
      normal = normalised(vec(0));
      const double largest = std::max({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])});
      const Vec3 scaled = vec(0) * (1 / largest);
      if (largest > 0) point = normal * (n[3] / largest / norm(scaled));
    } else if (n.size() == 5) {
      if (std::abs(n[1]) > 90) words_.refuse("plane", "an elevation from -90 to 90 degrees", text);
      normal = direction(n[0], n[1]), point = vec(2);
    } else if (n.size() == 9) {
      // As seen from where the normal points, the three points go round counterclockwise.
      normal = normalised(cross(normalised(vec(3) - vec(0)), normalised(vec(6) - vec(0)))), point = vec(0);
    }
    if (dot(normal, normal) == 0) words_.refuse("plane", kExpected, text);
    return plane_through(normal, point);
  }

  // In long doubles, so that the doubles are the same with any library's sine. Right angles are exact.
  static Vec3 direction(double azimuth, double elevation) {
    const auto at = [](double degrees) {
      const double quarter = std::remainder(degrees, 360) / 90;
      if (quarter == std::floor(quarter)) {
        constexpr double kSines[] = {0, 1, 0, -1};
        const auto n = static_cast<size_t>(static_cast<int>(quarter) + 4) % 4;
        return std::pair(kSines[(n + 1) % 4], kSines[n]);
      }
      const long double angle = static_cast<long double>(degrees) * std::numbers::pi_v<long double> / 180;
      return std::pair(static_cast<double>(std::cos(angle)), static_cast<double>(std::sin(angle)));
    };
    const auto [ca, sa] = at(azimuth);
    const auto [ce, se] = at(elevation);
    return normalised({ca * ce, sa * ce, se});
  }

  int64_t longer_side() const {
    const std::string* const text = text_("pixels");
    if (!text) return kLongerSide;
    const auto n = number_in<int64_t>(*text);
    if (!n || *n < 1 || *n > kLongestSide) words_.refuse("pixels", fmt::format("1 to {}", kLongestSide), *text);
    return *n;
  }

  std::optional<double> pixel_length() const {
    constexpr const char* kExpected = "a length above 0";
    const std::string* const text = text_("pixel");
    if (!text) return std::nullopt;
    if (const std::string* pixels = text_("pixels")) words_.refuse("pixels", fmt::format("it without {}pixel", words_.dashes()), *pixels);
    const double length = words_.number("pixel", *text, kExpected);
    if (!(length > 0)) words_.refuse("pixel", kExpected, *text);
    return length;
  }

  // None: as large as the plane in the grid.
  std::optional<std::pair<int64_t, int64_t>> size(bool has_centre) const {
    const std::string* const text = text_("size");
    if (!text && !has_centre) return std::nullopt;
    if (const std::string* pixels = text_("pixels"))
      words_.refuse("pixels", fmt::format("it without {}{}", words_.dashes(), text ? "size" : "centre"), *pixels);
    if (!text) return std::pair(kLongerSide, kLongerSide);
    const auto n = numbers_in<int64_t>(*text, 2);
    const auto is_side = [](int64_t side) { return side >= 1 && side <= kLongestSide; };
    if (!n || !is_side((*n)[0]) || !is_side((*n)[1])) words_.refuse("size", fmt::format("width and height from 1 to {} pixels", kLongestSide), *text);
    return std::pair((*n)[0], (*n)[1]);
  }

  int level(double pixel) const {
    if (const std::string* text = text_("level")) {
      const auto level = number_in<int>(*text);
      if (!level || *level < 0 || *level >= grid_.levels()) words_.refuse("level", fmt::format("0 to {}", grid_.levels() - 1), *text);
      return *level;
    }
    double widest = 0;
    for (const Axis& axis : grid_.axis) widest = std::max(widest, axis.longest_cell());
    int out = 0;
    while (out + 1 < grid_.levels() && std::ldexp(widest, out + 1) <= pixel) ++out;
    return out;
  }

  const OptionText& text_;
  const Grid& grid_;
  const OptionWords words_;
};

}  // namespace

std::span<const RenderOption> plane_options() { return kPlaneOptions; }

PlaneView parse_plane_view(const OptionText& text, const Grid& grid, std::string_view dashes) { return PlaneOptions(text, grid, dashes).view(); }

}  // namespace teracell::server
