#include "server/render/sights.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "store/base/bytes.hpp"

namespace teracell::server {
namespace {

constexpr double kOwn = 160, kAdded = 1275, kFacing = 255;  // steps of a byte per unit of light

uint8_t byte_of(double x) { return static_cast<uint8_t>(std::lround(std::clamp(x, 0.0, 255.0))); }

// Distances as 1 to 65535; 0 stands for nothing. In perspective the steps are shares of the distance.
class Distances {
 public:
  Distances(const Samples& samples, const Window& window, bool perspective) : perspective_(perspective) {
    for (int64_t y = window.y0; y < window.y1; ++y)
      for (int64_t x = window.x0; x < window.x1; ++x)
        if (const Sample& s = samples.at(x, y); s.shown()) nearest_ = std::min(nearest_, s.t), farthest_ = std::max(farthest_, s.t);
    if (farthest_ < 0) nearest_ = farthest_ = 0;
    if (perspective_) nearest_ = std::max(nearest_, farthest_ * 1e-9);  // the eye may be in a body
  }
  double nearest() const { return nearest_; }
  double farthest() const { return farthest_; }
  uint16_t code(const Sample& s) const {
    if (!s.shown()) return 0;
    if (nearest_ >= farthest_ || s.t <= nearest_) return 1;
    const double share = perspective_ ? std::log(s.t / nearest_) / std::log(farthest_ / nearest_) : (s.t - nearest_) / (farthest_ - nearest_);
    return static_cast<uint16_t>(1 + std::lround(65534 * std::clamp(share, 0.0, 1.0)));
  }

 private:
  const bool perspective_;
  double nearest_ = std::numeric_limits<double>::infinity(), farthest_ = -1;
};

// A pixel of which one point is too little to know.
struct Edge {
  size_t at;
  std::array<Seen, 4> seen;
};

class Encoder {
 public:
  // `labels`: without that of what can't be read.
  Encoder(size_t labels, int64_t width) : label_bytes_(labels < 0xFE ? 1 : labels < 0xFFFE ? 2 : 4), width_(static_cast<size_t>(width)) {}
  int label_bytes() const { return label_bytes_; }
  void label(const Seen& s) {
    const uint32_t code = s.label == Sample::kNothing ? 0 : s.label + 1;
    for (int i = 0; i < label_bytes_; ++i) out.push_back(static_cast<uint8_t>(code >> (8 * i)));
  }
  // The differences along each row, which compress better than the values: `bytes` planes, the lowest byte first.
  void differences(const std::vector<uint16_t>& values, int bytes) {
    for (int byte = 0; byte < bytes; ++byte)
      for (size_t i = 0; i < values.size(); ++i)
        out.push_back(static_cast<uint8_t>((values[i] - (i % width_ == 0 ? 0 : values[i - 1])) >> (8 * byte)));
  }
  void bits(const std::vector<uint8_t>& values) {
    for (size_t at = 0; at < values.size(); at += 8) {
      uint8_t byte = 0;
      for (size_t i = at; i < std::min(values.size(), at + 8); ++i) byte = static_cast<uint8_t>(byte | values[i] << (i - at));
      out.push_back(byte);
    }
  }

  Bytes out;

 private:
  const int label_bytes_;
  const size_t width_;
};

}  // namespace

std::string encode_sights(const Viewed& viewed, const Prepared& prepared, const Aim& aim, const Window& window, bool quick, int threads,
                          const Caster::Progress& progress) {
  Caster caster(viewed, prepared, aim, threads);
  Samples samples({});
  caster.cast(caster.with_margin(window), samples, [&](double share) { progress(0.7 * share); });
  const Distances distances(samples, window, aim.camera.perspective);
  const auto pixels = static_cast<size_t>(window.width() * window.height());
  std::vector<Seen> middles(pixels);
  std::vector<uint16_t> distance(pixels), own(pixels), added(pixels), facing(pixels);
  std::vector<uint8_t> is_edge(pixels);
  std::vector<std::vector<Edge>> found(static_cast<size_t>(threads));
  caster.each_part(
      window,
      [&](const Window& part, int worker) {
        for (int64_t y = part.y0; y < part.y1; ++y)
          for (int64_t x = part.x0; x < part.x1; ++x) {
            const auto at = static_cast<size_t>((y - window.y0) * window.width() + x - window.x0);
            middles[at] = caster.middle(samples, x, y);
            distance[at] = distances.code(samples.at(x, y));
            own[at] = byte_of(kOwn * middles[at].light.own);
            added[at] = byte_of(kAdded * middles[at].light.added);
            facing[at] = byte_of(kFacing * middles[at].light.facing);
            if (quick || !caster.is_edge(samples, x, y)) continue;
            is_edge[at] = 1;
            found[static_cast<size_t>(worker)].push_back({at, caster.around(samples, x, y, worker)});
          }
      },
      [&](double share) { progress(0.7 + 0.3 * share); });
  std::vector<Edge> edges;
  for (const auto& list : found) edges.insert(edges.end(), list.begin(), list.end());
  std::ranges::sort(edges, {}, &Edge::at);

  Encoder encoder(prepared.visible.damage(), window.width());
  for (const char c : std::string_view("TCS1")) encoder.out.push_back(static_cast<uint8_t>(c));
  put_fixed(encoder.out, static_cast<uint32_t>(window.width()));
  put_fixed(encoder.out, static_cast<uint32_t>(window.height()));
  put_fixed(encoder.out, static_cast<uint32_t>(edges.size()));
  put_fixed(encoder.out, std::bit_cast<uint64_t>(distances.nearest()));
  put_fixed(encoder.out, std::bit_cast<uint64_t>(distances.farthest()));
  put_fixed(encoder.out, static_cast<uint64_t>(encoder.label_bytes()));
  for (const Seen& s : middles) encoder.label(s);
  encoder.differences(distance, 2);
  encoder.differences(own, 1);
  encoder.differences(added, 1);
  encoder.differences(facing, 1);
  encoder.bits(is_edge);
  for (const Edge& edge : edges)
    for (const Seen& s : edge.seen) encoder.label(s);
  for (const Edge& edge : edges)
    for (const Seen& s : edge.seen) encoder.out.push_back(byte_of(kOwn * s.light.own));
  for (const Edge& edge : edges)
    for (const Seen& s : edge.seen) encoder.out.push_back(byte_of(kAdded * s.light.added));
  for (const Edge& edge : edges)
    for (const Seen& s : edge.seen) encoder.out.push_back(byte_of(kFacing * s.light.facing));
  return {reinterpret_cast<const char*>(encoder.out.data()), encoder.out.size()};
}

std::optional<Hit> seen_at(const Viewed& viewed, const Prepared& prepared, const Aim& aim, double x, double y) {
  const Subject subject{viewed, prepared.visible, prepared.occupancy, aim.cuts, aim.level};
  return FirstHits(subject, aim.camera).first(aim.camera.sight(x, y));
}

}  // namespace teracell::server
