#include "server/render/render.hpp"

#include <algorithm>
#include <cmath>

namespace teracell::server {
namespace {

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

std::vector<Rgba> colors_of(const Metadata& meta, bool flat) {
  std::vector<Rgba> out;
  for (const LabelInfo& label : meta.labels) {
    out.push_back(parse_color(meta.materials[label.material].color).value_or(Rgba{128, 128, 128, 255}));
    if (!flat) out.back()[3] = 255;
  }
  return out;
}

}  // namespace

std::vector<bool> shown_labels(const Metadata& meta, const RenderOptions& options) {
  if (!options.shown.empty()) return options.shown;
  std::vector<bool> out;
  for (const LabelInfo& label : meta.labels) out.push_back(label.material != 0);
  return out;
}

Picture3D render(const GridReader& reader, const Prepared& prepared, const RenderOptions& options, int threads, const Caster::Progress& progress) {
  const std::vector<Rgba> colors = colors_of(reader.meta(), options.flat);
  Caster caster(reader, prepared, options.aim, threads);
  const auto color = [&](const Samples& samples, int64_t x, int64_t y, int worker) {
    if (options.flat) return samples.at(x, y).shown() ? colors[samples.at(x, y).label] : options.ground;
    const auto of = [&](const Seen& s) { return s.label == Sample::kNothing ? options.ground : lit(colors[s.label], s.light); };
    if (!caster.is_edge(samples, x, y)) return of(caster.middle(samples, x, y));
    Sum sum;
    for (const Seen& s : caster.around(samples, x, y, worker)) sum.add(of(s));
    return sum.mean(4);
  };
  const PictureSize size = options.aim.camera.size;
  Picture3D out{size, std::vector<uint8_t>(size_t{4} * size.width * size.height)};
  const int64_t width = size.width, height = size.height, band = std::max<int64_t>(32, options.held / width);
  Samples samples({});
  for (int64_t y = 0; y < height; y += band) {
    const Window rows{0, y, width, std::min(height, y + band)};
    caster.cast(options.flat ? rows : caster.with_margin(rows), samples, [&](double share) {
      progress((static_cast<double>(y) + 0.8 * share * static_cast<double>(rows.height())) / static_cast<double>(height));
    });
    caster.each_part(
        rows,
        [&](const Window& part, int worker) {
          for (int64_t py = part.y0; py < part.y1; ++py)
            for (int64_t px = part.x0; px < part.x1; ++px)
              std::ranges::copy(color(samples, px, py, worker), &out.rgba[static_cast<size_t>(4 * (py * width + px))]);
        },
        [](double) {});
  }
  return out;
}

Picture3D render(const GridReader& reader, const RenderOptions& options, int threads, const Caster::Progress& progress) {
  if (options.aim.level) reader.meta().grid.check_level(*options.aim.level);
  const Prepared prepared(reader, shown_labels(reader.meta(), options), options.aim.level.value_or(0), threads);
  return render(reader, prepared, options, threads, progress);
}

}  // namespace teracell::server
