#include "mesher/boundary/links.hpp"

#include <algorithm>
#include <tuple>
#include <unordered_map>

namespace teracell::mesher {
namespace {

// The lines of a block across the rays: so few that what is counted for them stays in a core's cache.
constexpr int64_t kBlockLines = int64_t{1} << 15;
// Crossings of rays that are gone through at once.
constexpr uint64_t kMostCrossings = uint64_t{1} << 21;

uint32_t number_of_patch(const SceneFacet& facet) {
  const uint32_t number = facet.patch & ~kAddedFacet;
  return number == (kNoPatch & ~kAddedFacet) ? kNoPatch : number;
}

}  // namespace

LinkFinder::LinkFinder(const Scene& scene, const std::vector<Layer>& layers, const Labels& labels, const Metadata& meta)
    : scene_(scene),
      labels_(labels),
      grid_(meta.grid),
      rays_(meta.frame()),
      has_marks_(mesher::has_marks(scene)),
      only_patch_(scene.bodies.size(), kNoPatch),
      lines_{FacetLines{meta.grid, 0, meta.grid.axis[0]}, FacetLines{meta.grid, 1, meta.grid.axis[1]}, FacetLines{meta.grid, 2, meta.grid.axis[2]}},
      marker_(scene, meta, labels, false),
      composer_(layers, labels.rank, labels.of_body, labels.of_overlap, meta.ray_axis) {
  std::unordered_map<std::string_view, std::pair<uint32_t, int>> of_body;  // a patch, and how many there are
  for (uint32_t i = 0; i < meta.patches.size(); ++i) {
    auto& [patch, number] = of_body[meta.patches[i].body];
    patch = i, ++number;
  }
  for (size_t b = 0; b < scene.bodies.size(); ++b)
    if (const auto found = of_body.find(scene.bodies[b].name); found != of_body.end() && found->second.second == 1)
      only_patch_[b] = found->second.first;
}

void LinkFinder::find(const Cells& tile, std::span<const SceneFacet* const> facets, Engine& engine, uint32_t segment_cells, const PutLinks& put) {
  tile_ = &tile;
  if (has_marks_) cast_strip(0, facets, engine), cast_strip(1, facets, engine);
  for (std::vector<Walk>& walks : walks_) {
    walks.resize(tile.runs->rays() + (has_marks_ ? tile.runs->nu + tile.runs->nv : 0));
    for (Walk& walk : walks) walk.next = 0, walk.solids.clear(), walk.marks.clear();
  }
  const auto any = [](const SceneFacet&) { return true; };
  // A facet behind the last sample point of a segment lies in the links of its last cells.
  segments_.for_each(grid_, tile.box, rays_.w, facets, segment_cells, true, any, [&](const Box& segment, std::span<const SceneFacet* const> near) {
    links_.nu = tile.runs->nu, links_.nv = tile.runs->nv;
    links_.length = static_cast<uint32_t>(segment.hi[rays_.w] - segment.lo[rays_.w]);
    for (std::vector<Link>& links : links_.along) links.clear();
    find_along_rays(segment, near);
    const int64_t length = std::max<int64_t>(kBlockLines / std::max(links_.nu, links_.nv), 1);
    blocks_.for_each(grid_, segment, rays_.w, near, length, has_marks_, any, [&](const Box& block, std::span<const SceneFacet* const> active) {
      find_across(rays_.u, segment, block, active);
      find_across(rays_.v, segment, block, active);
    });
    put(static_cast<uint32_t>(segment.lo[rays_.w] / segment_cells), links_);
  });
}

void LinkFinder::find_along_rays(const Box& segment, std::span<const SceneFacet* const> facets) {
  stride_ = {};
  stride_[rays_.u] = 1, stride_[rays_.v] = links_.nu;
  // All rows at once, or where many surfaces lie above each other so many as fit into memory.
  const auto rows = static_cast<int64_t>(std::clamp<uint64_t>(kMostCrossings * links_.nv / (tile_->crossings->all.size() + 1), 1, links_.nv));
  for (Box part = segment; part.lo[rays_.v] < segment.hi[rays_.v]; part.lo[rays_.v] = part.hi[rays_.v]) {
    part.hi[rays_.v] = std::min(part.lo[rays_.v] + rows, segment.hi[rays_.v]);
    collect(rays_.w, part, facets);
    sort_by_line(static_cast<size_t>((part.hi[rays_.v] - part.lo[rays_.v]) * links_.nu));
    link_up(rays_.w, part, static_cast<uint64_t>((part.lo[rays_.v] - segment.lo[rays_.v]) * links_.nu), links_.along[2]);
  }
}

void LinkFinder::find_across(int axis, const Box& segment, const Box& block, std::span<const SceneFacet* const> facets) {
  const int other = axis == rays_.u ? rays_.v : rays_.u;
  stride_ = {};
  stride_[other] = 1, stride_[rays_.w] = block.hi[other] - block.lo[other];
  collect(axis, block, facets);
  sort_by_line(static_cast<size_t>(stride_[rays_.w] * (block.hi[rays_.w] - block.lo[rays_.w])));
  const auto first_line = static_cast<uint64_t>((block.lo[rays_.w] - segment.lo[rays_.w]) * stride_[rays_.w]);
  link_up(axis, block, first_line, links_.along[axis == rays_.u ? 0 : 1]);
}

void LinkFinder::collect(int axis, const Box& block, std::span<const SceneFacet* const> facets) {
  found_.clear();
  active_ = facets;
  const auto first = static_cast<uint32_t>(block.lo[axis]) + 1, end = static_cast<uint32_t>(block.hi[axis]) + 1;  // of upper cells
  const auto next_line = static_cast<uint32_t>(stride_[lines_[axis].frame().u]);
  for (uint32_t f = 0; f < facets.size(); ++f)
    lines_[axis].cross_exactly(facets[f]->facet, block, exact_decisions_,
                               [&](const Index3& cell, std::span<const uint32_t> above, std::span<const uint32_t> subs, bool up) {
                                 uint32_t line = 0;
                                 for (int d = 0; d < 3; ++d)
                                   if (d != axis) line += static_cast<uint32_t>((cell[d] - block.lo[d]) * stride_[d]);
                                 for (size_t i = 0; i < above.size(); ++i, line += next_line)
                                   if (subs[i] > 0 && above[i] >= first && above[i] < end) found_.push_back({line, above[i], subs[i], f, up});
                               });
  if (has_marks_) collect_differences(axis, block);
}

// The neighbours in a block that have different labels.
void LinkFinder::collect_differences(int axis, const Box& block) {
  const auto [u, v, w] = rays_;
  Index3 lower;
  for (lower[v] = block.lo[v]; lower[v] < block.hi[v]; ++lower[v])
    for (lower[u] = block.lo[u]; lower[u] < block.hi[u]; ++lower[u]) {
      Index3 upper = lower;
      upper[axis] += axis != w;
      lower[w] = upper[w] = block.lo[w];
      if (upper[axis] >= grid_.axis[axis].cells()) continue;
      const Place a = place_of(lower), b = place_of(upper);
      const auto add = [&](int64_t at, int64_t of_upper) {
        const int64_t line = (lower[u] - block.lo[u]) * stride_[u] + (lower[v] - block.lo[v]) * stride_[v] + (at - block.lo[w]) * stride_[w];
        found_.push_back({static_cast<uint32_t>(line), static_cast<uint32_t>(of_upper), 0, kNoFacet, 0});
      };
      const auto lo = static_cast<uint32_t>(block.lo[w]), hi = static_cast<uint32_t>(block.hi[w]);
      if (axis == w) {
        for (const uint32_t change : a.cells->runs->changes(a.ray))
          if (change > lo && change <= hi) add(0, change);
        continue;
      }
      a.cells->runs->for_each_run(a.ray, lo, hi, [&](uint32_t from, uint32_t to, SetId label) {
        b.cells->runs->for_each_run(b.ray, from, to, [&](uint32_t begin, uint32_t end, SetId other) {
          if (label != other)
            for (uint32_t at = begin; at < end; ++at) add(at, upper[axis]);
        });
      });
    }
}

// Sorts what was found by line, cell and sub-position.
void LinkFinder::sort_by_line(size_t lines) {
  begin_.assign(lines + 1, 0);
  for (const Crosser& c : found_) ++begin_[c.line + 1];
  for (size_t i = 0; i < lines; ++i) begin_[i + 1] += begin_[i];
  crossers_.resize(found_.size());
  for (const Crosser& c : found_) crossers_[begin_[c.line]++] = c;  // now begin_[i] is where line i ends
  const auto key = [](const Crosser& c) { return uint64_t{c.upper} << 32 | c.k; };
  for (size_t i = 0, from = 0; i < crossers_.size(); from = i) {
    const uint32_t line = crossers_[from].line;
    bool sorted = true;
    for (++i; i < crossers_.size() && crossers_[i].line == line; ++i) sorted &= key(crossers_[i - 1]) <= key(crossers_[i]);
    if (!sorted) std::ranges::stable_sort(std::span(crossers_).subspan(from, i - from), {}, key);
  }
}

// `first_line`: the number in the segment of the block's first line.
void LinkFinder::link_up(int axis, const Box& block, uint64_t first_line, std::vector<Link>& out) {
  for (size_t i = 0; i < crossers_.size();) {
    const size_t from = i;
    const Crosser& first = crossers_[from];
    for (++i; i < crossers_.size() && crossers_[i].line == first.line && crossers_[i].upper == first.upper;) ++i;
    Link link{first_line + first.line, first.upper - 1 - static_cast<uint32_t>(block.lo[axis]), 0, 0, kNoPatch};
    const bool linked = has_marks_ || i - from > 1 || first.upper >= tile_->box.hi[axis] ? look_closely(axis, block, {&first, i - from}, link)
                                                                                         : look_at(axis, block, first, link);
    if (linked) out.push_back(link);
  }
}

// Whether the cell and its upper neighbour have different labels; if they do, fills in the link. One facet lies between two cells of the tile,
// as nearly always.
bool LinkFinder::look_at(int axis, const Box& block, const Crosser& crosser, Link& link) const {
  const RayBlock& runs = *tile_->runs;
  if (axis == rays_.w) {
    if (!std::ranges::binary_search(runs.changes(static_cast<uint32_t>(link.line)), crosser.upper)) return false;
  } else {
    const uint32_t row = axis == rays_.u ? runs.nv : runs.nu, other = crosser.line % row;
    const uint32_t w = static_cast<uint32_t>(block.lo[rays_.w]) + crosser.line / row;
    const uint32_t ray = axis == rays_.u ? other * runs.nu + link.cell : link.cell * runs.nu + other;
    if (runs.set_at(ray, w) == runs.set_at(ray + (axis == rays_.u ? 1 : runs.nu), w)) return false;
  }
  link.end = link.begin = crosser.k;
  link.patch = number_of_patch(*active_[crosser.facet]);
  return true;
}

bool LinkFinder::look_closely(int axis, const Box& block, std::span<const Crosser> crossers, Link& link) {
  const int inner = axis == rays_.u ? rays_.v : rays_.u, outer = axis == rays_.w ? rays_.v : rays_.w;  // how lines are numbered
  Index3 lower = block.lo;
  lower[inner] += crossers[0].line % stride_[outer], lower[outer] += crossers[0].line / stride_[outer], lower[axis] += link.cell;
  Index3 upper = lower;
  ++upper[axis];
  const Place at = place_of(lower);
  point_ = walk_to(axis, at).solids;
  LayerSums behind = point_;
  for (const Crosser& c : crossers)
    if (c.facet != kNoFacet && !is_sheet(body_of_layer(active_[c.facet]->layer))) behind.add(active_[c.facet]->layer, step_of(axis, c));
  const Label from = label_of(point_.owner(labels_.rank)), to = label_of(behind.owner(labels_.rank));
  if (has_marks_) {
    const Place beyond = place_of(upper);
    const Label of_lower = at.cells->runs->set_at(at.ray, at.w), of_upper = beyond.cells->runs->set_at(beyond.ray, beyond.w);
    if (of_lower == of_upper) return false;
    const uint32_t lower_owner = owner_at(axis, at), upper_owner = owner_at(axis, beyond);
    const auto sheet_of = [&](uint32_t owner) { return owner != kNoBody && is_sheet(owner) ? owner : kNoBody; };
    const uint32_t below = sheet_of(lower_owner), above = sheet_of(upper_owner);
    if (below != kNoBody || above != kNoBody) {
      const uint32_t stronger = is_stronger(above, below) ? above : below;
      link.patch = only_patch_[stronger];
      for (const uint32_t sheet : {stronger, stronger == above ? below : above}) {  // of two sheets the one that is crossed
        const auto first =
            std::ranges::find_if(crossers, [&](const Crosser& c) { return c.facet != kNoFacet && body_of_layer(active_[c.facet]->layer) == sheet; });
        if (first == crossers.end()) continue;
        link.end = link.begin = first->k;
        link.patch = patch_of(crossers, first->k, sheet);
        break;
      }
      return true;
    }
    if (from != of_lower || to != of_upper) {  // a kept cell
      link.patch = only_patch_[is_stronger(upper_owner, lower_owner) ? upper_owner : lower_owner];
      return true;
    }
  }
  if (from == to) return false;
  change_labels(axis, from, to, crossers, link);
  return true;
}

// Walks from the lower sample point, which point_ is about, to the upper one.
void LinkFinder::change_labels(int axis, Label from, Label to, std::span<const Crosser> crossers, Link& link) {
  const uint32_t first_owner = point_.owner(labels_.rank);
  uint32_t owner_at_begin = kNoBody;
  Label label = from;
  for (size_t i = 0; i < crossers.size();) {
    const uint32_t k = crossers[i].k;
    for (; i < crossers.size() && crossers[i].k == k; ++i)
      if (const Crosser& c = crossers[i]; c.facet != kNoFacet && !is_sheet(body_of_layer(active_[c.facet]->layer)))
        point_.add(active_[c.facet]->layer, step_of(axis, c));
    const uint32_t owner = point_.owner(labels_.rank);
    const Label next = label_of(owner);
    if (next == label) continue;
    if (link.end == 0) link.end = k;
    if (next == to) link.begin = k, owner_at_begin = owner;
    label = next;
  }
  const bool enters = is_stronger(owner_at_begin, first_owner);
  link.patch = patch_of(crossers, enters ? link.begin : link.end, enters ? owner_at_begin : first_owner);
}

// The first patch of the facets that are crossed between sub-positions k - 1 and k: one of the owner, if there is any; one of a body's file
// before those that close holes; then in the order of bodies and patches, since facets come in no certain order from bins. Solids tell, or the sheet
// that is the owner.
uint32_t LinkFinder::patch_of(std::span<const Crosser> crossers, uint32_t k, uint32_t owner) const {
  const SceneFacet* best = nullptr;
  const auto rank = [&](const SceneFacet& f) {
    const uint32_t body = body_of_layer(f.layer);
    return std::tuple(body != owner, (f.patch & kAddedFacet) != 0, body, number_of_patch(f));
  };
  for (const Crosser& c : crossers) {
    if (c.k != k || c.facet == kNoFacet) continue;
    const SceneFacet& facet = *active_[c.facet];
    if (const uint32_t body = body_of_layer(facet.layer); is_sheet(body) && body != owner) continue;
    if (!best || rank(facet) < rank(*best)) best = &facet;
  }
  return best ? number_of_patch(*best) : kNoPatch;
}

int LinkFinder::step_of(int axis, const Crosser& c) const { return step_along(axis, c.up, rays_.w); }

// The rays that follow the tile along u (0) or v (1), with their marks.
void LinkFinder::cast_strip(int d, std::span<const SceneFacet* const> facets, Engine& engine) {
  const auto [u, v, w] = rays_;
  const int axis = d == 0 ? u : v;
  Strip& strip = strips_[d];
  strip.cells = {tile_->box, &strip.crossings, &strip.runs};
  Box& box = strip.cells.box;
  box.lo[axis] = tile_->box.hi[axis], box.hi[axis] = std::min(box.lo[axis] + 1, grid_.axis[axis].cells());
  if (box.empty()) return;
  Tile tile{rays_, {}, {}, &grid_.axis[w]};
  for (int64_t i = box.lo[u]; i < box.hi[u]; ++i) tile.u.push_back(grid_.axis[u].centre(i));
  for (int64_t i = box.lo[v]; i < box.hi[v]; ++i) tile.v.push_back(grid_.axis[v].centre(i));
  engine.cast(tile, marker_.solids(facets), strip.crossings);
  marker_.mark(tile, box, strip.crossings);
  composer_.compose(strip.crossings, static_cast<uint32_t>(tile.u.size()), static_cast<uint32_t>(tile.v.size()), tile_->runs->length, strip.runs);
  // What is counted of these rays is their own tile's to count.
  marker_.take_tallies();
  composer_.take_overlaps(box);
  composer_.take_cells();
}

LinkFinder::Place LinkFinder::place_of(const Index3& cell) const {
  const auto [u, v, w] = rays_;
  const Cells* cells = cell[u] >= tile_->box.hi[u] ? &strips_[0].cells : cell[v] >= tile_->box.hi[v] ? &strips_[1].cells : tile_;
  const Box& box = cells->box;
  return {cells, static_cast<uint32_t>((cell[v] - box.lo[v]) * (box.hi[u] - box.lo[u]) + cell[u] - box.lo[u]), static_cast<uint32_t>(cell[w])};
}

// REQUIRES: along an axis the places of a ray never go down again. (Adding up a ray's crossings anew for each link took 50 times as long where
// thousands of surfaces lie above each other.)
const LinkFinder::Walk& LinkFinder::walk_to(int axis, const Place& place) {
  const size_t before = place.cells == tile_ ? 0 : tile_->runs->rays() + (place.cells == &strips_[1].cells ? tile_->runs->nv : 0);
  Walk& walk = walks_[static_cast<size_t>(axis)][before + place.ray];
  const auto crossings = place.cells->crossings->of_ray(place.ray);
  for (; walk.next < crossings.size() && Crossing::cell(crossings[walk.next]) <= place.w; ++walk.next) {
    const uint64_t c = crossings[walk.next];
    if (!Crossing::is_mark(c)) {
      walk.solids.add(Crossing::layer(c), Crossing::step(c));
      continue;
    }
    const uint32_t body = body_of_layer(Crossing::layer(c));
    auto known = std::ranges::find(walk.marks, body, &std::pair<uint32_t, int>::first);
    if (known == walk.marks.end()) known = walk.marks.insert(known, {body, 0});
    known->second += Crossing::step(c);
    if (known->second == 0) *known = walk.marks.back(), walk.marks.pop_back();
  }
  return walk;
}

// The body that owns a cell, or kNoBody.
uint32_t LinkFinder::owner_at(int axis, const Place& place) {
  const Walk& walk = walk_to(axis, place);
  uint32_t owner = walk.solids.owner(labels_.rank);
  for (const auto& [body, sum] : walk.marks)
    if (sum > 0 && is_stronger(body, owner)) owner = body;
  return owner;
}

}  // namespace teracell::mesher
