#include "render/render.hpp"

#include <algorithm>
#include <cmath>

#include "render/first_hit.hpp"
#include "render/shading.hpp"
#include "store/error.hpp"
#include "store/in_order.hpp"

namespace teracell {
namespace {

constexpr int64_t kTile = 32;                       // pixels along a side
constexpr int64_t kBandPixels = int64_t{1} << 21;   // that are held as samples

// A colour that is added up: premultiplied by alpha.
struct Sum {
  double r = 0, g = 0, b = 0, a = 0;
  void add(const Rgba& c) {
    const double alpha = c[3] / 255.0;
    r += c[0] * alpha, g += c[1] * alpha, b += c[2] * alpha, a += c[3];
  }
  Rgba mean(double n) const {
    const auto byte = [](double x) { return static_cast<uint8_t>(std::lround(std::clamp(x, 0.0, 255.0))); };
    const double alpha = a / 255;
    return a == 0 ? Rgba{} : Rgba{byte(r / alpha), byte(g / alpha), byte(b / alpha), byte(a / n)};
  }
};

class Renderer {
 public:
  Renderer(const GridReader& reader, const RenderOptions& options, int threads, const std::atomic<bool>& stop)
      : reader_(reader),
        options_(options),
        threads_(threads),
        stop_(stop),
        visible_(shown_labels(reader.meta(), options)),
        occupancy_(reader, visible_, options.level.value_or(0), threads, stop),
        subject_{reader, visible_, occupancy_, cuts(reader.meta().grid, options), options.level},
        openness_(reader.meta().grid, reader.meta().frame(), occupancy_, subject_.hi),
        shading_(reader.meta().grid, options.camera, openness_, options.level) {
    for (const LabelInfo& label : reader.meta().labels) {
      Rgba color = parse_color(reader.meta().materials[label.material].color).value_or(Rgba{128, 128, 128, 255});
      if (!options.flat) color[3] = 255;
      colors_.push_back(color);
    }
    for (int i = 0; i < threads; ++i) hits_.emplace_back(subject_, options.camera);
  }

  Picture3D picture(const std::function<void(double)>& progress) {
    const PictureSize size = options_.camera.size;
    Picture3D out{size, std::vector<uint8_t>(size_t{4} * size.width * size.height)};
    const int64_t height = size.height, halo = options_.flat ? 0 : Shading::kReach;
    const int64_t band = std::max<int64_t>(kTile, kBandPixels / size.width);
    for (int64_t y = 0; y < height; y += band) {
      const int64_t end = std::min(height, y + band);
      const Rows rows = cast(std::max<int64_t>(0, y - halo), std::min(height, end + halo), [&](double share) {
        progress((static_cast<double>(y) + 0.8 * share * static_cast<double>(end - y)) / static_cast<double>(height));
      });
      each_tile(
          y, end,
          [&](int64_t x0, int64_t y0, int64_t x1, int64_t y1, int worker) {
            for (int64_t py = y0; py < y1; ++py)
              for (int64_t px = x0; px < x1; ++px)
                std::ranges::copy(color(rows, px, py, worker), &out.rgba[static_cast<size_t>(4 * (py * size.width + px))]);
          },
          [](double) {});
    }
    return out;
  }

 private:
  static std::vector<bool> shown_labels(const Metadata& meta, const RenderOptions& options) {
    std::vector<bool> out;
    for (const LabelInfo& label : meta.labels) out.push_back(options.materials.empty() ? label.material != 0 : options.materials[label.material]);
    return out;
  }
  static Vec3 cuts(const Grid& grid, const RenderOptions& options) {
    Vec3 out;
    for (int d = 0; d < 3; ++d) out[d] = options.cut[d] ? std::min(*options.cut[d], grid.axis[d].max()) : grid.axis[d].max();
    return out;
  }

  // Tiles of the rows [first, end). Neighbours are taken one after another in the direction in which the rays of the grid lie in the picture, since
  // they need the same chunks.
  template <class F, class Done>
  void each_tile(int64_t first, int64_t end, F f, Done done) {
    const int w = reader_.meta().ray_axis;
    const bool upright = std::abs(options_.camera.up[w]) > std::abs(options_.camera.right[w]);
    const int64_t width = options_.camera.size.width, across = (width + kTile - 1) / kTile, down = (end - first + kTile - 1) / kTile;
    int64_t next = 0, made = 0;
    in_order(
        threads_,
        [&]() -> std::optional<int64_t> {
          if (stop_) throw Interrupted(reader_.name() + ": interrupted");
          return next < across * down ? std::optional(next++) : std::nullopt;
        },
        [&](int64_t tile, int worker) {
          const int64_t x = (upright ? tile / down : tile % across) * kTile, y = first + (upright ? tile % down : tile / across) * kTile;
          f(x, y, std::min(width, x + kTile), std::min(end, y + kTile), worker);
          return 0;
        },
        [&](int) { done(static_cast<double>(++made) / static_cast<double>(across * down)); }, 8);
  }

  Sample sample(double x, double y, int worker) {
    const auto hit = hits_[static_cast<size_t>(worker)].first(options_.camera.sight(x, y));
    return hit ? Sample{hit->t, hit->label, static_cast<int8_t>(hit->face)} : Sample{};
  }

  Rows cast(int64_t first, int64_t end, const std::function<void(double)>& progress) {
    Rows rows{first, end, options_.camera.size.width, {}};
    rows.samples.resize(static_cast<size_t>((end - first) * rows.width));
    each_tile(
        first, end,
        [&](int64_t x0, int64_t y0, int64_t x1, int64_t y1, int worker) {
          for (int64_t y = y0; y < y1; ++y)
            for (int64_t x = x0; x < x1; ++x) rows.at(x, y) = sample(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5, worker);
        },
        progress);
    return rows;
  }

  Rgba lit(const Sample& s, double x, double y, const Vec3& normal) const {
    const Sight sight = options_.camera.sight(x, y);
    return shading_.lit(colors_[s.label], sight.from + sight.along * s.t, normal, sight.along);
  }

  Rgba color(const Rows& rows, int64_t x, int64_t y, int worker) {
    const Sample& here = rows.at(x, y);
    if (options_.flat) return here.shown() ? colors_[here.label] : options_.ground;
    const double cx = static_cast<double>(x) + 0.5, cy = static_cast<double>(y) + 0.5;
    if (!shading_.is_edge(rows, x, y)) return here.shown() ? lit(here, cx, cy, shading_.normal(rows, x, y)) : options_.ground;
    // A rotated grid of four lines of sight. Each is lit as the nearest pixel that shows the same surface.
    Sum sum;
    for (const auto& [dx, dy] : {std::pair{-0.125, -0.375}, {0.375, -0.125}, {-0.375, 0.125}, {0.125, 0.375}}) {
      const Sample s = sample(cx + dx, cy + dy, worker);
      sum.add(s.shown() ? lit(s, cx + dx, cy + dy, normal_near(rows, x, y, s, dx, dy)) : options_.ground);
    }
    return sum.mean(4);
  }

  Vec3 normal_near(const Rows& rows, int64_t x, int64_t y, const Sample& s, double dx, double dy) const {
    const int sx = dx > 0 ? 1 : -1, sy = dy > 0 ? 1 : -1;
    for (const auto& [i, j] :
         {std::pair{0, 0}, std::abs(dx) > std::abs(dy) ? std::pair{sx, 0} : std::pair{0, sy}, {sx, 0}, {0, sy}, {sx, sy}, {-sx, 0}, {0, -sy}})
      if (rows.has(x + i, y + j) && rows.at(x + i, y + j).shown() && shading_.is_near(rows.at(x + i, y + j), s))
        return shading_.normal(rows, x + i, y + j);
    return shading_.face_normal(options_.camera.sight(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5), s.face);
  }

  const GridReader& reader_;
  const RenderOptions& options_;
  const int threads_;
  const std::atomic<bool>& stop_;
  const Visible visible_;
  const Occupancy occupancy_;
  const Subject subject_;
  const Openness openness_;
  const Shading shading_;
  std::vector<Rgba> colors_;  // of labels
  std::vector<FirstHits> hits_;  // of threads
};

}  // namespace

Picture3D render(const GridReader& reader, const RenderOptions& options, int threads, const std::atomic<bool>& stop,
                 const std::function<void(double share)>& progress) {
  if (options.level) reader.meta().grid.check_level(*options.level);
  return Renderer(reader, options, threads, stop).picture(progress);
}

}  // namespace teracell
