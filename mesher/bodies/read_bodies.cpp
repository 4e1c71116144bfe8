// Reading the bodies of a scene.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "mesher/bodies/part_counts.hpp"
#include "mesher/bodies/study.hpp"
#include "mesher/closing/lengths.hpp"
#include "mesher/closing/surface_counts.hpp"
#include "mesher/planes/make_planes.hpp"
#include "store/base/error.hpp"

namespace teracell::mesher {
namespace {

// What a facet in memory takes: the facet, its place among the rays, its numbers in the lists of the tiling, and its part of the
// tables that count what its surface is made of.
constexpr uint64_t kBytesPerFacet = 160;
// More facets than these are put into bins in any case, even if the bins stay in memory: a bin is read from end to end, and has a tenth
// of the bytes. With 6.4 million facets and 8 GB, bins took 0.66 of the time and 196 in place of 801 MB for a binary STL file and 0.74 of the time
// for a compressed one, when both were still parsed twice then, and 0.95 for an OBJ file, which still is. With 1.6 million facets bins took 1.6 times
// as long.
constexpr uint64_t kMostTogether = uint64_t{4} << 20;

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
  BodyReader(const Scene& scene, const ExactSurfaces& exact, int threads, const Budget& budget, bool count, bool again, Bodies& out)
      : scene_(scene),
        exact_(exact),
        budget_(budget),
        together_(together(scene, budget)),
        most_(std::min(budget.bytes / 8 * 5 / kBytesPerFacet, together_ ? ~uint64_t{0} : kMostTogether)),
        count_(count),
        again_(again),
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
                               .ahead = std::clamp<uint64_t>(budget_.bytes >> 25, 1, 8),  // of a third of a megabyte at most
                               .wanted = [&](bool float32) { return begin_blocks(float32); },
                               .take = [&](const std::function<std::span<const Facet>()>& next, int worker) -> std::function<void()> {
                                 const auto logged = logs_ ? std::make_shared<UnfilledVector<uint8_t>>() : nullptr;
                                 if (logged) logged->reserve(FacetBlocks::kFacets * (float32_ ? 16 : 24));  // if facets share vertices
                                 const Study::Measures measures =
                                     Study::take_block(next, body, of_threads_[static_cast<size_t>(worker)], [&](const FacetWelder& welded) {
                                       if (logged) welded.append_to(*logged, float32_);
                                     });
                                 return [this, &progress, b, measures, logged] {
                                   study_->add_block(measures, patch_);
                                   if (logged) out_.bodies[b].logged.push_back({out_.log->add(*logged), patch_});
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
                                .expect =
                                    [&](uint64_t facets) {
                                      expected_ = facets;
                                      make_room(facets);
                                    },
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
    if (out_.log) out_.log->finish();
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
  bool begin_blocks(bool float32) {
    if (out_.in_memory || !study_->takes_blocks()) return false;
    hand_on();
    out_.helper->finish();
    for (BlockTaker& of_thread : of_threads_) of_thread.topology.keep_sample();
    float32_ = float32;
    logs_ = again_ && has_log(expected_ * (9 * (float32 ? sizeof(float) : sizeof(double)) + sizeof(uint32_t)));
    return has_blocks_ = true;
  }
  void end_blocks() {
    if (!std::exchange(has_blocks_, false)) return;
    for (BlockTaker& of_thread : of_threads_) study_->add_topology(of_thread.topology);
  }
  // Whether facets that take so many bytes at most can be logged: in a quarter of the memory, or on a disk that leaves room for bins of all facets so
  // far, too.
  bool has_log(uint64_t bytes) {
    const bool in_memory = out_.log ? out_.log->in_memory() : bytes <= budget_.bytes / 4;
    if (in_memory && (out_.log ? out_.log->bytes() : 0) + bytes > budget_.bytes / 4) return false;
    uint64_t facets = expected_;
    for (const BodyFacets& body : out_.bodies) facets += body.file.facets;
    constexpr uint64_t kInBins = 9 * sizeof(double) + 2 * sizeof(uint32_t);
    std::error_code error;
    if (!in_memory && (std::filesystem::space(budget_.folder, error).available < bytes + kInBins * facets || error)) return false;
    try {
      if (!out_.log) out_.log = std::make_unique<PieceLog>(budget_, 0, in_memory, false);
      return true;
    } catch (const IoError&) {  // perhaps nothing else needs a disk
      return false;
    }
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
  const bool count_, again_;
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
  std::vector<BlockTaker> of_threads_;  // while they take blocks
  uint64_t expected_ = 0;  // facets of the file that is being read
  bool has_blocks_ = false, logs_ = false, float32_ = false;  // the facets that come as blocks
};

}  // namespace

Bodies read_bodies(const Scene& scene, const ExactSurfaces& exact, int threads, const Budget& budget, bool count, bool again,
                   const std::function<void(double)>& progress) {
  Bodies out;
  out.helper = std::make_unique<Background>(threads > 1);
  BodyReader(scene, exact, threads, budget, count, again, out).read(progress);
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

}  // namespace teracell::mesher
