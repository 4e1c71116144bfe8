#include "mesher/pipeline.hpp"

#include <chrono>

#include <fmt/format.h>

#include "mesher/closing/trust.hpp"
#include "mesher/engines/engines.hpp"
#include "mesher/report/make_report.hpp"
#include "mesher/report/report_json.hpp"
#include "mesher/run/casting.hpp"
#include "mesher/run/checkpoint.hpp"
#include "mesher/run/part_found.hpp"
#include "mesher/run/prepared_run.hpp"
#include "mesher/run/tiled_facets.hpp"
#include "store/base/system/system.hpp"
#include "store/write/part.hpp"
#include "store/write/writer.hpp"

namespace teracell::mesher {
namespace {

// When a long run makes durable what it has: so rarely that this takes no more than a twentieth of the time, and with 0 seconds
// at every occasion.
class Checkpoints {
 public:
  explicit Checkpoints(double seconds) : least_(seconds), next_(Clock::now() + least_) {}
  template <class Save>
  void maybe(Save&& save) {
    const auto begin = Clock::now();
    if (begin < next_) return;
    save();
    const auto end = Clock::now();
    next_ = least_.count() == 0 ? end : end + std::max<Seconds>(20 * (end - begin), least_);
  }

 private:
  using Clock = std::chrono::steady_clock;
  using Seconds = std::chrono::duration<double>;
  const Seconds least_;
  std::chrono::time_point<Clock, Seconds> next_;
};

// All parts close the surfaces. Part 0 writes what closes them.
MeshOptions of_part(MeshOptions options) {
  if (options.shard && options.shard->number != 0) options.write_caps.clear();
  return options;
}

// One run. The steps stand in the order of run().
class MeshRun {
 public:
  MeshRun(const Scene& scene, const std::filesystem::path& output, const MeshOptions& options, const Progress& progress,
          const std::atomic<bool>& stop)
      : options_(of_part(options)),
        output_(options.shard ? part_path(output, *options.shard) : output),
        // Of a grid that is made in parts, the first part has what is found of the surfaces as a whole.
        run_(scene, output_, options_, !options.shard || options.shard->number == 0, progress, stop),
        totals_(no_totals(scene)) {}

  MeshReport run() {
    if (options_.shard) range_ = run_.costs().stretch(*options_.shard);
    open_output();
    totals_.overlaps.bound(run_.budget);
    TiledFacets facets(run_.scene, run_.bodies, run_.plan.meta, run_.widened, run_.budget, run_.threads,
                       run_.options.links ? &*run_.patches : nullptr, [&](double share) { run_.progress("spill", share); });
    Tiling& tiling = facets.tile(range_, run_.counts, false);
    Casting casting(run_, engine_maker(options_.engine, run_.plan.meta.frame(), [&] { return run_.of_solids(facets.in_memory()); }));
    run_.end_phase("prepare");
    cast(casting, tiling);
    MeshReport out;
    if (options_.shard) {
      finish_part(facets);
    } else {
      out.report = make_report(run_.scene, std::move(run_.bodies), facets.counts(), run_.plan, totals_, options_.thin);
      out.json = report_json(out.report, run_.scene);
      run_.end_phase("cast");
      finish(out.json);
    }
    describe_run(facets);
    out.run = std::move(run_.run);
    out.scene = run_.scene;
    out.caps_written = run_.caps();
    return out;
  }

 private:
  // What the bytes of this run's output depend on.
  std::string identity_of_output() const {
    std::string identity = run_.identity();
    if (!options_.shard) return identity;
    return fmt::format("{},\"shard\":\"{}\"}}", identity.substr(0, identity.size() - 1), options_.shard->name());
  }

  void open_output() {
    std::optional<Checkpoint> before;
    if (options_.resume) before = load_checkpoint(output_, identity_of_output());
    if (!before) {
      open_sink();
      remove_checkpoint(output_);  // of an earlier run; removed only now that the lock is ours
      pyramid_.emplace(*sink_, range_);
      return;
    }
    ByteReader state(before->writers, checkpoint_path(output_).string());
    open_sink(state);
    pyramid_.emplace(*sink_, range_);
    pyramid_->restore(state);
    totals_ = before->totals;
    groups_ = before->groups;
    resumed_chunks_ = sink_->chunks();
  }

  template <class... State>
  void open_sink(State&... state) {
    if (options_.shard)
      sink_ = &part_.emplace(output_, PartHead{run_.identity(), options_.shard->number, options_.shard->of, range_, run_.plan.meta}, state...);
    else sink_ = &writer_.emplace(output_, run_.plan.meta, state...);
  }

  void cast(Casting& casting, Tiling& tiling) {
    if (groups_ > 0)
      tiling.pass(groups_, run_.threads, [&](uint64_t done) { run_.progress("resume", static_cast<double>(done) / static_cast<double>(groups_)); });
    Checkpoints checkpoints(options_.checkpoint_seconds);
    casting.cast(
        tiling, [&] { return tiling.next(); }, *pyramid_,
        [&](const TileGroupWork& group) {
          add_totals(totals_, group);
          ++groups_;
          checkpoints.maybe([&] { save(); });
          run_.progress("mesh", static_cast<double>(groups_) / static_cast<double>(tiling.groups()));
        });
  }

  void save() {
    if (identity_.empty()) identity_ = identity_of_output();
    Checkpoint c{identity_, groups_, std::move(totals_), {}};
    sink_->save(c.writers);
    pyramid_->save(c.writers);
    save_checkpoint(c, output_);
    totals_ = std::move(c.totals);
  }

  void finish_part(TiledFacets& facets) {
    std::optional<SurfacesFound> found;
    if (run_.counts) {
      std::vector<SurfaceCounts> of_bodies = facets.counts();
      found.emplace(SurfacesFound{run_.scene, std::move(run_.bodies), std::move(of_bodies), run_.plan.rays, options_.thin, run_.plan.all_patches,
                                  run_.plan.planes});
    }
    run_.end_phase("cast");
    run_.progress("write", 0);
    part_->finish(encode_found(totals_, found ? &*found : nullptr));
    remove_checkpoint(output_);
    run_.commit_caps();
    run_.end_phase("finish");
  }

  void finish(const std::string& report) {
    run_.progress("write", 0);
    writer_->finish(report, totals_.crossings, &totals_.sums);
    remove_checkpoint(output_);
    run_.commit_caps();
    run_.end_phase("finish");
  }

  void describe_run(const TiledFacets& facets) {
    RunReport& run = run_.run;
    run.peak_memory_bytes = system::peak_bytes() + facets.held_bytes();
    run.threads = run_.threads;
    run.engine = options_.engine;
    run.exact_decisions = totals_.exact_decisions;
    run.spilled_bytes = facets.spilled_bytes();
    run.resumed_chunks = resumed_chunks_;
    run.file_bytes = sink_->bytes();
  }

  const MeshOptions options_;
  const std::filesystem::path output_;
  PreparedRun run_;
  TreeRange range_;
  std::optional<GridWriter> writer_;  // or
  std::optional<PartWriter> part_;
  ChunkSink* sink_ = nullptr;         // the one that there is
  std::optional<PyramidWriter> pyramid_;
  std::string identity_;  // made by the first save()
  CastTotals totals_;
  uint64_t groups_ = 0;  // that are stored
  uint64_t resumed_chunks_ = 0;
};

}  // namespace

std::vector<std::string> MeshReport::warnings() const {
  std::vector<std::string> out = report.warnings;
  for (const auto& [body, trust] : run.trust)
    if (std::string words = trust_warning(trust, body); !words.empty()) out.push_back(std::move(words));
  return out;
}

std::filesystem::path part_path(const std::filesystem::path& output, const Shard& shard) {
  return fmt::format("{}.{}", output.string(), shard.name());
}

MeshReport mesh(const Scene& scene, const std::filesystem::path& output, const MeshOptions& options, const Progress& progress,
                const std::atomic<bool>& stop) {
  const std::filesystem::path target = options.shard ? part_path(output, *options.shard) : output;
  try {
    return MeshRun(scene, output, options, progress, stop).run();
  } catch (...) {
    // A run that fails removes its partial file, so the checkpoint goes as well. A run that can't begin to resume leaves both.
    if (!std::filesystem::exists(target.string() + ".partial")) remove_checkpoint(target);
    throw;
  }
}

}  // namespace teracell::mesher
