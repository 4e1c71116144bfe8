#include "mesher/bodies/bodies.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "mesher/bodies/extent.hpp"
#include "mesher/bodies/part_counts.hpp"
#include "mesher/closing/extrude.hpp"
#include "mesher/closing/lengths.hpp"
#include "mesher/closing/surface_counts.hpp"
#include "mesher/planes/make_planes.hpp"
#include "mesher/scene/placement.hpp"
#include "store/base/error.hpp"

namespace teracell::mesher {
namespace {

// What a facet in memory takes: the facet, its place among the rays, its numbers in the lists of the tiling, and its part of the
// tables that count what its surface is made of.
constexpr uint64_t kBytesPerFacet = 160;
// More facets than these are put into bins in any case, even if the bins stay in memory: a bin is read from end to end, and has a tenth
// of the bytes. With 6.4 million facets and 8 GB, bins took 0.66 of the time and 196 in place of 801 MB for a binary STL file, 0.74 for a compressed
// one and 0.95 for an OBJ file, though these are parsed twice then. With 1.6 million facets bins took 1.6 times as long.
constexpr uint64_t kMostTogether = uint64_t{4} << 20;

// Facets were written by another processor. Asked for so many facets before they are used, they arrive in time; the processor asked by itself for too
// few, and waiting for the others took half of the time of the study.
constexpr size_t kFacetsAhead = 16;

// So many facets are looked at together: they stay in the cache for what is found of them one after the other.
constexpr size_t kAtOnce = 64;

// What a pass over the facets of a body finds that does not depend on their order: whether the surface is closed, whether it has opposite facets,
// and, unless only a sample is kept, how many lie on others or have no area.
class alignas(64) Topology {  // so that those of different threads share no line of a cache
 public:
  template <class F>
  void take(std::span<const F> facets, size_t behind);
  void add(const Topology& other) { boundary_.add(other.boundary_), facets_.add(other.facets_); }  // of the same body; both keep samples
  void keep_sample() { facets_.keep_sample(); }
  void begin() {
    boundary_ = {};
    facets_.clear();
    degenerate_ = 0;
  }
  const BoundaryProof& boundary() const { return boundary_; }
  // Counts, without shells, and whether there are opposite facets.
  std::pair<SurfaceCounts, bool> found() {
    const EqualFacets equal = facets_.equal();
    const SurfaceCounts counts = facets_.is_sample() ? SurfaceCounts() : SurfaceCounts{degenerate_, equal.duplicates, equal.opposite, 0};
    return {counts, equal.opposite_in_sample};
  }

 private:
  BoundaryProof boundary_;
  FacetSet facets_;
  uint64_t degenerate_ = 0;
};

const Facet& facet_of(const Facet& f) { return f; }
const Facet& facet_of(const SceneFacet& f) { return f.facet; }

// `behind`: how many facets come behind these in memory. REQUIRES: at most kAtOnce facets.
template <class F>
void Topology::take(std::span<const F> facets, size_t behind) {
  std::array<std::array<VertexHash, 3>, kAtOnce> hashes;
  for (size_t i = 0; i < facets.size(); ++i) {
    __builtin_prefetch(&facets[i] + std::min<size_t>(kFacetsAhead, facets.size() - 1 - i + behind));
    hashes[i] = vertex_hashes(facet_of(facets[i]));
    facets_.add(hashes[i]);
  }
  boundary_.add(std::span(hashes).first(facets.size()));
  if (facets_.is_sample()) return;
  for (const F& f : facets) degenerate_ += has_no_area(facet_of(f));
}

// The one pass over all facets. Of each body it finds its Topology; of all of them, where their matrices put them, the box and the areas of their
// projections. Areas are sums of those of FacetBlocks::kFacets facets that come one after another, whether they come as blocks or not.
class Study {
 public:
  Study(const Vec3& flat_slack, bool count) : flat_slack_(flat_slack), flat_(flat_slack) {
    if (!count) count_no_longer();
    begin();
  }
  // What the surfaces are made of will be counted when they are read once more.
  void count_no_longer() { topology_.keep_sample(); }
  // Facets of one patch.
  template <class F>
  void take(std::span<const F> facets, const SceneBody& body, uint32_t patch) {
    if (patch != patch_) end_group(), patch_ = patch;
    while (!facets.empty()) {
      const auto some = facets.first(std::min(facets.size(), FacetBlocks::kFacets - in_group_));
      facets = facets.subspan(some.size());
      if (flat_.wanted())
        take_some(some, facets.size(), body, topology_, group_, [this](const Facet& f, double size) { flat_.take(f.vertex, size); });
      else take_some(some, facets.size(), body, topology_, group_, kNoFlat);
      in_group_ += some.size();
      if (in_group_ == FacetBlocks::kFacets) end_group();
    }
  }
  // Whether the facets of a body may come as blocks, in parts on several threads: take_block() for each, on any thread with a topology that no other
  // one uses; then add_block() with the outcome, in the order of the blocks; and add_topology() for each thread.
  bool takes_blocks() const { return !FlatFaceSearch(flat_slack_).wanted(); }
  struct Measures {
    Extent extent;
    double size = 0;  // the areas of all facets
  };
  static Measures take_block(std::span<const Facet> facets, const SceneBody& body, Topology& topology) {
    Measures out;
    take_some(facets, 0, body, topology, out, kNoFlat);
    return out;
  }
  void add_block(const Measures& of_block, uint32_t patch) {
    if (patch >= areas_.size()) areas_.resize(patch + 1);
    extent_.add(of_block.extent), areas_[patch] += of_block.size;
  }
  void add_topology(Topology& of_thread) { topology_.add(of_thread), of_thread.begin(); }
  // REQUIRES: all facets of the body were taken.
  void end_body() {
    end_group();
    const auto [counts, opposites] = topology_.found();
    bodies_.push_back({extent_.lo, extent_.hi, topology_.boundary(), opposites, counts, std::exchange(areas_, {}), std::move(flat_).found()});
    begin();
  }
  void hand_over(Bodies& out) {
    out.lo.fill(HUGE_VAL), out.hi.fill(-HUGE_VAL);
    out.area = extent_.area;
    for (size_t b = 0; b < bodies_.size(); ++b) {
      BodyFacets& body = out.bodies[b];
      body.lo = bodies_[b].lo, body.hi = bodies_[b].hi;
      body.boundary = bodies_[b].boundary;
      body.opposites = bodies_[b].opposites;
      body.facet_counts = bodies_[b].counts;
      body.areas = std::move(bodies_[b].areas);
      body.flat = std::move(bodies_[b].flat);
      for (int d = 0; d < 3; ++d) {
        out.lo[d] = std::min(out.lo[d], body.lo[d]);
        out.hi[d] = std::max(out.hi[d], body.hi[d]);
      }
    }
  }

 private:
  struct Found {
    Vec3 lo, hi;
    BoundaryProof boundary;
    bool opposites;
    SurfaceCounts counts;  // without shells
    std::vector<double> areas;
    FlatFaces flat;
  };
  static constexpr auto kNoFlat = [](const Facet&, double) TERACELL_IN_LINE {};
  template <class F, class TakeFlat>
  static void take_some(std::span<const F> facets, size_t behind, const SceneBody& body, Topology& topology, Measures& out,
                        const TakeFlat& take_flat) {
    for (; !facets.empty(); facets = facets.subspan(std::min(facets.size(), kAtOnce))) {
      const auto some = facets.first(std::min(facets.size(), kAtOnce));
      topology.take(some, static_cast<size_t>(&facets.back() - &some.back()) + behind);
      const auto measure = [&](const auto& facet_at) {
        out.extent.add(some.size(), facet_at, out.size, [&](size_t i, double size) TERACELL_IN_LINE { take_flat(facet_at(i), size); });
      };
      if (body.matrix == kIdentity) {
        measure([&](size_t i) TERACELL_IN_LINE -> const Facet& { return facet_of(some[i]); });
        continue;
      }
      std::array<Facet, kAtOnce> there;
      for (size_t i = 0; i < some.size(); ++i) there[i] = moved(facet_of(some[i]), body);
      measure([&](size_t i) TERACELL_IN_LINE -> const Facet& { return there[i]; });
    }
  }
  void end_group() {
    if (in_group_ == 0) return;
    add_block(std::exchange(group_, {}), patch_);
    in_group_ = 0;
  }
  void begin() {
    extent_ = {.area = extent_.area};
    topology_.begin();
    flat_ = FlatFaceSearch(flat_slack_);
    patch_ = 0;
  }
  Extent extent_;  // of the body; the areas are of all bodies
  std::vector<double> areas_;  // of patches
  Topology topology_;
  const Vec3 flat_slack_;
  FlatFaceSearch flat_;
  Measures group_;  // of the last in_group_ facets
  size_t in_group_ = 0;
  uint32_t patch_ = 0;  // of these
  std::vector<Found> bodies_;
};

// Before the bodies' box is known, only facets without any extent across an axis are flat.
Vec3 known_flat_slack(const Scene& scene) {
  Vec3 out = {-1, -1, -1};
  for (int d = 0; d < 3; ++d) {
    const SceneAxis& axis = scene.axis[d];
    if (axis.made && axis.made->snap != AutoPlanes::Snap::kNone) out[d] = axis.min ? face_slack({*axis.min, *axis.max}) : 0;
  }
  return out;
}

// A pipe can't be read a second time, so its facets must stay.
bool together(const Scene& scene, const Budget& budget) {
  return budget.together || std::ranges::any_of(scene.bodies, [](const SceneBody& b) {
           std::error_code ignored;
           return std::filesystem::is_other(b.mesh, ignored);
         });
}

// Reads the bodies one after another and hands what it reads to the helper, some thousand facets or bodies at a time. (With one
// job per body, a scene of 100,000 bodies spent more time on handing over than on the work.)
class BodyReader {
 public:
  BodyReader(const Scene& scene, const ExactSurfaces& exact, int threads, const Budget& budget, bool count, Bodies& out)
      : scene_(scene),
        exact_(exact),
        budget_(budget),
        together_(together(scene, budget)),
        most_(std::min(budget.bytes / 8 * 5 / kBytesPerFacet, together_ ? ~uint64_t{0} : kMostTogether)),
        count_(count),
        out_(out),
        shells_(out.shells),
        of_threads_(static_cast<size_t>(FacetBlocks::readers(budget, threads))) {}

  void read(const std::function<void(double)>& progress) {
    out_.bodies.reserve(scene_.bodies.size());
    for (size_t b = 0; b < scene_.bodies.size(); ++b) {
      const SceneBody& body = scene_.bodies[b];
      const uint32_t layer = layer_of(b, body.fill == Fill::kEvenodd);  // close_bodies() may change the layer
      BodyFacets& found = out_.bodies.emplace_back();
      if (exact_.has(b)) found.cad = exact_.of_body[b];
      const FacetBlocks blocks{.threads = static_cast<int>(of_threads_.size()),
                               .idle = out_.helper.get(),
                               .ahead = 8,
                               .wanted = [&] { return begin_blocks(); },
                               .take = [&](std::span<const Facet> facets, int worker) -> std::function<void()> {
                                 return [this, &progress, b, measures = Study::take_block(facets, body, of_threads_[static_cast<size_t>(worker)])] {
                                   study_->add_block(measures, patch_);
                                   progress(static_cast<double>(b) / static_cast<double>(scene_.bodies.size()));
                                 };
                               }};
      found.first = out_.in_memory ? out_.facets->size() : 0;
      found.file = read_facets(body.mesh, body.part,
                               [&](std::span<const Facet> facets) {
                                 take(b, layer, facets);
                                 progress(static_cast<double>(b) / static_cast<double>(scene_.bodies.size()));
                               },
                               {.budget = budget_,
                                .units = scene_.units,
                                .kept = out_.kept.get(),
                                .cad = cad_or_usual(found.cad),
                                .face_patches = body.face_patches,
                                .helper = out_.helper.get(),
                                .expect = [&](uint64_t facets) { make_room(facets); },
                                .enter_patch = [&](uint32_t patch) { patch_ = patch; },
                                .blocks = of_threads_.size() > 1 ? &blocks : nullptr,
                                .numbers = count_ ? &numbers_ : nullptr});
      end_blocks();
      if (KeptTree* kept = kept_of(body); kept && kept->tree->repeats()) {
        found.repeats = true;
        if (count_) found.counts = part_counts(*kept, body.part);
      }
      found.file.parts = {};  // many bodies may be parts of one file, and each would have the names of all
      if (!found.file.regular) once_.push_back(b);
      if (!out_.in_memory) expect_files();
      batch_.pieces.push_back({b, {}, 0, true, 0});
      if (batch_.pieces.size() >= kPieces) hand_on();
    }
    hand_on();
    out_.helper->finish();
    study_->hand_over(out_);
    if (exact_.box) take_exact_box();
    if (out_.in_memory) out_.kept->clear();
  }

 private:
  static constexpr size_t kFacets = 4096, kPieces = 1024;  // a batch is handed on once it has as many of either
  // Facets of a body that arrived together: they lie in the store, or are the next ones of Batch::copies. Or the end of the body.
  struct Piece {
    size_t body;
    std::span<const SceneFacet> stored;
    size_t copied;
    bool ends;
    uint32_t patch;
    bool numbered = false;  // the facets that are stored have numbers of vertices: those in Batch::numbers that come next
  };
  struct Batch {
    std::vector<Piece> pieces;
    std::shared_ptr<std::vector<Facet>> copies;  // null: there are none
    std::vector<std::array<uint32_t, 3>> numbers;
    size_t facets = 0;
  };

  // Where facets are not kept, those of a file that can be told apart are studied by all threads. (With one thread that reads and one that studies,
  // the second one was the bound.)
  bool begin_blocks() {
    if (out_.in_memory || !study_->takes_blocks()) return false;
    hand_on();
    out_.helper->finish();
    for (Topology& of_thread : of_threads_) of_thread.keep_sample();
    return has_blocks_ = true;
  }
  void end_blocks() {
    if (!std::exchange(has_blocks_, false)) return;
    for (Topology& of_thread : of_threads_) study_->add_topology(of_thread);
  }

  void take(size_t b, uint32_t layer, std::span<const Facet> facets) {
    if (out_.in_memory && !together_ && has_copies(b, facets.size())) spill();
    make_room(facets.size());
    batch_.facets += facets.size();
    if (!out_.in_memory) {
      batch_.pieces.push_back({b, {}, facets.size(), false, patch_});
      if (!batch_.copies) batch_.copies = copies_.next();
      batch_.copies->insert(batch_.copies->end(), facets.begin(), facets.end());
    }
    const bool numbered = numbers_.size() == facets.size();
    if (out_.in_memory && numbered) {
      if (batch_.numbers.empty()) batch_.numbers.swap(numbers_), numbers_.reserve(facets.size());
      else batch_.numbers.insert(batch_.numbers.end(), numbers_.begin(), numbers_.end());
    }
    while (out_.in_memory && !facets.empty()) {
      const std::span<const SceneFacet> stored = out_.facets->append(facets, layer, patch_);
      batch_.pieces.push_back({b, stored, 0, false, patch_, numbered});
      facets = facets.subspan(stored.size());
    }
    if (batch_.facets >= kFacets) hand_on();
  }

  // Null where the body's file has no tree. REQUIRES: it is the one that was read last.
  KeptTree* kept_of(const SceneBody& body) const {
    KeptTree* kept = out_.kept->latest();
    return kept && kept->name == body.mesh.native() ? kept : nullptr;
  }
  // So many facets of copies have arrived that they are worth having once.
  bool has_copies(size_t b, uint64_t more) const {
    KeptTree* kept = kept_of(scene_.bodies[b]);
    return kept && kept->tree->repeats(kept->taken += more);
  }

  void take_exact_box() {
    out_.lo = (*exact_.box)[0], out_.hi = (*exact_.box)[1];
    for (size_t b = 0; b < out_.bodies.size(); ++b)
      if (!exact_.has(b)) extend(out_.lo, out_.hi, out_.bodies[b].lo), extend(out_.lo, out_.hi, out_.bodies[b].hi);
  }

  void make_room(uint64_t facets) {
    if (out_.in_memory && out_.facets->size() + facets > most_) spill();
  }

  // Drops the facets that were kept, and no longer counts them.
  void spill() {
    expect_files();
    hand_on();
    out_.helper->drop_later();
    out_.helper->finish();
    study_->count_no_longer();
    out_.in_memory = false;
    out_.facets.reset();
  }

  // Surfaces that are spilled are read again, so none of them may be a pipe.
  void expect_files() const {
    for (const size_t b : once_)
      if (std::filesystem::is_other(scene_.bodies[b].mesh))
        throw InputError(
            fmt::format("{}: expected a file, as the surfaces don't fit into the memory given and must be read twice; found a pipe or a device",
                        scene_.bodies[b].mesh.string()),
            Remedy::kMoreMemory);
  }

  void hand_on() {
    const auto batch = std::make_shared<const Batch>(std::exchange(batch_, {}));
    if (batch->pieces.empty()) return;
    out_.helper->run([&scene = scene_, study = study_, batch] {
      std::span<const Facet> copies;
      if (batch->copies) copies = *batch->copies;
      for (const Piece& p : batch->pieces) {
        const SceneBody& body = scene.bodies[p.body];
        study->take(p.stored, body, p.patch);
        study->take(copies.first(p.copied), body, p.patch);
        copies = copies.subspan(p.copied);
        if (p.ends) study->end_body();
      }
    });
    if (!out_.in_memory || !count_) return;
    out_.helper->run_later([counter = counter_, shells = shells_, batch] {
      const std::array<uint32_t, 3>* numbers = batch->numbers.data();
      for (const Piece& p : batch->pieces) {
        for (const SceneFacet& f : p.stored) {
          __builtin_prefetch(&f + std::min<ptrdiff_t>(kFacetsAhead, &p.stored.back() - &f));
          p.numbered ? counter->add(f.facet, *numbers++) : counter->add(vertex_hashes(f.facet));
        }
        if (!p.ends) continue;
        shells->push_back(counter->shells());
        *counter = {};
      }
    });
  }

  const Scene& scene_;
  const ExactSurfaces& exact_;
  const Budget& budget_;
  const bool together_;
  const uint64_t most_;
  const bool count_;
  uint32_t patch_ = 0;  // of the facets that are being read
  std::vector<size_t> once_;  // bodies whose mesh was no regular file
  Bodies& out_;
  // Shared, because jobs may outlive the reading when it throws.
  const std::shared_ptr<Study> study_ = std::make_shared<Study>(known_flat_slack(scene_), count_);
  const std::shared_ptr<ShellCounter> counter_ = std::make_shared<ShellCounter>();
  const std::shared_ptr<std::vector<uint64_t>> shells_;
  std::vector<std::array<uint32_t, 3>> numbers_;  // of the vertices of the facets that are being read
  JobLists<std::vector<Facet>> copies_;
  Batch batch_;
  std::vector<Topology> of_threads_;  // while they take blocks
  bool has_blocks_ = false;
};

}  // namespace

uint64_t Bodies::facet_count() const {
  uint64_t count = 0;
  for (const BodyFacets& b : bodies) count += b.file.facets;
  return count;
}

bool Bodies::float32() const {
  return std::ranges::all_of(bodies, [](const BodyFacets& b) { return b.file.float32; });
}

std::vector<SurfaceCounts> Bodies::wait_for_counts() {
  helper->finish_all();
  std::vector<SurfaceCounts> out;
  for (size_t b = 0; b < shells->size(); ++b) {
    out.push_back(bodies[b].facet_counts);
    out.back().shells = (*shells)[b];
  }
  return out;
}

Bodies read_bodies(const Scene& scene, const ExactSurfaces& exact, int threads, const Budget& budget, bool count,
                   const std::function<void(double)>& progress) {
  Bodies out;
  out.helper = std::make_unique<Background>(threads > 1);
  BodyReader(scene, exact, threads, budget, count, out).read(progress);
  return out;
}

void complete_flat_faces(const Scene& scene, const Budget& budget, Bodies& bodies) {
  Vec3 slack = known_flat_slack(scene);
  for (int d = 0; d < 3; ++d)
    if (slack[d] >= 0) slack[d] = face_slack(domain_of(*scene.axis[d].made, scene.axis[d], bodies.lo[d], bodies.hi[d]));
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    BodyFacets& found = bodies.bodies[b];
    bool complete = true;
    for (int d = 0; d < 3; ++d) complete &= slack[d] < 0 || found.flat.least_missed[d] > slack[d];
    if (complete) continue;
    FlatFaceSearch search(slack);
    for_each_facet(scene.bodies[b], found, bodies, budget, [&](const Facet& facet) {
      const Facet placed = moved(facet, scene.bodies[b]);
      search.take(placed.vertex, area(placed));
    });
    found.flat = std::move(search).found();
  }
}

void close_bodies(const Scene& scene, const Grid& grid, const Budget& budget, Bodies& bodies, const std::function<void(double)>& progress) {
  ClosingGrid closing_grid{HUGE_VAL, {}};
  for (const Axis& axis : grid.axis) closing_grid.shortest_edge = std::min(closing_grid.shortest_edge, axis.shortest_cell());
  constexpr size_t kMostLooks = 64;  // each reads a whole file; the first open parts are enough to say what is wrong with such a file
  size_t open_parts = 0;
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    BodyFacets& found = bodies.bodies[b];
    if (body.kind == Kind::kSheet) continue;
    progress(static_cast<double>(b) / static_cast<double>(scene.bodies.size()));
    if (body.closing.way == Closing::Way::kExtrude) closing_grid.beyond = beyond(body.closing.axis, grid, bodies.lo, bodies.hi);
    open_parts += !body.part.empty() && !found.boundary.directed_boundary_is_empty();
    const Surface surface = {[&](const auto& f) { for_each_facet(body, found, bodies, budget, f); },
                             found.file.facets,
                             found.file.float32,
                             found.file.units,
                             bodies.in_memory,
                             found.boundary,
                             found.opposites,
                             open_parts <= kMostLooks,
                             bodies.kept.get(),
                             cad_or_usual(found.cad)};
    found.closed = close_body(body, surface, closing_grid, budget);
    if (!bodies.in_memory) continue;
    const ClosedBody& closed = found.closed;
    const uint64_t last = found.first + found.file.facets;
    if (uint64_t i = 0; closed.rules) bodies.facets->for_each(found.first, last, [&](SceneFacet& f) { f.layer = closed.rules->layer(b, i++); });
    else if (closed.layer(b) != layer_of(b, body.fill == Fill::kEvenodd))
      bodies.facets->for_each(found.first, last, [&](SceneFacet& f) { f.layer = closed.layer(b); });
    for (const bool parity : {false, true}) bodies.facets->append_all(closed.added[parity], layer_of(b, parity), kCapPatch);
  }
}

void for_each_facet(const SceneBody& body, const BodyFacets& found, const Bodies& bodies, const Budget& budget,
                    const std::function<void(const Facet&)>& f) {
  if (bodies.in_memory && !bodies.facets) throw std::logic_error("for_each_facet: the facets were handed on");
  if (bodies.in_memory) return bodies.facets->for_each(found.first, found.first + found.file.facets, [&](const SceneFacet& s) { f(s.facet); });
  const auto each = [&](std::span<const Facet> facets) {
    for (const Facet& facet : facets) f(facet);
  };
  read_again(body, found, each, {.budget = budget, .kept = bodies.kept.get()});
}

void for_each_placed(const Scene& scene, const Bodies& bodies, const Budget& budget, const std::function<void(const Facet&, uint32_t layer)>& f) {
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    const ClosedBody& closed = bodies.bodies[b].closed;
    const bool moves = body.matrix != kIdentity;
    uint64_t number = 0;
    for_each_facet(body, bodies.bodies[b], bodies, budget, [&](const Facet& facet) {
      f(moves ? moved(facet, body) : facet, closed.rules ? closed.rules->layer(b, number++) : closed.layer(b));
    });
    for (const bool parity : {false, true}) {
      for (const Facet& facet : closed.added[parity]) f(moved(facet, body), layer_of(b, parity));
      for (const Facet& facet : closed.walls[parity]) f(facet, layer_of(b, parity));
    }
  }
}

void read_again(const SceneBody& body, const BodyFacets& found, const FacetSink& sink, ReadOptions options) {
  options.units = found.file.units;
  options.cad = cad_or_usual(found.cad);
  options.face_patches = body.face_patches;
  const SurfaceFile file = read_facets(body.mesh, body.part, sink, options);
  if (file.cad && file.cad->hash != found.file.cad->hash)
    throw InputError(fmt::format("{}: the CAD kernel made other facets while it was meshed: their hash was {} and is {} now", body.mesh.string(),
                                 found.file.cad->hash, file.cad->hash));
  if (file.hash != found.file.hash)
    throw InputError(
        fmt::format("{}: the file changed while it was meshed: its hash was {} and is {} now", body.mesh.string(), found.file.hash, file.hash));
}

}  // namespace teracell::mesher
