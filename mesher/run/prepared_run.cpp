#include "mesher/run/prepared_run.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mesher/closing/trust.hpp"
#include "mesher/engines/engines.hpp"
#include "mesher/run/read_scene.hpp"
#include "mesher/scene/placement.hpp"
#include "mesher/thin/marker.hpp"
#include "store/base/error.hpp"
#include "store/base/system/system.hpp"
#include "store/base/zstd_frame.hpp"
#include "store/format/format.hpp"
#include "store/text/json_writer.hpp"

namespace teracell::mesher {
namespace {

std::filesystem::path folder_of(const std::filesystem::path& file) { return file.has_parent_path() ? file.parent_path() : "."; }

}  // namespace

PreparedRun::PreparedRun(const Scene& of, const std::filesystem::path& output, const MeshOptions& with, bool count, const Progress& progress,
                         const std::atomic<bool>& stop)
    : scene(of),
      options(with),
      counts(count),
      threads(threads_of(with)),
      budget{with.memory, with.tmp.empty() ? folder_of(output) : with.tmp, searches_scene(with.engine)},
      output_(output.string()),
      progress_(progress),
      stop_(stop) {
  system::give_back_memory(budget.unasked());
  bodies = read_scene(scene, options, threads, budget, counts, true, [this](const char* phase, double share) { this->progress(phase, share); });
  end_phase("read");
  plan = make_plan(scene, bodies, options.axis, options.chunk_rays, options.fractions, options.links);
  for (BodyFacets& body : bodies.bodies) body.flat = {};
  close_bodies(scene, plan.meta.grid, budget, bodies, [&](double share) { this->progress("close", share); });
  plan.meta.patches = patches.emplace(scene, bodies, plan.meta.grid).all();
  plan.all_patches = patches->whole();
  if (!options.write_caps.empty()) caps_ = write_caps(scene, bodies, options.write_caps, budget);
  end_phase("close");
  if (counts) check_caps();
  end_phase("check");
  widened = widened_bodies(scene, options.thin || options.fractions, options.links);
}

void PreparedRun::end_phase(const char* name) {
  const auto now = std::chrono::steady_clock::now();
  run.phases.push_back({name, std::chrono::duration<double>(now - phase_began_).count()});
  phase_began_ = now;
}

void PreparedRun::progress(const char* phase, double share) const {
  if (stop_) throw Interrupted(fmt::format("{}: interrupted: nothing was written", output_));
  double cells = 1;
  for (const int64_t n : plan.meta.grid.cells()) cells *= static_cast<double>(n);
  progress_(phase, share, cells);
}

// Compares bodies that were open with the winding number of their surface. This rounds, so it stays out of the file.
void PreparedRun::check_caps() {
  std::vector<size_t> doubtful;
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    const ClosedBody& closed = bodies.bodies[b].closed;
    const bool extruded = !closed.walls[0].empty() || !closed.walls[1].empty();
    if (closed.was_open && !extruded && closed.fill.size() == 1 && closed.fill[0].rule == Fill::kNonzero) doubtful.push_back(b);
  }
  for (const size_t b : doubtful) {
    const SceneBody& body = scene.bodies[b];
    const BodyFacets& found = bodies.bodies[b];
    const ClosedBody& closed = found.closed;
    progress("check", static_cast<double>(b) / static_cast<double>(scene.bodies.size()));
    const std::vector<Vec3> points = draw_trust_points(found.lo, found.hi, plan.meta.grid, trust_points(found.file.facets, doubtful.size()));
    if (points.empty()) continue;
    // Each thread goes through all facets. Where that means reading the file, there is one thread.
    const Trust trust = try_points(points, found.lo, found.hi, bodies.in_memory ? threads : 1, [&](TrustCheck& check) {
      for_each_facet(body, found, bodies, budget, [&](const Facet& f) { check.add_surface(moved(f, body)); });
      for (const Facet& f : closed.added[0]) check.add_closing(moved(f, body));
    });
    run.trust.push_back({body.name, trust});
  }
}

CostMap PreparedRun::costs() const {
  CostMap costs(plan.meta, widened);
  for_each_placed(scene, bodies, budget, [&](const Facet& f, uint32_t layer) { costs.add(f, layer); });
  return costs;
}

std::string PreparedRun::identity() const {
  const auto brief = [](std::string text) {
    constexpr size_t kLongest = size_t{1} << 20;
    return text.size() <= kLongest ? text
                                   : fmt::format("\"{} bytes with checksum {:016x}\"", text.size(),
                                                 checksum({reinterpret_cast<const uint8_t*>(text.data()), text.size()}));
  };
  std::string inputs;
  write_list(inputs, scene.bodies.size(), ~size_t{0}, [&](JsonWriter& writer, size_t b) {
    const SurfaceFile& file = bodies.bodies[b].file;
    writer.begin_object().field("bytes", file.bytes).field("hash", file.hash);
    if (file.cad) writer.field("facets", file.cad->hash);
    writer.end_object();
  });
  nlohmann::ordered_json rest = {{"axis", axis_name(plan.meta.ray_axis)},
                                 {"axis_asked_for", plan.rays.asked_for},
                                 {"chunk_rays", plan.meta.chunk_rays},
                                 {"thin", options.thin},
                                 {"format", fmt::format("{}.{}", kFormatMajor, kFormatMinor)},
                                 {"zstd", compressor_version()}};
  if (options.fractions) rest["fractions"] = *options.fractions;
  if (options.links) rest["links"] = true;
  return fmt::format("{{\"inputs\":{},\"scene\":{},{}", brief(std::move(inputs)), brief(normalised(scene)), rest.dump().substr(1));
}

std::vector<const SceneFacet*> PreparedRun::of_solids(const GridFacets* facets) const {
  if (!facets)
    throw InputError(
        fmt::format("engine {} searches all facets at once, and these do not fit into the memory given; engine scan does not need them all at once",
                    options.engine),
        Remedy::kMoreMemory);
  std::vector<const SceneFacet*> all;
  facets->for_each(0, facets->size(), [&](const SceneFacet& f) {
    if (!(f.layer & kIgnored) && scene.bodies[body_of_layer(f.layer)].kind == Kind::kSolid) all.push_back(&f);
  });
  return all;
}

void PreparedRun::commit_caps() {
  for (const auto& file : caps_) file->commit();
}

}  // namespace teracell::mesher
