#include "mesher/pipeline.hpp"

#include <malloc.h>

#include <chrono>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mesher/caps_file.hpp"
#include "mesher/checkpoint.hpp"
#include "mesher/engines/engines.hpp"
#include "mesher/tiled_facets.hpp"
#include "mesher/scene/placement.hpp"
#include "mesher/report.hpp"
#include "mesher/closing/trust.hpp"
#include "mesher/tile_group.hpp"
#include "store/in_order.hpp"
#include "store/json_writer.hpp"

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

// Of this process: getrusage() would tell the launching one's, if that was larger before exec.
uint64_t peak_memory_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (uint64_t kib; word == "VmHWM:" && status >> kib) return kib * 1024;
  return 0;
}

// What was freed stays with the process unless it is asked for: the tree of a large scene's JSON, facets that were dropped.
void give_back_memory() {
#ifdef __GLIBC__
  ::malloc_trim(0);
#endif
}

// How often a long run makes what it has durable: rarely enough for that to take no more than a twentieth of the time;
// with 0 seconds whenever it can.
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

// One run, step by step in the order of run().
class MeshRun {
 public:
  MeshRun(const Scene& scene, const std::filesystem::path& output, const MeshOptions& options, const Progress& progress, const std::atomic<bool>& stop)
      : scene_(scene),
        output_(output),
        options_(options),
        progress_(progress),
        stop_(stop),
        threads_(options.threads > 0 ? options.threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()))),
        budget_{options.memory, options.tmp.empty() ? folder_of(output) : options.tmp} {}

  MeshReport run() {
    give_back_memory();
    bodies_ = read_bodies(scene_, threads_, budget_, [&](double share) { tick("read", share); });
    give_back_memory();
    phases_.end("read");
    plan_ = make_plan(scene_, bodies_, options_.axis, options_.chunk_rays);
    close_bodies(scene_, plan_.meta.grid, budget_, bodies_, [&](double share) { tick("close", share); });
    if (!options_.write_caps.empty()) caps_ = write_caps(scene_, bodies_, options_.write_caps, budget_);
    phases_.end("close");
    check_caps();
    phases_.end("check");
    open_output();
    Feed feed(scene_, bodies_, plan_.meta, wide_bodies(scene_, options_.thin), budget_, threads_, [&](double share) { tick("spill", share); });
    const EngineMaker make_engine = engine_maker(options_.engine, plan_.meta.frame(), [&] { return all_facets(); });
    phases_.end("prepare");
    cast(feed.tiling(), make_engine);
    Report report = make_report(scene_, bodies_, feed.surveys(), plan_, totals_, options_.thin);
    phases_.end("cast");
    finish(report.text);
    const ordered_json run = of_this_run(report.warnings, feed.spilled_bytes());
    return {std::move(report.text), std::move(report.warnings), caps_.size(), run.dump()};
  }

 private:
  void tick(const char* phase, double share) {
    if (stop_) throw Interrupted(fmt::format("{}: interrupted: nothing was written", output_.string()));
    double cells = 1;
    for (const int64_t n : plan_.meta.grid.cells()) cells *= static_cast<double>(n);
    progress_(phase, share, cells);
  }

  // Holds bodies that were open against the winding number of their surface. It rounds, so it stays out of the file.
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
      tick("check", static_cast<double>(b) / static_cast<double>(scene_.bodies.size()));
      const std::vector<Vec3> points = draw_trust_points(found.lo, found.hi, plan_.meta.grid, trust_points(found.file.facets, doubtful.size()));
      if (points.empty()) continue;
      // Each thread goes through all facets: where that means to read the file, one does.
      const Trust trust = try_points(points, found.lo, found.hi, bodies_.in_memory ? threads_ : 1, [&](TrustCheck& check) {
        for_each_facet(body, found, bodies_, budget_, [&](const Facet& f) { check.add_surface(moved(f, body)); });
        for (const Facet& f : closed.added[0]) check.add_closing(moved(f, body));
      });
      trust_.emplace_back(b, trust);
    }
  }

  // What the file's bytes depend on. Long parts stand by their checksum: a checkpoint has it all.
  std::string identity() const {
    const auto brief = [](std::string text) {
      constexpr size_t kLongest = size_t{1} << 20;
      return text.size() <= kLongest ? text : fmt::format("\"{} bytes with checksum {:016x}\"", text.size(), checksum({reinterpret_cast<const uint8_t*>(text.data()), text.size()}));
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

  void open_output() {
    totals_.cells.resize(scene_.bodies.size());
    totals_.covered.resize(scene_.bodies.size());
    std::optional<Checkpoint> before;
    if (options_.resume) before = load_checkpoint(output_, identity());
    if (!before) {
      writer_.emplace(output_, plan_.meta);
      remove_checkpoint(output_);  // of an earlier run; only now that the lock is ours
      pyramid_.emplace(*writer_);
      return;
    }
    ByteReader state(before->writers, checkpoint_path(output_).string());
    writer_.emplace(output_, plan_.meta, state);
    pyramid_.emplace(*writer_);
    pyramid_->restore(state);
    totals_ = before->totals;
    units_ = before->units;
    resumed_chunks_ = writer_->chunks();
  }

  // Of solids.
  std::vector<const SceneFacet*> all_facets() const {
    if (!bodies_.in_memory)
      throw InputError(fmt::format("engine {} searches all facets at once, and these do not fit into the memory given; engine scan does not need them all at once",
                                   options_.engine), Remedy::kMoreMemory);
    std::vector<const SceneFacet*> all;
    std::as_const(*bodies_.facets).for_each(0, bodies_.facets->size(), [&](const SceneFacet& f) {
      if (!(f.layer & kIgnored) && scene_.bodies[f.layer / 2].kind == Kind::kSolid) all.push_back(&f);
    });
    return all;
  }

  void cast(Tiling& tiling, const EngineMaker& make_engine) {
    std::vector<Layer> layers;  // layer_of()
    for (uint32_t b = 0; b < scene_.bodies.size(); ++b) layers.insert(layers.end(), {{b, false}, {b, true}});
    std::vector<std::unique_ptr<Worker>> workers;
    for (int i = 0; i < threads_; ++i) workers.push_back(std::make_unique<Worker>(make_engine(), layers, plan_.labels, scene_, plan_.meta, options_.thin));
    for (uint64_t done = 0; done < units_; ++done) {
      tiling.next();
      tick("resume", static_cast<double>(done) / static_cast<double>(units_));
    }

    struct Job {
      std::shared_ptr<UnitWork> work;
      uint32_t row;
    };
    Job next{nullptr, UnitWork::kRows};
    Checkpoints checkpoints(options_.checkpoint_seconds);
    in_order(
        threads_,
        [&]() -> std::optional<Job> {
          if (next.row == UnitWork::kRows) {
            auto unit = tiling.next();
            if (!unit) return std::nullopt;
            next = {std::make_shared<UnitWork>(std::move(*unit), tiling, plan_.meta), 0};
          }
          return Job{next.work, next.row++};
        },
        [&](Job job, int worker) {
          job.work->make_row(job.row, *workers[worker]);
          return job;
        },
        [&](Job job) {
          if (job.row + 1 < UnitWork::kRows) return;  // taken in order: with the last row all are made
          store(*job.work);
          checkpoints.maybe([&] { save(); });
          tick("mesh", static_cast<double>(units_) / static_cast<double>(tiling.units()));
        },
        2 * UnitWork::kRows);
  }

  void store(UnitWork& work) {
    for (const LevelChunk& chunk : work.chunks()) pyramid_->put(chunk);
    pyramid_->rise(2, work.unit().cu, work.unit().cv, std::move(work.coarse()));
    for (const RowTotals& row : work.totals()) totals_.add(row);
    ++units_;
  }

  void save() {
    if (identity_.empty()) identity_ = identity();
    Checkpoint c{identity_, units_, totals_, {}};
    writer_->save(c.writers);
    pyramid_->save(c.writers);
    save_checkpoint(c, output_);
  }

  void finish(const std::string& report) {
    tick("write", 0);
    writer_->finish(report, totals_.crossings);
    remove_checkpoint(output_);
    for (const auto& file : caps_) file->commit();
    phases_.end("finish");
  }

  // What only --report shows. Adds to the warnings.
  ordered_json of_this_run(std::vector<std::string>& warnings, uint64_t spilled_bytes) const {
    ordered_json run;
    run["trust"] = ordered_json::array();
    for (const auto& [b, trust] : trust_) {
      ordered_json found = {{"body", scene_.bodies[b].name}, {"points", trust.points}, {"disagree", trust.disagree}};
      if (trust.disagree > 0) found["at"] = trust.at, found["box"] = {trust.lo, trust.hi};
      run["trust"].push_back(std::move(found));
      if (std::string words = trust_warning(trust, scene_.bodies[b].name); !words.empty()) warnings.push_back(std::move(words));
    }
    run["phases"] = phases_.list();
    run["peak_memory_bytes"] = peak_memory_bytes();
    run["threads"] = threads_;
    run["engine"] = options_.engine;
    run["exact_decisions"] = totals_.exact_decisions;
    run["spilled_bytes"] = spilled_bytes;
    run["resumed_chunks"] = resumed_chunks_;
    run["file_bytes"] = writer_->bytes();
    return run;
  }

  const Scene& scene_;
  const std::filesystem::path& output_;
  const MeshOptions& options_;
  const Progress& progress_;
  const std::atomic<bool>& stop_;
  const int threads_;
  const Budget budget_;
  Phases phases_;
  Bodies bodies_;
  std::vector<std::unique_ptr<OutputFile>> caps_;
  std::vector<std::pair<size_t, Trust>> trust_;  // of the bodies that were open
  Plan plan_;
  std::optional<GridWriter> writer_;
  std::optional<PyramidWriter> pyramid_;
  std::string identity_;  // from the first save() on
  CastTotals totals_;
  uint64_t units_ = 0;  // stored
  uint64_t resumed_chunks_ = 0;
};

}  // namespace

ordered_json MeshReport::whole() const {
  ordered_json out = ordered_json::parse(in_file);
  out["warnings"] = warnings;
  out.update(ordered_json::parse(of_this_run));
  return out;
}

MeshReport mesh(const Scene& scene, const std::filesystem::path& output, const MeshOptions& options,
                  const Progress& progress, const std::atomic<bool>& stop) {
  try {
    return MeshRun(scene, output, options, progress, stop).run();
  } catch (...) {
    // The partial file goes with the run; so does what belongs to it. Not so when a run can't even begin to resume.
    if (!std::filesystem::exists(output.string() + ".partial")) remove_checkpoint(output);
    throw;
  }
}

}  // namespace teracell
