#include "mesher/pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <sys/resource.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mesher/bodies.hpp"
#include "mesher/caps_file.hpp"
#include "mesher/engines/engines.hpp"
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

std::filesystem::path folder_of(const std::filesystem::path& file) { return file.has_parent_path() ? file.parent_path() : "."; }

uint64_t peak_memory_bytes() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
}

// Chunks are as long as the rays, up to the format's default; on surfaces so dense that a chunk would hold millions of
// changes they are shorter, so that reading one stays cheap.
uint32_t chunk_length(double crossings, double rays, int64_t cells, uint32_t chunk_rays) {
  uint32_t length = Metadata{}.chunk_cells;
  const double per_cell = crossings / rays * chunk_rays * chunk_rays / static_cast<double>(cells);
  while (length > 1024 && per_cell * std::min<double>(length, static_cast<double>(cells)) > 2e6) length /= 2;
  return length;
}

double rays_along(const Grid& grid, int axis) {
  const Frame f = Frame::along(axis);
  return static_cast<double>(grid.axis[f.u].cells()) * static_cast<double>(grid.axis[f.v].cells());
}

// The crossings to expect along each axis, and the axis that costs least: 25 ns a crossing and 3 ns a ray, measured on
// smooth and on empty grids. Of equals z, then y: rows of a picture along x stay rows.
AxisChoice choose_axis(const Grid& grid, const Vec3& area, std::optional<int> asked_for) {
  AxisChoice out;
  Vec3 cost;
  for (int w = 0; w < 3; ++w) {
    const Frame f = Frame::along(w);
    double rays_per_area = 1;
    for (const int d : {f.u, f.v}) rays_per_area *= static_cast<double>(grid.axis[d].cells()) / (grid.axis[d].max() - grid.axis[d].min());
    out.crossings[w] = area[w] * rays_per_area;
    cost[w] = 25 * out.crossings[w] + 3 * rays_along(grid, w);
  }
  for (const int w : {1, 0})
    if (cost[w] < cost[out.axis]) out.axis = w;
  out.asked_for = asked_for.has_value();
  out.axis = asked_for.value_or(out.axis);
  return out;
}

// The survey of all bodies, beside the work: it decides no cell.
std::vector<SurveyTotals> survey_in_memory(const Bodies& bodies, const std::atomic<bool>& stop) {
  std::vector<SurveyTotals> out;
  for (const BodyFacets& body : bodies.bodies) {
    Survey survey;
    std::as_const(*bodies.facets).for_each(body.first, body.first + body.file.facets, [&](const SceneFacet& f) {
      if (!stop) survey.add(f.facet);
    });
    out.push_back({survey.degenerate(), survey.duplicates(), survey.shells()});
  }
  return out;
}

std::vector<bool> which_move(const Scene& scene) {
  std::vector<bool> out;
  for (const SceneBody& body : scene.bodies) out.push_back(body.matrix != kIdentity);
  return out;
}

Facet moved_facet(const Facet& facet, const SceneBody& body) {
  return {{moved(facet.vertex[0], body), moved(facet.vertex[1], body), moved(facet.vertex[2], body)}};
}

// Facets that don't fit into memory are read once more, from their files into bins.
std::unique_ptr<FacetBins> fill_bins(const Scene& scene, const Bodies& bodies, const Metadata& meta, const Budget& budget, int threads, const std::function<void(double)>& tick) {
  const auto move = [&scene, moves = which_move(scene)](const Facet& f, uint32_t layer) { return moves[layer / 2] ? moved_facet(f, scene.bodies[layer / 2]) : f; };
  auto bins = std::make_unique<FacetBins>(meta, bodies.facet_count(), bodies.float32(), budget, threads > 1, move);
  const double all = static_cast<double>(bodies.facet_count());
  uint64_t done = 0;
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    const BodyFacets& found = bodies.bodies[b];
    Background background(threads > 1);
    read_again(scene.bodies[b], found, [&](std::span<const Facet> facets) {
      background.run([&, b, batch = std::vector<Facet>(facets.begin(), facets.end())] {
        for (const Facet& f : batch) bins->add(f, layer_of(b, found.shells ? found.shells->evenodd(f.vertex[0]) : found.rules[1].used));
      });
      done += facets.size();
      tick(static_cast<double>(done) / all);
    });
    background.finish();
    for (const bool parity : {false, true})
      for (const Facet& f : found.rules[parity].caps.facets) bins->add(f, layer_of(b, parity));
  }
  bins->finish();
  return bins;
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

  const Budget budget{options.memory, options.tmp.empty() ? folder_of(output) : options.tmp};
  Bodies bodies = read_bodies(scene, threads, budget, [&](double share) { tick("read", share); });
  std::vector<std::unique_ptr<OutputFile>> caps;
  if (!options.write_caps.empty()) caps = write_caps(scene, bodies, options.write_caps);
  phases.end("read");

  Metadata meta;
  meta.units = scene.units;
  meta.grid = resolve_grid(scene, bodies.lo, bodies.hi);
  cells_of_grid = 1;
  for (const int64_t n : meta.grid.cells()) cells_of_grid *= static_cast<double>(n);
  const AxisChoice rays = choose_axis(meta.grid, bodies.area, options.axis);
  meta.ray_axis = rays.axis;
  meta.chunk_rays = options.chunk_rays;
  meta.chunk_cells = chunk_length(rays.crossings[rays.axis], rays_along(meta.grid, rays.axis), meta.grid.cells()[rays.axis], meta.chunk_rays);
  const Labels labels = make_labels(scene);
  meta.materials = labels.materials;
  meta.labels = labels.labels;
  GridWriter writer(output, meta);
  PyramidWriter pyramid(writer);

  std::vector<SurveyTotals> surveys;
  BinnedSurvey binned(scene.bodies.size());
  Background background(threads > 1);  // for the surveys
  std::optional<Tiling> tiling;
  uint64_t spilled = 0;
  if (bodies.in_memory) {
    background.run([&] { surveys = survey_in_memory(bodies, stop); });
    if (const auto moves = which_move(scene); std::ranges::count(moves, true) > 0) {
      background.finish();  // it takes the files' coordinates
      bodies.facets->for_each(0, bodies.facets->size(), [&](SceneFacet& f) {
        if (moves[f.layer / 2]) f.facet = moved_facet(f.facet, scene.bodies[f.layer / 2]);
      });
    }
    tiling.emplace(bodies.facets, meta);
  } else {
    auto bins = fill_bins(scene, bodies, meta, budget, threads, [&](double share) { tick("spill", share); });
    spilled = bins->bytes();
    tiling.emplace(std::move(bins), [&](auto facets) { background.run([&binned, facets] { binned.add_bin(*facets); }); }, threads > 1, meta);
  }
  const EngineMaker make_engine = engine_maker(options.engine, meta.frame(), [&] {
    if (!bodies.in_memory)
      throw InputError(fmt::format("engine {} searches all facets at once, and these do not fit into the memory given: allow more with --memory, or use engine scan", options.engine));
    std::vector<const SceneFacet*> all;
    std::as_const(*bodies.facets).for_each(0, bodies.facets->size(), [&](const SceneFacet& f) { all.push_back(&f); });
    return all;
  });
  phases.end("prepare");

  std::vector<Layer> layers;  // layer_of()
  for (uint32_t b = 0; b < scene.bodies.size(); ++b) layers.insert(layers.end(), {{b, false}, {b, true}});
  std::vector<std::unique_ptr<Worker>> workers;
  for (int i = 0; i < threads; ++i) workers.push_back(std::make_unique<Worker>(make_engine(), layers, labels));
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
          auto unit = tiling->next();
          if (!unit) return std::nullopt;
          current = std::make_shared<UnitWork>(std::move(*unit), *tiling, meta);
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
        tick("mesh", static_cast<double>(++units) / static_cast<double>(tiling->units()));
      },
      2 * UnitWork::kRows);
  for (const auto& w : workers) {
    totals.crossings += w->cast;
    totals.exact_decisions += w->engine->exact_decisions();
    for (size_t b = 0; b < totals.cells.size(); ++b) totals.cells[b] += w->composer.cells()[b];
  }
  background.finish();
  if (!bodies.in_memory) surveys = binned.totals();
  phases.end("cast");

  ordered_json report = make_report(scene, bodies, surveys, meta.grid, rays, totals);
  tick("write", 0);
  writer.finish(report.dump(), totals.crossings);
  for (const auto& file : caps) file->commit();
  phases.end("finish");

  report["phases"] = phases.list();
  report["peak_memory_bytes"] = peak_memory_bytes();
  report["threads"] = threads;
  report["engine"] = options.engine;
  report["exact_decisions"] = totals.exact_decisions;
  report["spilled_bytes"] = spilled;
  report["resumed_chunks"] = 0;
  report["file_bytes"] = writer.bytes();
  return report;
}

}  // namespace teracell
