// Lines of sight through the pixels of a picture, and the light on what they meet.
#pragma once
#include <atomic>
#include <functional>

#include "server/render/first_hit.hpp"
#include "server/render/prepared.hpp"
#include "server/render/shading.hpp"

namespace teracell::server {

struct Aim {
  Camera camera;
  std::optional<int> level;  // whose cells are drawn; without it, cells that take at most a quarter of a pixel
  Cuts cuts;
};

// What one line of sight of a pixel shows.
struct Seen {
  uint32_t label = Sample::kNothing;
  Light light;
};

class Caster {
 public:
  using Progress = std::function<void(double share)>;
  // Keeps references. Calls throw what Wanted throws.
  Caster(const Viewed& viewed, const Prepared& prepared, const Aim& aim, int threads);

  // One line of sight through the middle of each pixel. `samples` becomes that of the window; the rows that it has of it already are kept.
  // REQUIRES: it is empty, or of other rows of the same width. `progress` is called on this thread.
  void cast(const Window& window, Samples& samples, const Progress& progress);
  // The window, and around it what the light on its pixels depends on.
  Window with_margin(const Window& window) const;
  // What the middle of a pixel shows.
  Seen middle(const Samples& samples, int64_t x, int64_t y) const;
  // Whether the middle is too little to know of a pixel. Then four points show what it shows.
  bool is_edge(const Samples& samples, int64_t x, int64_t y) const { return shading_.is_edge(samples, x, y); }
  std::array<Seen, 4> around(const Samples& samples, int64_t x, int64_t y, int worker);
  // Calls f(part, worker) for the parts of a window, on all threads. Pixels of which bytes come later show nothing; Later is thrown when all
  // parts are done.
  void each_part(const Window& window, const std::function<void(const Window& part, int worker)>& f, const Progress& progress);

 private:
  std::optional<Sample> sample(double x, double y, int worker);  // none: it comes later
  Vec3 normal_near(const Samples& samples, int64_t x, int64_t y, const Sample& s, double dx, double dy) const;

  const GridReader& reader_;
  const Aim& aim_;
  const int threads_;
  const Subject subject_;
  const Openness openness_;
  const Shading shading_;
  std::vector<FirstHits> hits_;    // of threads
  std::atomic<bool> late_ = false;  // bytes of some pixel come later
};

}  // namespace teracell::server
