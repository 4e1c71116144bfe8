#include "mesher/pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <future>
#include <numeric>
#include <sys/resource.h>

#include <fmt/format.h>

#include "mesher/bodies.hpp"
#include "mesher/engines/scan.hpp"
#include "mesher/survey.hpp"
#include "mesher/tiling.hpp"
#include "store/in_order.hpp"
#include "store/pyramid.hpp"
#include "store/pyramid_writer.hpp"

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

// Bodies by precedence: the highest priority first, of equals the later one. strength[b] is the place of body b.
std::vector<uint32_t> strengths(const Scene& scene) {
  std::vector<uint32_t> order(scene.bodies.size()), strength(scene.bodies.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, [&](uint32_t a, uint32_t b) {
    const int64_t pa = scene.bodies[a].priority, pb = scene.bodies[b].priority;
    return pa != pb ? pa > pb : a > b;
  });
  for (uint32_t s = 0; s < order.size(); ++s) strength[order[s]] = s;
  return strength;
}

// A material ranks as its strongest body; those without one after these; the background last.
std::vector<MaterialInfo> ranked_materials(const Scene& scene, const std::vector<uint32_t>& strength) {
  std::vector<uint64_t> key(scene.materials.size());
  for (size_t m = 0; m < key.size(); ++m) key[m] = (uint64_t{1} << 32) + m;
  for (size_t b = 0; b < scene.bodies.size(); ++b)
    key[scene.bodies[b].material] = std::min<uint64_t>(key[scene.bodies[b].material], strength[b]);
  key[0] = ~uint64_t{0};
  std::vector<uint32_t> order(key.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](uint32_t m) { return key[m]; });
  std::vector<MaterialInfo> out;
  for (const SceneMaterial& m : scene.materials) out.push_back({m.name, m.color, 0});
  for (uint32_t rank = 0; rank < order.size(); ++rank) out[order[rank]].rank = rank;
  return out;
}

// Labels, and the label of every body. Label 0 is the background.
void make_labels(const Scene& scene, Metadata& meta, std::vector<Label>& of_body) {
  if (!scene.label_by_body) {
    for (uint32_t m = 0; m < scene.materials.size(); ++m) meta.labels.push_back({m, ""});
    for (const SceneBody& body : scene.bodies) of_body.push_back(body.material);
    return;
  }
  meta.labels.push_back({0, ""});
  for (const SceneBody& body : scene.bodies) {
    of_body.push_back(static_cast<Label>(meta.labels.size()));
    meta.labels.push_back({body.material, body.name});
  }
}

// Chunks are as long as the rays, up to the format's default; on surfaces so dense that a chunk would hold millions of
// changes they are shorter, so that reading one stays cheap.
uint32_t chunk_length(const AxisCost& cost, int64_t cells, uint32_t chunk_rays) {
  uint32_t length = Metadata{}.chunk_cells;
  const double per_cell = cost.crossings / cost.rays * chunk_rays * chunk_rays / static_cast<double>(cells);
  while (length > 1024 && per_cell * std::min<double>(length, static_cast<double>(cells)) > 2e6) length /= 2;
  return length;
}

// What one thread keeps between units.
struct Worker {
  Worker(const std::vector<Layer>& layers, const std::vector<uint32_t>& strength, const std::vector<Label>& label)
      : composer(layers, strength, label) {}
  ScanEngine engine;
  Composer composer;
  ChunkEncoder encoder;
  Crossings crossings;
};

struct UnitResult {
  uint32_t cu, cv;
  std::vector<LevelChunk> chunks;  // up to 16 of level 0, one of level 2
  Chunk coarse;                    // the unit's rays on level 4
  uint64_t crossings = 0;
};

// The whole of a unit: cast, compose, encode, coarsen.
UnitResult make_unit(const Unit& unit, const Tiling& tiling, const Metadata& meta, Worker& worker) {
  const LevelShape shape(meta, 0);
  const Frame f = meta.frame();
  const auto labels = static_cast<uint32_t>(meta.labels.size());
  UnitResult out{unit.cu, unit.cv, {}, {}, 0};
  const auto facets = tiling.split(unit);
  std::array<Chunk, 16> pieces;
  Chunk fine{{}, SetTable(labels)};
  for (uint32_t i = 0; i < 16; ++i) {
    const uint32_t cu = unit.cu * 4 + i % 4, cv = unit.cv * 4 + i / 4;
    if (cu >= shape.chunks_u || cv >= shape.chunks_v) continue;
    if (facets[i].empty()) {  // most tiles of a large grid
      pieces[i] = {{}, SetTable(labels)};
      pieces[i].rays.fill((shape.rays_u(cu) + 3) / 4, (shape.rays_v(cv) + 3) / 4, static_cast<uint32_t>(ceil_shift(shape.nw, 2)), 0);
      fine.rays.fill(shape.rays_u(cu), shape.rays_v(cv), shape.nw, 0);
      out.chunks.push_back(encode_level(worker.encoder, meta, 0, cu, cv, fine));
      continue;
    }
    Tile tile{f, {}, {}, &meta.grid.axis[f.w]};
    for (uint32_t u = 0; u < shape.rays_u(cu); ++u) tile.u.push_back(meta.grid.axis[f.u].centre(cu * shape.chunk_rays + u));
    for (uint32_t v = 0; v < shape.rays_v(cv); ++v) tile.v.push_back(meta.grid.axis[f.v].centre(cv * shape.chunk_rays + v));
    worker.engine.cast(tile, facets[i], worker.crossings);
    out.crossings += worker.crossings.all.size();
    worker.composer.compose(worker.crossings, shape.rays_u(cu), shape.rays_v(cv), shape.nw, fine.rays);
    out.chunks.push_back(encode_level(worker.encoder, meta, 0, cu, cv, fine));
    pieces[i].sets = fine.sets;
    pieces[i].rays = coarsen(fine.rays, 2, pieces[i].sets);
  }
  if (meta.grid.levels() <= 2) return out;
  const Chunk level2 = join_pieces(pieces, meta.chunk_rays, labels);
  out.chunks.push_back(encode_level(worker.encoder, meta, 2, unit.cu, unit.cv, level2));
  out.coarse.sets = level2.sets;
  out.coarse.rays = coarsen(level2.rays, 2, out.coarse.sets);
  return out;
}

const char* name_of(Fill fill) { return fill == Fill::kEvenodd ? "evenodd" : "nonzero"; }

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

  const Bodies bodies = read_bodies(scene, [&](double share) { tick("read", share); });
  phases.end("read");

  Metadata meta;
  meta.units = scene.units;
  meta.grid = resolve_grid(scene, bodies.lo, bodies.hi);
  cells_of_grid = 1;
  for (const int64_t n : meta.grid.cells()) cells_of_grid *= static_cast<double>(n);
  std::array<AxisCost, 3> cost;
  for (int axis = 0; axis < 3; ++axis) cost[axis] = axis_cost(bodies.facets, meta.grid, axis);
  meta.ray_axis = 2;  // of equals z, then y: rows of a picture along x stay rows
  for (const int axis : {1, 0})
    if (cost[axis].nanoseconds() < cost[meta.ray_axis].nanoseconds()) meta.ray_axis = axis;
  if (options.axis) meta.ray_axis = *options.axis;
  meta.chunk_cells = chunk_length(cost[meta.ray_axis], meta.grid.cells()[meta.ray_axis], meta.chunk_rays);
  const std::vector<uint32_t> strength = strengths(scene);
  meta.materials = ranked_materials(scene, strength);
  std::vector<Label> label_of_body;
  make_labels(scene, meta, label_of_body);

  GridWriter writer(output, meta);
  PyramidWriter pyramid(writer);
  Tiling tiling(bodies.facets, meta);
  auto surveys = std::async(std::launch::async, [&] {
    std::vector<Survey> out;
    for (const BodyFacets& b : bodies.bodies) out.push_back(survey({bodies.facets.data() + b.first, b.count}));
    return out;
  });
  phases.end("prepare");

  std::vector<std::unique_ptr<Worker>> workers;
  for (int i = 0; i < threads; ++i) workers.push_back(std::make_unique<Worker>(bodies.layers, strength, label_of_body));
  uint64_t crossings = 0, units = 0;
  in_order(
      threads, [&] { return tiling.next(); },
      [&](const Unit& unit, int worker) { return make_unit(unit, tiling, meta, *workers[worker]); },
      [&](UnitResult result) {
        for (const LevelChunk& chunk : result.chunks) pyramid.put(chunk);
        pyramid.rise(2, result.cu, result.cv, std::move(result.coarse));
        crossings += result.crossings;
        tick("mesh", static_cast<double>(++units) / static_cast<double>(tiling.units()));
      });
  phases.end("cast");

  ordered_json report = {{"schema", 1}, {"bodies", ordered_json::array()}};
  ordered_json inputs = ordered_json::array();
  ordered_json warnings = ordered_json::array();
  const std::vector<Survey> surveyed = surveys.get();
  uint64_t exact = 0;
  std::vector<unsigned __int128> cells(scene.bodies.size());
  for (const auto& w : workers) {
    exact += w->engine.exact_decisions();
    for (size_t b = 0; b < cells.size(); ++b) cells[b] += w->composer.cells()[b];
  }
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    const BodyFacets& found = bodies.bodies[b];
    const Survey& s = surveyed[b];
    ordered_json j = {{"name", body.name}, {"facets", found.count}, {"degenerate", s.degenerate}, {"duplicates", s.duplicates}, {"shells", s.shells}};
    j["fill"] = {{{"rule", name_of(found.rule)}, {"shells", s.shells}, {"why", found.why}}};
    j["holes"] = ordered_json::array();
    j["cells"] = static_cast<uint64_t>(cells[b]);
    if (cells[b] >> 53 != 0) j["cells_text"] = fmt::format("{}", cells[b]);
    report["bodies"].push_back(j);
    inputs.push_back({{"path", body.mesh_text}, {"format", found.file.format}, {"bytes", found.file.bytes}, {"hash", found.file.hash}});
    if (body.fill == Fill::kAuto && found.rule == Fill::kEvenodd)
      warnings.push_back(fmt::format("body '{}' has facets oriented the other way round: inside is decided by parity, so where its shells overlap it is hollow", body.name));
    if (cells[b] == 0)
      warnings.push_back(fmt::format("body '{}' owns no cell: it lies outside the grid, between the sample points, or under stronger bodies", body.name));
  }
  report["crossings"] = crossings;
  report["warnings"] = warnings;
  report["inputs"] = inputs;
  report["ray_axis"] = {{"axis", axis_name(meta.ray_axis)}, {"why", options.axis ? "asked for" : "the fewest crossings and rays"}};
  for (int axis = 0; axis < 3; ++axis) report["ray_axis"]["crossings_expected"].push_back(static_cast<uint64_t>(std::min(cost[axis].crossings, 0x1p63)));
  report["scene"] = normalised(scene);
  tick("write", 0);
  writer.finish(report.dump(), crossings);
  phases.end("finish");

  report["phases"] = phases.list();
  report["peak_memory_bytes"] = peak_memory_bytes();
  report["threads"] = threads;
  report["exact_decisions"] = exact;
  report["spilled_bytes"] = 0;
  report["resumed_chunks"] = 0;
  report["file_bytes"] = writer.bytes();
  return report;
}

}  // namespace teracell
