#include "mesher/pipeline.hpp"

#include <malloc.h>

#include <chrono>
#include <fstream>
#include <mutex>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mesher/caps_file.hpp"
#include "mesher/checkpoint.hpp"
#include "mesher/closing/trust.hpp"
#include "mesher/engines/engines.hpp"
#include "mesher/make_report.hpp"
#include "mesher/part_found.hpp"
#include "mesher/report_json.hpp"
#include "mesher/scene/placement.hpp"
#include "mesher/tile_group.hpp"
#include "mesher/tiled_facets.hpp"
#include "store/in_order.hpp"
#include "store/json_writer.hpp"
#include "store/part.hpp"
#include "store/writer.hpp"

namespace teracell {
namespace {

using nlohmann::ordered_json;

std::filesystem::path folder_of(const std::filesystem::path& file) { return file.has_parent_path() ? file.parent_path() : "."; }

// Gives freed memory back to the system, which the allocator would keep: that of a large scene's JSON, and of facets that were dropped.
void give_back_memory() {
#ifdef __GLIBC__
  ::malloc_trim(0);
#endif
}

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

// One run. The steps stand in the order of run().
class MeshRun {
 public:
  MeshRun(const Scene& scene, const std::filesystem::path& output, const MeshOptions& options, const Progress& progress,
          const std::atomic<bool>& stop)
      : scene_(scene),
        output_(options.shard ? part_path(output, *options.shard) : output),
        options_(options),
        progress_(progress),
        stop_(stop),
        threads_(options.threads > 0 ? options.threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()))),
        budget_{options.memory, options.tmp.empty() ? folder_of(output) : options.tmp} {}

  MeshReport run() {
    give_back_memory();
    bodies_ = read_bodies(scene_, threads_, budget_, counts(), [&](double share) { progress("read", share); });
    give_back_memory();
    end_phase("read");
    plan_ = make_plan(scene_, bodies_, options_.axis, options_.chunk_rays);
    close_bodies(scene_, plan_.meta.grid, budget_, bodies_, [&](double share) { progress("close", share); });
    if (!options_.write_caps.empty()) caps_ = write_caps(scene_, bodies_, options_.write_caps, budget_);
    end_phase("close");
    check_caps();
    end_phase("check");
    const std::vector<bool> widened = widened_bodies(scene_, options_.thin);
    if (options_.shard) range_ = stretch(widened);
    open_output();
    TiledFacets facets(scene_, bodies_, plan_.meta, widened, range_, counts(), budget_, threads_, [&](double share) { progress("spill", share); });
    const EngineMaker make_engine = engine_maker(options_.engine, plan_.meta.frame(), [&] { return of_solids(facets.in_memory()); });
    end_phase("prepare");
    cast(facets.tiling(), make_engine);
    MeshReport out;
    if (options_.shard) {
      finish_part(facets);
    } else {
      out.report = make_report(scene_, std::move(bodies_), facets.counts(), plan_, totals_, options_.thin);
      out.json = report_json(out.report, scene_);
      end_phase("cast");
      finish(out.json);
    }
    describe_run(facets.spilled_bytes());
    out.run = std::move(run_);
    out.scene = scene_;
    out.caps_written = caps_.size();
    return out;
  }

 private:
  // Whether this run finds what the report says of the surfaces as a whole: of a grid that is made in parts, the first part does.
  bool counts() const { return !options_.shard || options_.shard->number == 0; }

  void end_phase(const char* name) {
    const auto now = std::chrono::steady_clock::now();
    run_.phases.push_back({name, std::chrono::duration<double>(now - phase_began_).count()});
    phase_began_ = now;
  }

  void progress(const char* phase, double share) {
    if (stop_) throw Interrupted(fmt::format("{}: interrupted: nothing was written", output_.string()));
    double cells = 1;
    for (const int64_t n : plan_.meta.grid.cells()) cells *= static_cast<double>(n);
    progress_(phase, share, cells);
  }

  // Compares bodies that were open with the winding number of their surface. This rounds, so it stays out of the file.
  void check_caps() {
    std::vector<size_t> doubtful;
    for (size_t b = 0; b < scene_.bodies.size(); ++b) {
      const ClosedBody& closed = bodies_.bodies[b].closed;
      const bool extruded = !closed.walls[0].empty() || !closed.walls[1].empty();
      if (closed.was_open && !extruded && closed.fill.size() == 1 && closed.fill[0].rule == Fill::kNonzero) doubtful.push_back(b);
    }
    for (const size_t b : doubtful) {
      const SceneBody& body = scene_.bodies[b];
      const BodyFacets& found = bodies_.bodies[b];
      const ClosedBody& closed = found.closed;
      progress("check", static_cast<double>(b) / static_cast<double>(scene_.bodies.size()));
      const std::vector<Vec3> points = draw_trust_points(found.lo, found.hi, plan_.meta.grid, trust_points(found.file.facets, doubtful.size()));
      if (points.empty()) continue;
      // Each thread goes through all facets. Where that means reading the file, there is one thread.
      const Trust trust = try_points(points, found.lo, found.hi, bodies_.in_memory ? threads_ : 1, [&](TrustCheck& check) {
        for_each_facet(body, found, bodies_, budget_, [&](const Facet& f) { check.add_surface(moved(f, body)); });
        for (const Facet& f : closed.added[0]) check.add_closing(moved(f, body));
      });
      run_.trust.push_back({body.name, trust});
    }
  }

  TreeRange stretch(const std::vector<bool>& widened) {
    CostMap costs(plan_.meta, widened);
    for_each_placed(scene_, bodies_, budget_, [&](const Facet& f, uint32_t layer) { costs.add(f, layer); });
    return costs.stretch(*options_.shard);
  }

  // What the bytes of the whole grid depend on. A long part is represented by its checksum, because every checkpoint holds all of this.
  std::string identity() const {
    const auto brief = [](std::string text) {
      constexpr size_t kLongest = size_t{1} << 20;
      return text.size() <= kLongest ? text
                                     : fmt::format("\"{} bytes with checksum {:016x}\"", text.size(),
                                                   checksum({reinterpret_cast<const uint8_t*>(text.data()), text.size()}));
    };
    std::string inputs;
    write_list(inputs, scene_.bodies.size(), ~size_t{0}, [&](JsonWriter& writer, size_t b) {
      const SurfaceFile& file = bodies_.bodies[b].file;
      writer.begin_object().field("path", scene_.bodies[b].mesh_text).field("bytes", file.bytes).field("hash", file.hash).end_object();
    });
    const ordered_json rest = {{"axis", axis_name(plan_.meta.ray_axis)},
                               {"axis_asked_for", plan_.rays.asked_for},
                               {"chunk_rays", plan_.meta.chunk_rays},
                               {"thin", options_.thin},
                               {"format", fmt::format("{}.{}", kFormatMajor, kFormatMinor)},
                               {"zstd", compressor_version()}};
    return fmt::format("{{\"inputs\":{},\"scene\":{},{}", brief(std::move(inputs)), brief(normalised(scene_)), rest.dump().substr(1));
  }

  // What the bytes of this run's output depend on.
  std::string identity_of_output() const {
    if (!options_.shard) return identity();
    return fmt::format("{},\"shard\":\"{}\"}}", identity().substr(0, identity().size() - 1), options_.shard->name());
  }

  void open_output() {
    totals_.cells.resize(scene_.bodies.size());
    totals_.covered.resize(scene_.bodies.size());
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
      sink_ = &part_.emplace(output_, PartHead{identity(), options_.shard->number, options_.shard->of, range_, plan_.meta}, state...);
    else sink_ = &writer_.emplace(output_, plan_.meta, state...);
  }

  std::vector<const SceneFacet*> of_solids(const GridFacets* facets) const {
    if (!facets)
      throw InputError(
          fmt::format("engine {} searches all facets at once, and these do not fit into the memory given; engine scan does not need them all at once",
                      options_.engine),
          Remedy::kMoreMemory);
    std::vector<const SceneFacet*> all;
    facets->for_each(0, facets->size(), [&](const SceneFacet& f) {
      if (!(f.layer & kIgnored) && scene_.bodies[body_of_layer(f.layer)].kind == Kind::kSolid) all.push_back(&f);
    });
    return all;
  }

  void cast(Tiling& tiling, const EngineMaker& make_engine) {
    std::vector<Layer> layers;  // layer_of()
    for (uint32_t b = 0; b < scene_.bodies.size(); ++b) layers.insert(layers.end(), {{b, false}, {b, true}});
    std::vector<std::unique_ptr<Worker>> workers;
    for (int i = 0; i < threads_; ++i)
      workers.push_back(std::make_unique<Worker>(make_engine(), layers, plan_.labels, scene_, plan_.meta, options_.thin));
    for (uint64_t done = 0; done < groups_; ++done) {
      tiling.next();
      progress("resume", static_cast<double>(done) / static_cast<double>(groups_));
    }

    struct Job {
      std::shared_ptr<TileGroupWork> work;
      uint32_t row;
    };
    Job next{nullptr, TileGroupWork::kRows};
    // Groups that are stored. To free them takes time, so a thread that casts does it.
    std::vector<std::shared_ptr<TileGroupWork>> stored;
    std::mutex of_stored;
    Checkpoints checkpoints(options_.checkpoint_seconds);
    in_order(
        threads_,
        [&]() -> std::optional<Job> {
          if (next.row == TileGroupWork::kRows) {
            auto group = tiling.next();
            if (!group) return std::nullopt;
            auto above = pyramid_->node_above(2, group->cu, group->cv);
            next = {std::make_shared<TileGroupWork>(std::move(*group), tiling, plan_.meta, std::move(above)), 0};
          }
          return Job{next.work, next.row++};
        },
        [&](Job job, int worker) {
          std::unique_lock lock(of_stored);
          auto freed = std::exchange(stored, {});
          lock.unlock();
          freed.clear();
          job.work->make_row(job.row, *workers[worker]);
          return job;
        },
        [&](Job job) {
          if (job.row + 1 < TileGroupWork::kRows) return;  // rows come in order, so with the last one all are made
          store(*job.work);
          {
            std::lock_guard lock(of_stored);
            stored.push_back(std::move(job.work));
          }
          checkpoints.maybe([&] { save(); });
          progress("mesh", static_cast<double>(groups_) / static_cast<double>(tiling.groups()));
        },
        size_t{2} * TileGroupWork::kRows);
  }

  void store(TileGroupWork& work) {
    for (const LevelChunk& chunk : work.chunks()) pyramid_->put(chunk);
    pyramid_->put_above(work.above(), work.group().cu, work.group().cv);
    for (const RowTotals& row : work.totals()) totals_.add(row);
    ++groups_;
  }

  void save() {
    if (identity_.empty()) identity_ = identity_of_output();
    Checkpoint c{identity_, groups_, totals_, {}};
    sink_->save(c.writers);
    pyramid_->save(c.writers);
    save_checkpoint(c, output_);
  }

  void finish_part(TiledFacets& facets) {
    std::optional<SurfacesFound> found;
    if (counts()) {
      std::vector<SurfaceCounts> of_bodies = facets.counts();
      found.emplace(SurfacesFound{scene_, std::move(bodies_), std::move(of_bodies), plan_.rays, options_.thin});
    }
    end_phase("cast");
    progress("write", 0);
    part_->finish(encode_found(totals_, found ? &*found : nullptr));
    remove_checkpoint(output_);
    end_phase("finish");
  }

  void finish(const std::string& report) {
    progress("write", 0);
    writer_->finish(report, totals_.crossings);
    remove_checkpoint(output_);
    for (const auto& file : caps_) file->commit();
    end_phase("finish");
  }

  void describe_run(uint64_t spilled_bytes) {
    run_.peak_memory_bytes = peak_memory_bytes();
    run_.threads = threads_;
    run_.engine = options_.engine;
    run_.exact_decisions = totals_.exact_decisions;
    run_.spilled_bytes = spilled_bytes;
    run_.resumed_chunks = resumed_chunks_;
    run_.file_bytes = sink_->bytes();
  }

  const Scene& scene_;
  const std::filesystem::path output_;
  const MeshOptions& options_;
  const Progress& progress_;
  const std::atomic<bool>& stop_;
  const int threads_;
  const Budget budget_;
  Bodies bodies_;
  std::vector<std::unique_ptr<OutputFile>> caps_;
  RunReport run_;
  std::chrono::steady_clock::time_point phase_began_ = std::chrono::steady_clock::now();
  Plan plan_;
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

// From /proc, because getrusage() has the peak of the program that launched this one, if that was larger.
uint64_t peak_memory_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (uint64_t kib; word == "VmHWM:" && status >> kib) return kib * 1024;
  return 0;
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

}  // namespace teracell
