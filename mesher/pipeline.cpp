#include "mesher/pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <sys/resource.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mesher/bodies.hpp"
#include "mesher/report.hpp"
#include "mesher/unit.hpp"
#include "store/background.hpp"
#include "store/in_order.hpp"

namespace teracell {
namespace {

using nlohmann::ordered_json;

// Seconds of each phase, for --report.
class Phases {
 public:
  void end(const char* name) {
    const auto now = std::chrono::steady_clock::now();
    list_.push_back({{"name", name}, {"seconds", std::chrono::duration<double>(now - since_).count()}});
    since_ = now;
  }
  ordered_json list() const { return list_; }

 private:
  std::chrono::steady_clock::time_point since_ = std::chrono::steady_clock::now();
  ordered_json list_ = ordered_json::array();
};

uint64_t peak_memory_bytes() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
}

// Chunks are as long as the rays, up to the format's default; on surfaces so dense that a chunk would hold millions of
// changes they are shorter, so that reading one stays cheap.
uint32_t chunk_length(const AxisCost& cost, int64_t cells, uint32_t chunk_rays) {
  uint32_t length = Metadata{}.chunk_cells;
  const double per_cell = cost.crossings / cost.rays * chunk_rays * chunk_rays / static_cast<double>(cells);
  while (length > 1024 && per_cell * std::min<double>(length, static_cast<double>(cells)) > 2e6) length /= 2;
  return length;
}

// Of equals z, then y: rows of a picture along x stay rows.
int cheapest(const std::array<AxisCost, 3>& cost) {
  int best = 2;
  for (const int axis : {1, 0})
    if (cost[axis].nanoseconds() < cost[best].nanoseconds()) best = axis;
  return best;
}

}  // namespace

ordered_json mesh(const Scene& scene, const std::filesystem::path& output, const MeshOptions& options,
                  const Progress& progress, const std::atomic<bool>& stop) {
  Phases phases;
  double cells_of_grid = 0;
  const auto tick = [&](const char* phase, double share) {
    if (stop) throw Interrupted(fmt::format("{}: interrupted: nothing was written", output.string()));
    progress(phase, share, cells_of_grid);
  };
  const int threads = options.threads > 0 ? options.threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));

  const Bodies bodies = read_bodies(scene, threads, [&](double share) { tick("read", share); });
  phases.end("read");
  std::vector<Survey> surveys(bodies.bodies.size());  // beside the work: they decide no cell
  Background background(threads > 1);
  for (size_t b = 0; b < surveys.size(); ++b)
    background.run([&, b] {
      const BodyFacets& body = bodies.bodies[b];
      surveys[b] = survey(bodies.facets, body.first, body.first + body.file.facets, stop);
    });

  Metadata meta;
  meta.units = scene.units;
  meta.grid = resolve_grid(scene, bodies.lo, bodies.hi);
  cells_of_grid = 1;
  for (const int64_t n : meta.grid.cells()) cells_of_grid *= static_cast<double>(n);
  AxisChoice rays{0, options.axis.has_value(), axis_costs(bodies.facets, meta.grid)};
  rays.axis = options.axis.value_or(cheapest(rays.cost));
  meta.ray_axis = rays.axis;
  meta.chunk_rays = options.chunk_rays;
  meta.chunk_cells = chunk_length(rays.cost[rays.axis], meta.grid.cells()[rays.axis], meta.chunk_rays);
  const Labels labels = make_labels(scene);
  meta.materials = labels.materials;
  meta.labels = labels.labels;

  GridWriter writer(output, meta);
  PyramidWriter pyramid(writer);
  Tiling tiling(bodies.facets, meta);
  phases.end("prepare");

  std::vector<std::unique_ptr<Worker>> workers;
  for (int i = 0; i < threads; ++i) workers.push_back(std::make_unique<Worker>(bodies.layers, labels));
  CastTotals totals{0, 0, std::vector<unsigned __int128>(scene.bodies.size())};
  std::shared_ptr<UnitWork> current;
  uint32_t row = UnitWork::kRows;
  uint64_t units = 0;
  struct Job {
    std::shared_ptr<UnitWork> work;
    uint32_t row;
  };
  in_order(
      threads,
      [&]() -> std::optional<Job> {
        if (row == UnitWork::kRows) {
          auto unit = tiling.next();
          if (!unit) return std::nullopt;
          current = std::make_shared<UnitWork>(std::move(*unit), tiling, meta);
          row = 0;
        }
        return Job{current, row++};
      },
      [&](Job job, int worker) {
        job.work->make_row(job.row, *workers[worker]);
        return job;
      },
      [&](Job job) {
        if (job.row + 1 < UnitWork::kRows) return;  // taken in order: with the last row all are made
        for (const LevelChunk& chunk : job.work->chunks()) pyramid.put(chunk);
        pyramid.rise(2, job.work->unit().cu, job.work->unit().cv, std::move(job.work->coarse()));
        tick("mesh", static_cast<double>(++units) / static_cast<double>(tiling.units()));
      },
      2 * UnitWork::kRows);
  for (const auto& w : workers) {
    totals.crossings += w->cast;
    totals.exact_decisions += w->engine.exact_decisions();
    for (size_t b = 0; b < totals.cells.size(); ++b) totals.cells[b] += w->composer.cells()[b];
  }
  background.finish();
  phases.end("cast");

  ordered_json report = make_report(scene, bodies, surveys, rays, totals);
  tick("write", 0);
  writer.finish(report.dump(), totals.crossings);
  phases.end("finish");

  report["phases"] = phases.list();
  report["peak_memory_bytes"] = peak_memory_bytes();
  report["threads"] = threads;
  report["exact_decisions"] = totals.exact_decisions;
  report["spilled_bytes"] = 0;
  report["resumed_chunks"] = 0;
  report["file_bytes"] = writer.bytes();
  return report;
}

}  // namespace teracell
