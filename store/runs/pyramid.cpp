#include "store/runs/pyramid.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "store/base/system/vector_units.hpp"

namespace teracell::inline store {
namespace {

constexpr size_t kMostWidth = 4, kMostMerged = kMostWidth * kMostWidth;  // of the rays that become one: 4 x 4, two levels up

// The least and the greatest of the numbers at each place of some rows of `size` numbers.
void extremes(std::span<const uint32_t* const> rows, size_t size, uint32_t* least, uint32_t* most) {
  on_vector_unit([=]() TERACELL_IN_LINE {
    std::copy_n(rows[0], size, least);
    std::copy_n(rows[0], size, most);
    for (const uint32_t* row : rows.subspan(1))
      for (size_t i = 0; i < size; ++i) {
        least[i] = std::min(least[i], row[i]);
        most[i] = std::max(most[i], row[i]);
      }
  });
}

}  // namespace

// Makes one coarse ray at a time. Rays of equal pattern are merged first, run by run: as long as the parts of run i of all
// rays touch, it covers the coarse cells from its least start to its greatest end, and both ascend with i. Most groups of
// rays have a single pattern, and a sweep with two pointers is all that they need. Silhouettes, and walls so steep that the
// parts lie apart, need the general sweep over intervals.
class Coarsener::Ray {
 public:
  // To be called first. Keeps references.
  void begin(const RayBlock& fine, int shift, SetTable& sets) {
    fine_ = &fine, shift_ = shift, last_ = (fine.length - 1) >> shift, sets_ = &sets;
    for (Apart& a : apart_) a.pattern = ~0u, a.sets.clear(), a.kept.clear();
  }

  // Appends the ray that `rays` become. `one_pattern`: all of them have the same pattern.
  void merge(std::span<const uint32_t> rays, bool one_pattern, RayBlock& out) {
    labels_.clear();
    changes_.clear();
    const uint32_t pattern = fine_->pattern[rays[0]];
    if (one_pattern) {
      if (fine_->patterns.changes(pattern) == 0) {
        out.append(fine_->patterns.sets(pattern), {});
        return;
      }
      if (merge_runs(pattern, rays)) {
        sweep_one_pattern(fine_->patterns.sets(pattern));
        out.append(labels_, changes_);
        return;
      }
    }
    collect_events(rays);
    sweep_events();
    out.append(labels_, changes_);
  }

  // Appends the rays that the fine rays [u, end) of `rows` rows from v on become, all of which have the same pattern. Row by row, and so by
  // vectors, the least and the greatest of each change are found. Where all changes lie apart, in the coarse ray each run is followed by
  // cells with both it and the next one, and nothing is left to be swept.
  void merge_stretch(uint32_t u, uint32_t end, uint32_t v, uint32_t rows, RayBlock& out) {
    const uint32_t pattern = fine_->pattern[v * fine_->nu + u], n = fine_->patterns.changes(pattern), width = 1u << shift_;
    Apart& apart = apart_of(pattern);
    std::array<const uint32_t*, kMostWidth> row;
    for (uint32_t y = 0; y < rows; ++y) row[y] = fine_->at.data() + fine_->begin[(v + y) * fine_->nu + u];
    const size_t size = size_t{n} * (end - u);
    least_.resize(size);
    most_.resize(size);
    places_.resize(size_t{2} * n);
    extremes({row.data(), rows}, size, least_.data(), most_.data());
    for (size_t first = 0; u < end; u += width, first += size_t{n} * width) {
      const size_t last = std::min(first + size_t{n} * width, size);
      uint32_t before = 0;
      bool lie_apart = true;
      for (uint32_t i = 0; i < n; ++i) {
        uint32_t least = least_[first + i], most = most_[first + i];
        for (size_t k = first + n + i; k < last; k += n) {
          least = std::min(least, least_[k]);
          most = std::max(most, most_[k]);
        }
        const uint32_t from = least >> shift_, to = ((most - 1) >> shift_) + 1;  // the cells with both runs
        lie_apart &= before < from && from < to;
        places_[size_t{2} * i] = from, places_[size_t{2} * i + 1] = before = to;
      }
      if (n == 0 || (lie_apart && before <= last_)) {
        if (apart.pattern == ~0u) apart.pattern = out.patterns.intern(apart.sets);
        for (const uint32_t k : apart.kept) out.at.push_back(places_[k]);
        out.pattern.push_back(apart.pattern);
        out.begin.push_back(static_cast<uint32_t>(out.at.size()));
      } else {
        merge_group(u, v, rows, true, out);
      }
    }
  }

  // The same for the one that `rows` x 2^shift rays become.
  void merge_group(uint32_t u, uint32_t v, uint32_t rows, bool one_pattern, RayBlock& out) {
    std::array<uint32_t, kMostMerged> rays;
    uint32_t count = 0;
    for (uint32_t y = v; y < v + rows; ++y)
      for (uint32_t x = u; x < std::min(u + (1u << shift_), fine_->nu); ++x) rays[count++] = y * fine_->nu + x;
    merge({rays.data(), count}, one_pattern, out);
  }

 private:
  // What rays of a pattern become whose changes lie apart.
  struct Apart {
    uint32_t pattern = ~0u;   // ~0: no ray has it yet
    std::vector<SetId> sets;  // of the pattern; empty: not known yet
    std::vector<uint32_t> kept;  // of the ends of the stretches of cells with two runs, those where the set changes
  };
  Apart& apart_of(uint32_t pattern) {
    if (apart_.size() <= pattern) apart_.resize(pattern + 1);
    Apart& a = apart_[pattern];
    if (!a.sets.empty()) return a;
    const auto runs = fine_->patterns.sets(pattern);
    a.sets.assign(1, runs[0]);
    for (uint32_t i = 1; i < runs.size(); ++i)
      for (const uint32_t k : {2 * i - 2, 2 * i - 1}) {
        const SetId set = k % 2 == 0 ? sets_->unite(runs[i - 1], runs[i]) : runs[i];
        if (set != a.sets.back()) a.sets.push_back(set), a.kept.push_back(k);
      }
    return a;
  }

  struct Interval {  // of coarse cells
    uint32_t first, last;
    SetId set;
  };
  struct Event {
    uint32_t at;
    SetId set;
    int delta;
  };
  struct Active {
    SetId set;
    int count;
  };

  // lo_[i], hi_[i]: first and last coarse cell of run i over all `rays` of this pattern; touch_[i]: every coarse cell
  // between them is reached by run i of some ray. Returns whether that holds for all runs.
  bool merge_runs(uint32_t pattern, std::span<const uint32_t> rays) {
    const uint32_t n = fine_->patterns.changes(pattern);
    lo_.resize(n + 1);
    hi_.resize(n + 1);
    std::array<const uint32_t*, kMostMerged> changes;  // of each ray of this pattern
    uint32_t count = 0;
    for (const uint32_t ray : rays)
      if (fine_->pattern[ray] == pattern) changes[count++] = fine_->at.data() + fine_->begin[ray];
    for (uint32_t i = 0; i < n; ++i) {  // change by change, so that both extremes stay in registers
      uint32_t least = ~0u, most = 0;
      for (uint32_t r = 0; r < count; ++r) {
        least = std::min(least, changes[r][i]);
        most = std::max(most, changes[r][i]);
      }
      lo_[i + 1] = least;
      hi_[i] = most;
    }
    // Run i starts between lo_[i] and hi_[i - 1], ends between lo_[i + 1] and hi_[i]: the latest start must not lie
    // beyond the coarse cell after that of the earliest end.
    bool touch = true;
    touch_.resize(n + 1);
    touch_[0] = touch_[n] = 1;
    for (uint32_t i = 1; i < n; ++i) {
      touch_[i] = hi_[i - 1] >> shift_ <= ((lo_[i + 1] - 1) >> shift_) + 1;
      touch &= touch_[i] != 0;
    }
    lo_[0] = 0;
    for (uint32_t i = 1; i <= n; ++i) lo_[i] >>= shift_;
    for (uint32_t i = 0; i < n; ++i) hi_[i] = (hi_[i] - 1) >> shift_;
    hi_[n] = last_;
    return touch;
  }

  void sweep_one_pattern(std::span<const SetId> runs) {
    const size_t n = runs.size();
    size_t a = 0, b = 0;  // the runs a..b hold coarse cell `at`
    for (uint32_t at = 0;;) {
      while (b + 1 < n && lo_[b + 1] <= at) ++b;
      while (hi_[a] < at) ++a;
      emit(at, union_of(runs.subspan(a, b - a + 1)));
      const uint32_t leaves = hi_[a] + 1, enters = b + 1 < n ? lo_[b + 1] : ~0u;
      at = std::min(leaves, enters);
      if (at > last_) return;
    }
  }

  void collect_events(std::span<const uint32_t> rays) {
    intervals_.clear();
    seen_.clear();
    for (const uint32_t ray : rays) {
      const uint32_t pattern = fine_->pattern[ray];
      if (std::ranges::find(seen_, pattern) != seen_.end()) continue;
      seen_.push_back(pattern);
      merge_runs(pattern, rays);
      const auto runs = fine_->patterns.sets(pattern);
      size_t near = 0;  // which interval of the patterns before
      const size_t before = intervals_.size();
      for (uint32_t i = 0; i < runs.size(); ++i) {
        const size_t of_run = intervals_.size();
        if (touch_[i]) add_interval({lo_[i], hi_[i], runs[i]}, near, before, of_run);
        else
          for (const uint32_t r : rays) {
            if (fine_->pattern[r] != pattern) continue;
            const uint32_t* at = fine_->at.data() + fine_->begin[r];  // an inner run: the ends always touch
            add_interval({at[i - 1] >> shift_, (at[i] - 1) >> shift_, runs[i]}, near, before, of_run);
          }
      }
    }
    events_.clear();
    for (const Interval& i : intervals_) {
      events_.push_back({i.first, i.set, 1});
      events_.push_back({i.last + 1, i.set, -1});
    }
    std::ranges::sort(events_, {}, &Event::at);
  }

  // Rays side by side mostly have nearly the same runs, so most intervals only lengthen one that is there: of the patterns before, or of the same
  // run. Not all of these are found, and none needs to be.
  void add_interval(const Interval& added, size_t& near, size_t before, size_t of_run) {
    constexpr size_t kLooks = 4;
    const auto lengthens = [&](Interval& i) {
      if (i.set != added.set || added.first > i.last + 1 || i.first > added.last + 1) return false;
      i.first = std::min(i.first, added.first);
      i.last = std::max(i.last, added.last);
      return true;
    };
    while (near < before && intervals_[near].last + 1 < added.first) ++near;
    for (size_t k = near; k < std::min(near + kLooks, before); ++k)
      if (lengthens(intervals_[k])) return;
    for (size_t k = intervals_.size(); k-- > of_run && k + kLooks >= intervals_.size();)
      if (lengthens(intervals_[k])) return;
    intervals_.push_back(added);
  }

  void sweep_events() {
    active_.clear();
    for (size_t e = 0; events_[e].at <= last_;) {
      const uint32_t at = events_[e].at;
      for (; e < events_.size() && events_[e].at == at; ++e) {
        const auto it = std::ranges::find(active_, events_[e].set, &Active::set);
        if (it != active_.end()) it->count += events_[e].delta;
        else active_.push_back({events_[e].set, events_[e].delta});
      }
      std::erase_if(active_, [](const Active& a) { return a.count == 0; });
      present_.clear();
      for (const Active& a : active_) present_.push_back(a.set);
      emit(at, union_of(present_));
    }
  }

  SetId union_of(std::span<const SetId> all) {
    // Where sets are that many, unions seldom occur again, and what they are made of on the way would be most of the table.
    constexpr uint32_t kMany = 4096;
    SetId set = all[0];
    if (all.size() < 3 || sets_->ids() - sets_->labels() < kMany) {
      for (const SetId s : all.subspan(1)) set = sets_->unite(set, s);
      return set;
    }
    std::vector<Label> members;
    for (const SetId s : all) {
      const std::vector<Label> of = sets_->members(s);
      members.insert(members.end(), of.begin(), of.end());
    }
    std::ranges::sort(members);
    members.erase(std::unique(members.begin(), members.end()), members.end());
    return sets_->intern(members);
  }

  void emit(uint32_t at, SetId set) {
    if (!labels_.empty() && labels_.back() == set) return;
    if (!labels_.empty()) changes_.push_back(at);
    labels_.push_back(set);
  }

  const RayBlock* fine_ = nullptr;
  int shift_ = 0;
  uint32_t last_ = 0;  // the last coarse cell
  SetTable* sets_ = nullptr;
  std::vector<uint32_t> lo_, hi_, seen_, changes_, least_, most_, places_;
  std::vector<Apart> apart_;  // of each pattern, and perhaps some more
  std::vector<uint8_t> touch_;
  std::vector<SetId> labels_;
  std::vector<Interval> intervals_;
  std::vector<Event> events_;
  std::vector<Active> active_;
  std::vector<SetId> present_;
};

namespace {

// The keys below a node, the first and the last. Its own key is that of its place among the nodes of its height.
std::pair<uint64_t, uint64_t> keys_below(int height, uint32_t cu, uint32_t cv) {
  const int shift = 2 * kFanOutBits * height;
  const uint64_t key = tree_key(cu, cv);
  return {key << shift, ((key + 1) << shift) - 1};
}

}  // namespace

// Halves of halves move apart, so this takes four steps.
uint64_t tree_key(uint32_t cu, uint32_t cv) {
  static_assert(kFanOutBits == 2);
  const auto spread = [](uint64_t x) {  // the bits in pairs, with two zeros before each
    x = (x | x << 16) & 0x0000ffff0000ffff;
    x = (x | x << 8) & 0x00ff00ff00ff00ff;
    x = (x | x << 4) & 0x0f0f0f0f0f0f0f0f;
    return (x | x << 2) & 0x3333333333333333;
  };
  return spread(cv) << kFanOutBits | spread(cu);
}

bool TreeRange::has_all(int height, uint32_t cu, uint32_t cv) const {
  const auto [lowest, highest] = keys_below(height, cu, cv);
  return first <= lowest && highest < end;
}

bool TreeRange::has_any(int height, uint32_t cu, uint32_t cv) const {
  const auto [lowest, highest] = keys_below(height, cu, cv);
  return first <= highest && lowest < end;
}

Chunk coarsen(const Chunk& chunk, int shift) { return Coarsener().coarsen(chunk, shift); }

Coarsener::Coarsener() : ray_(std::make_unique<Ray>()) {}
Coarsener::~Coarsener() = default;

Chunk Coarsener::coarsen(const Chunk& chunk, int shift) {
  const RayBlock& fine = chunk.rays;
  const uint32_t width = 1u << shift;
  Chunk coarse{{}, chunk.sets};  // unions get ids in this table
  RayBlock& out = coarse.rays;
  out.reset((fine.nu + width - 1) >> shift, (fine.nv + width - 1) >> shift, static_cast<uint32_t>((uint64_t{fine.length} + width - 1) >> shift));
  if (fine.uniform()) {
    out.fill(out.nu, out.nv, out.length, fine.patterns.sets(0)[0]);
    return coarse;
  }
  out.pattern.reserve(out.rays());
  out.begin.reserve(out.rays() + 1);
  out.at.reserve((fine.at.size() >> (2 * shift)) * 3);  // a change mostly becomes two
  Ray& ray = *ray_;
  ray.begin(fine, shift, coarse.sets);
  std::vector<uint32_t> differ(fine.nu);  // from the ray of the first row
  for (uint32_t v = 0; v < fine.nv; v += width) {
    const uint32_t rows = std::min(width, fine.nv - v);
    const uint32_t* top = fine.pattern.data() + size_t{v} * fine.nu;
    std::fill(differ.begin(), differ.end(), 0);
    for (uint32_t y = 1; y < rows; ++y)
      for (uint32_t u = 0; u < fine.nu; ++u) differ[u] |= top[size_t{y} * fine.nu + u] ^ top[u];
    const auto has_pattern = [&](uint32_t u, uint32_t pattern) {  // all rays that become one
      uint32_t any = 0;
      for (uint32_t x = u; x < std::min(u + width, fine.nu); ++x) any |= differ[x] | (top[x] ^ pattern);
      return any == 0;
    };
    for (uint32_t u = 0; u < fine.nu;) {
      const uint32_t first = u;
      while (u < fine.nu && has_pattern(u, top[first])) u += width;
      if (u > first) ray.merge_stretch(first, std::min(u, fine.nu), v, rows, out);
      else ray.merge_group(u, v, rows, false, out), u += width;
    }
  }
  return coarse;
}

}  // namespace teracell::store
