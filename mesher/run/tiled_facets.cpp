#include "mesher/run/tiled_facets.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

#include "mesher/closing/lengths.hpp"
#include "mesher/scene/placement.hpp"
#include "store/base/in_order.hpp"

namespace teracell::mesher {
namespace {

// Bins that are loaded ahead: each takes a sixteenth of the memory.
constexpr int kMostAhead = 8;

std::vector<bool> which_move(const Scene& scene) {
  std::vector<bool> out;
  for (const SceneBody& body : scene.bodies) out.push_back(body.matrix != kIdentity);
  return out;
}

std::vector<bool> to_be_counted(const Bodies& bodies) {
  std::vector<bool> out;
  for (const BodyFacets& body : bodies.bodies) out.push_back(!body.counts);
  return out;
}

// Trees whose parts stand in bins for their facets, as long as all of them take no more than some memory.
class SharedTrees {
 public:
  explicit SharedTrees(uint64_t bytes) : left_(bytes) {}
  bool holds(const std::shared_ptr<PartTree>& tree) {
    if (std::ranges::count(held_, tree) > 0) return true;
    if (!tree->repeats() || !tree->in_memory() || tree->bytes_in_memory() > left_) return false;
    left_ -= tree->bytes_in_memory();
    held_.push_back(tree);
    return true;
  }

 private:
  uint64_t left_;
  std::vector<std::shared_ptr<PartTree>> held_;
};

// Lists that threads fill and another one empties, used again and again.
class ReadyBlocks {
 public:
  using List = std::shared_ptr<FacetBins::Ready>;
  List take() {
    std::lock_guard lock(mutex_);
    if (spare_.empty()) return std::make_shared<FacetBins::Ready>();
    List out = std::move(spare_.back());
    spare_.pop_back();
    return out;
  }
  void give_back(const List& list) {
    list->clear();
    std::lock_guard lock(mutex_);
    spare_.push_back(list);
  }

 private:
  std::mutex mutex_;
  std::vector<List> spare_;
};

// REQUIRES: `part` is one of the tree's.
BinnedPart binned_part(const std::shared_ptr<PartTree>& tree, const Part& part, const SceneBody& body, uint32_t layer, uint32_t patch) {
  const auto read = [&part, shared = std::shared_ptr<const PartTree>(tree)](const auto& f) { shared->read(part, f); };
  BinnedPart out{tree->facets(part), {}, {}, layer, patch, read};
  out.lo.fill(HUGE_VAL), out.hi.fill(-HUGE_VAL);
  const bool moves = body.matrix != kIdentity;
  tree->for_each_vertex(part, [&](const Vec3& v) { extend(out.lo, out.hi, moves ? moved(v, body) : v); });
  return out;
}

}  // namespace

TiledFacets::TiledFacets(const Scene& scene, Bodies& bodies, const Metadata& meta, const std::vector<uint8_t>& widened, const Budget& budget,
                         int threads, const Patches* patches, std::function<void(double)> progress)
    : scene_(scene),
      bodies_(bodies),
      meta_(meta),
      widened_(widened),
      budget_(budget),
      threads_(threads),
      patches_(patches),
      progress_(std::move(progress)),
      spilled_(bodies.log && !bodies.log->in_memory() ? bodies.log->bytes() : 0),
      binned_(to_be_counted(bodies)) {}

// When a run ends early, jobs may still count facets that are freed here.
TiledFacets::~TiledFacets() {
  if (facets_ && bodies_.helper) bodies_.helper->drop_later();
}

Tiling& TiledFacets::tile(const TreeRange& range, bool count, bool again) {
  tiling_.reset();
  if (bodies_.in_memory) {
    if (!facets_) take_from_memory(count);
    return tiling_.emplace(facets_, meta_, widened_, range);
  }
  // What counts facets needs all of them.
  const uint64_t held_by_log = bodies_.log && bodies_.log->in_memory() ? bodies_.log->bytes() : 0;
  auto bins = fill_bins(count ? TreeRange() : range, again);
  if (!bins->in_memory()) spilled_ += bins->bytes();
  held_ = std::max(held_, held_by_log + (bins->in_memory() ? bins->bytes() : 0));
  return tiling_.emplace(std::move(bins), count ? &binned_ : nullptr, threads_ > 1 ? std::min(threads_, kMostAhead) : 0, meta_, range);
}

void TiledFacets::take_from_memory(bool count) {
  const std::vector<bool> moves = which_move(scene_);
  const bool any_moves = std::ranges::count(moves, true) > 0;
  if (any_moves && count) bodies_.helper->finish_all();  // what counts facets takes the files' coordinates
  const std::unique_ptr<FileFacets> facets = std::move(bodies_.facets);
  const auto move = [&](SceneFacet& f) {
    const uint32_t b = body_of_layer(f.layer);
    if (moves[b]) f.facet = moved(f.facet, scene_.bodies[b]);
    f.patch = patch_of(b, f.patch);
  };
  facets_ = any_moves || patches_ ? std::make_shared<GridFacets>(std::move(*facets), move) : std::make_shared<GridFacets>(std::move(*facets));
  for (size_t b = 0; b < scene_.bodies.size(); ++b)
    for (const bool parity : {false, true}) facets_->append_all(bodies_.bodies[b].closed.walls[parity], layer_of(b, parity), patch_of(b, kSidePatch));
  for (BodyFacets& body : bodies_.bodies) body.closed.drop_facets();
}

std::vector<SurfaceCounts> TiledFacets::counts() {
  std::vector<SurfaceCounts> out = bodies_.in_memory ? bodies_.wait_for_counts() : binned_.totals();
  for (size_t b = 0; b < out.size(); ++b) out[b] = bodies_.bodies[b].counts.value_or(out[b]);
  return out;
}

// Whoever reads a piece of the log also makes its facets ready; here they are added in their order.
void TiledFacets::add_logged(size_t b, FacetBins& bins, Background& idle, const std::function<void(double)>& went_on) {
  const BodyFacets& found = bodies_.bodies[b];
  ReadyBlocks lists;
  auto next = found.logged.begin();
  size_t added = 0;
  in_order(
      FacetBlocks::readers(budget_, threads_), [&] { return next == found.logged.end() ? std::nullopt : std::optional(&*next++); },
      [&](const LoggedFacets* logged, int) {
        std::vector<uint8_t> room;
        ReadyBlocks::List ready = lists.take();
        bins.make_ready(bodies_.log->read(logged->piece, room), found.file.float32, found.closed.layer(b), patch_of(b, logged->patch), *ready);
        return ready;
      },
      [&](const ReadyBlocks::List& ready) {
        bins.add(*ready);
        lists.give_back(ready);
        went_on(static_cast<double>(++added) / static_cast<double>(found.logged.size()));
      },
      std::clamp<uint64_t>(budget_.bytes >> 25, 1, 8), &idle);  // of some hundred kilobytes
}

// They are read once more: from the log, or from their files.
std::unique_ptr<FacetBins> TiledFacets::fill_bins(const TreeRange& range, bool again) {
  FacetBins::Move move;
  if (const std::vector<bool> moves = which_move(scene_); std::ranges::count(moves, true) > 0)
    move = [&scene = scene_, moves](const Facet& f, uint32_t layer) {
      const uint32_t body = body_of_layer(layer);
      return moves[body] ? moved(f, scene.bodies[body]) : f;
    };
  const bool walls =
      std::ranges::any_of(bodies_.bodies, [](const BodyFacets& b) { return !b.closed.walls[0].empty() || !b.closed.walls[1].empty(); });
  uint64_t repeated = 0;
  for (const BodyFacets& body : bodies_.bodies) repeated += body.repeats ? body.file.facets : 0;
  const uint64_t all = bodies_.facet_count();
  auto bins = std::make_unique<FacetBins>(meta_, all, all - repeated, bodies_.float32() && !walls, budget_, threads_ > 1, move, widened_, range,
                                          patches_ != nullptr);
  constexpr size_t kBatch = size_t{1} << 18;
  JobLists<FacetBins::Ready> lists;
  std::shared_ptr<FacetBins::Ready> batch = lists.next();  // of facets that are ready
  Background background(threads_ > 1);
  const auto hand_on = [&] {
    if (batch->bytes() == 0) return;
    background.run([&bins, batch] { bins->add(*batch); });
    batch = lists.next();
  };
  const auto add = [&](std::span<const Facet> facets, uint32_t layer, FacetBins::Origin origin, uint32_t patch) {
    constexpr size_t kPiece = 1024;
    for (size_t first = 0; first < facets.size(); first += kPiece) {
      bins->make_ready(facets.subspan(first, std::min(kPiece, facets.size() - first)), layer, origin, patch, *batch);
      if (batch->bytes() >= kBatch) hand_on();
    }
  };
  SharedTrees trees(budget_.bytes / 4);
  uint64_t done = 0;
  const auto went_on = [&](uint64_t more) { progress_(static_cast<double>(done += more) / static_cast<double>(all)); };
  for (size_t b = 0; b < scene_.bodies.size(); ++b) {
    const BodyFacets& found = bodies_.bodies[b];
    const ClosedBody& closed = found.closed;
    uint64_t number = 0;
    uint32_t patch = 0;
    const auto take = [&](std::span<const Facet> facets) {
      if (!closed.rules) add(facets, closed.layer(b), FacetBins::kOfFile, patch);
      else
        for (const Facet& f : facets) add({&f, 1}, closed.rules->layer(b, number++), FacetBins::kOfFile, patch);
      went_on(facets.size());
    };
    const auto take_part = [&](const Part& part) {
      const std::shared_ptr<PartTree> tree = bodies_.kept->latest()->tree;
      if (closed.rules || !trees.holds(tree)) return false;
      hand_on();
      background.run(
          [&bins, &part, &body = scene_.bodies[b], tree, layer = closed.layer(b), patch] { bins->add(binned_part(tree, part, body, layer, patch)); });
      went_on(tree->facets(part));
      return true;
    };
    if (found.logged.empty()) {
      read_again(scene_.bodies[b], found, take,
                 {.budget = budget_,
                  .kept = bodies_.kept.get(),
                  .enter_patch = [&](uint32_t of_file) { patch = patch_of(b, of_file); },
                  .take_part = take_part});
    } else if (closed.rules) {
      for (const LoggedFacets& logged : found.logged) patch = patch_of(b, logged.patch), read_logged(bodies_, found, logged, take);
    } else {
      hand_on();
      background.finish();
      add_logged(b, *bins, background, [&, before = done](double share) {
        done = before + static_cast<uint64_t>(share * static_cast<double>(found.file.facets));
        went_on(0);
      });
    }
    for (const bool parity : {false, true}) add(closed.added[parity], layer_of(b, parity), FacetBins::kAdded, patch_of(b, kCapPatch));
    for (const bool parity : {false, true}) add(closed.walls[parity], layer_of(b, parity), FacetBins::kPlaced, patch_of(b, kSidePatch));
  }
  hand_on();
  background.finish();
  if (!again) {
    bodies_.kept->clear();
    if (bodies_.log) bodies_.helper->run_later([log = std::shared_ptr<PieceLog>(std::move(bodies_.log))] {});  // to free it takes a while
    for (BodyFacets& body : bodies_.bodies) body.logged.clear(), body.closed.drop_facets();
  }
  bins->finish();
  return bins;
}

}  // namespace teracell::mesher
