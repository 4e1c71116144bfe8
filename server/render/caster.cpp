#include "server/render/caster.hpp"

#include <algorithm>
#include <cmath>

#include "store/base/in_order.hpp"
#include "store/base/wanted.hpp"

namespace teracell::server {
namespace {

constexpr int64_t kTile = 32;  // pixels along a side

}  // namespace

Caster::Caster(const Viewed& viewed, const Prepared& prepared, const Aim& aim, int threads)
    : reader_(viewed.reader),
      aim_(aim),
      threads_(threads),
      subject_{viewed, prepared.visible, prepared.occupancy, aim.cuts, aim.level},
      openness_(reader_.meta().grid, prepared.density, aim.cuts),
      shading_(reader_.meta().grid, aim.camera, openness_, aim.cuts, aim.level) {
  for (int i = 0; i < threads; ++i) hits_.emplace_back(subject_, aim.camera);
}

Window Caster::with_margin(const Window& window) const {
  constexpr int64_t n = Shading::kReach + 1;  // a point of a pixel may be lit as the pixel beside it
  const PictureSize size = aim_.camera.size;
  return {std::max<int64_t>(0, window.x0 - n), std::max<int64_t>(0, window.y0 - n), std::min<int64_t>(size.width, window.x1 + n),
          std::min<int64_t>(size.height, window.y1 + n)};
}

// Neighbours are taken one after another in the direction in which the rays of the grid lie in the picture, since they need the same chunks.
void Caster::each_part(const Window& window, const std::function<void(const Window&, int)>& f, const Progress& progress) {
  const int w = reader_.meta().ray_axis;
  const bool upright = std::abs(aim_.camera.up[w]) > std::abs(aim_.camera.right[w]);
  const int64_t across = (window.width() + kTile - 1) / kTile, down = (window.height() + kTile - 1) / kTile;
  int64_t next = 0, made = 0;
  in_order(
      threads_,
      [&]() -> std::optional<int64_t> {
        Wanted::stop_if_not();
        return next < across * down ? std::optional(next++) : std::nullopt;
      },
      [&](int64_t tile, int worker) {
        const int64_t x = window.x0 + (upright ? tile / down : tile % across) * kTile,
                      y = window.y0 + (upright ? tile % down : tile / across) * kTile;
        f({x, y, std::min(window.x1, x + kTile), std::min(window.y1, y + kTile)}, worker);
        return 0;
      },
      [&](int) { progress(static_cast<double>(++made) / static_cast<double>(across * down)); }, 8);
  if (late_) throw Later("bytes of some pixels come later");
}

std::optional<Sample> Caster::sample(double x, double y, int worker) {
  try {
    const auto hit = hits_[static_cast<size_t>(worker)].first(aim_.camera.sight(x, y));
    return hit ? Sample{hit->t, hit->label, static_cast<int8_t>(hit->face)} : Sample{};
  } catch (const Later&) {
    late_ = true;
    return std::nullopt;
  }
}

void Caster::cast(const Window& window, Samples& samples, const Progress& progress) {
  Samples out(window);
  Window rest = window;
  if (samples.window.y0 <= window.y0 && samples.window.y1 > window.y0) {
    rest.y0 = std::min(window.y1, samples.window.y1);
    std::copy_n(&samples.at(window.x0, window.y0), window.width() * (rest.y0 - window.y0), out.samples.begin());
  }
  samples = std::move(out);
  each_part(
      rest,
      [&](const Window& part, int worker) {
        for (int64_t y = part.y0; y < part.y1; ++y)
          for (int64_t x = part.x0; x < part.x1; ++x) {
            const auto s = sample(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5, worker);
            if (s) samples.at(x, y) = *s;
            else x |= 7;  // its neighbours lack the same bytes
          }
      },
      progress);
}

Seen Caster::middle(const Samples& samples, int64_t x, int64_t y) const {
  const Sample& here = samples.at(x, y);
  if (!here.shown()) return {};
  const Sight sight = aim_.camera.sight(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
  return {here.label, shading_.light(sight, here, shading_.normal(samples, x, y))};
}

// A rotated grid of four lines of sight. Each is lit as the nearest pixel that shows the same surface.
std::array<Seen, 4> Caster::around(const Samples& samples, int64_t x, int64_t y, int worker) {
  constexpr std::pair<double, double> kPlaces[] = {{-0.125, -0.375}, {0.375, -0.125}, {-0.375, 0.125}, {0.125, 0.375}};
  const double cx = static_cast<double>(x) + 0.5, cy = static_cast<double>(y) + 0.5;
  std::array<Seen, 4> out;
  for (size_t i = 0; i < 4; ++i) {
    const auto& [dx, dy] = kPlaces[i];
    const auto s = sample(cx + dx, cy + dy, worker);
    if (s && s->shown()) out[i] = {s->label, shading_.light(aim_.camera.sight(cx + dx, cy + dy), *s, normal_near(samples, x, y, *s, dx, dy))};
  }
  return out;
}

Vec3 Caster::normal_near(const Samples& samples, int64_t x, int64_t y, const Sample& s, double dx, double dy) const {
  const int sx = dx > 0 ? 1 : -1, sy = dy > 0 ? 1 : -1;
  for (const auto& [i, j] :
       {std::pair{0, 0}, std::abs(dx) > std::abs(dy) ? std::pair{sx, 0} : std::pair{0, sy}, {sx, 0}, {0, sy}, {sx, sy}, {-sx, 0}, {0, -sy}})
    if (samples.has(x + i, y + j) && samples.at(x + i, y + j).shown() && shading_.is_near(samples.at(x + i, y + j), s))
      return shading_.normal(samples, x + i, y + j);
  return shading_.face_normal(aim_.camera.sight(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5), s.face);
}

}  // namespace teracell::server
