// What tools/bench/parts.py fits the costs of CostMap to (mesher/tiles/shards.cpp): the CPU time of each group of a grid, and what is counted of it
// before.
//
//   parts_probe SCENE CELLS AXIS    prints "NS KEY GROUPS FACETS CROSSINGS OTHERS" for each group
//
// CELLS: along the longest side, or 0 for the grid of the scene, which may have at most 65,536 rays along an axis.
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>

#include "mesher/engines/engines.hpp"
#include "mesher/run/casting.hpp"
#include "mesher/run/read_scene.hpp"
#include "mesher/run/tiled_facets.hpp"
#include "mesher/scene/scene.hpp"
#include "store/runs/pyramid.hpp"

namespace {

using namespace teracell;

// Keeps nothing.
class NoFile : public ChunkSink {
 public:
  explicit NoFile(const Metadata& meta) : meta_(meta) {}
  const Metadata& meta() const override { return meta_; }
  void put(const ChunkKey&, const EncodedChunk&) override {}
  void put_child(int, uint32_t, uint32_t, const Chunk&) override {}
  void put_cells(size_t, const ChunkKey&, std::span<const uint8_t>) override {}
  uint64_t bytes() const override { return 0; }
  uint64_t chunks() const override { return 0; }
  void save(Bytes&) override {}

 private:
  const Metadata& meta_;
};

double thread_nanoseconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e9 * static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec);
}

void measure(const char* path, int64_t cells, int axis) {
  mesher::Scene scene = mesher::read_scene(path);
  if (cells > 0) {
    mesher::GridOptions grid;
    grid.longest_cells = cells;
    override_grid(scene, grid);
  }
  mesher::MeshOptions options;
  options.threads = 1;
  options.axis = axis;
  const mesher::Progress quiet = [](const char*, double, double) {};
  const std::atomic<bool> stop = false;
  mesher::PreparedRun run(scene, "none.tcell", options, false, quiet, stop);
  const mesher::CostMap costs = run.costs();
  if (costs.side() != uint64_t{kFanOut} * run.plan.meta.chunk_rays) throw std::runtime_error("the grid has too many rays");
  mesher::TiledFacets facets(run.scene, run.bodies, run.plan.meta, run.widened, run.budget, 1, nullptr, [](double) {});
  mesher::Tiling& tiling = facets.tile({}, false, false);
  mesher::Casting casting(run, mesher::engine_maker(options.engine, run.plan.meta.frame(), [&] { return run.of_solids(facets.in_memory()); }));
  NoFile sink(run.plan.meta);
  PyramidWriter pyramid(sink, {});
  const uint32_t nodes_u = (LevelShape(run.plan.meta, 0).nu + static_cast<uint32_t>(costs.side()) - 1) / static_cast<uint32_t>(costs.side());
  double before = thread_nanoseconds();
  casting.cast(
      tiling, [&] { return tiling.next(); }, pyramid,
      [&](const mesher::TileGroupWork& work) {
        const double now = thread_nanoseconds();
        const auto& group = work.group();
        const mesher::CostMap::Load& load = costs.loads()[size_t{group.cv} * nodes_u + group.cu];
        const auto number = [](uint64_t n) { return static_cast<unsigned long long>(n); };
        std::printf("%.0f %llu %llu %llu %llu %llu\n", now - before, number(tree_key(group.cu, group.cv)), number(load.groups), number(load.facets),
                    number(load.crossings), number(load.of_others()));
        before = thread_nanoseconds();
      });
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 4) throw std::runtime_error("expected SCENE CELLS AXIS");
  measure(argv[1], std::atoll(argv[2]), argv[3][0] - 'x');
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "parts_probe: %s\n", e.what());
  return 1;
}
