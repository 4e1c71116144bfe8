#include "store/runs/pyramid.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace teracell::inline store {
namespace {

constexpr size_t kMostMerged = 16;  // rays that become one: 4 x 4, two levels up

// Makes one coarse ray at a time. Rays of equal pattern are merged first, run by run: as long as the parts of run i of all
// rays touch, it covers the coarse cells from its least start to its greatest end, and both ascend with i. Most groups of
// rays have a single pattern, and a sweep with two pointers is all that they need. Silhouettes, and walls so steep that the
// parts lie apart, need the general sweep over intervals.
class CoarseRay {
 public:
  CoarseRay(const RayBlock& fine, int shift, SetTable& sets) : fine_(fine), shift_(shift), last_((fine.length - 1) >> shift), sets_(sets) {}

  // Appends the ray that `rays` become. `one_pattern`: all of them have the same pattern.
  void merge(std::span<const uint32_t> rays, bool one_pattern, RayBlock& out) {
    labels_.clear();
    changes_.clear();
    const uint32_t pattern = fine_.pattern[rays[0]];
    if (one_pattern) {
      if (fine_.patterns.changes(pattern) == 0) {
        out.append(fine_.patterns.sets(pattern), {});
        return;
      }
      if (merge_runs(pattern, rays)) {
        sweep_one_pattern(fine_.patterns.sets(pattern));
        out.append(labels_, changes_);
        return;
      }
    }
    collect_events(rays);
    sweep_events();
    out.append(labels_, changes_);
  }

 private:
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
    const uint32_t n = fine_.patterns.changes(pattern);
    lo_.resize(n + 1);
    hi_.resize(n + 1);
    std::array<const uint32_t*, kMostMerged> changes;  // of each ray of this pattern
    uint32_t count = 0;
    for (const uint32_t ray : rays)
      if (fine_.pattern[ray] == pattern) changes[count++] = fine_.at.data() + fine_.begin[ray];
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
    events_.clear();
    seen_.clear();
    for (const uint32_t ray : rays) {
      const uint32_t pattern = fine_.pattern[ray];
      if (std::ranges::find(seen_, pattern) != seen_.end()) continue;
      seen_.push_back(pattern);
      merge_runs(pattern, rays);
      const auto runs = fine_.patterns.sets(pattern);
      for (uint32_t i = 0; i < runs.size(); ++i) {
        if (touch_[i]) add_interval(lo_[i], hi_[i], runs[i]);
        else
          for (const uint32_t r : rays) {
            if (fine_.pattern[r] != pattern) continue;
            const uint32_t* at = fine_.at.data() + fine_.begin[r];  // an inner run: the ends always touch
            add_interval(at[i - 1] >> shift_, (at[i] - 1) >> shift_, runs[i]);
          }
      }
    }
    std::ranges::sort(events_, {}, &Event::at);
  }

  void add_interval(uint32_t first, uint32_t last, SetId set) {
    events_.push_back({first, set, 1});
    events_.push_back({last + 1, set, -1});
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
    if (all.size() < 3 || sets_.ids() - sets_.labels() < kMany) {
      for (const SetId s : all.subspan(1)) set = sets_.unite(set, s);
      return set;
    }
    std::vector<Label> members;
    for (const SetId s : all) {
      const std::vector<Label> of = sets_.members(s);
      members.insert(members.end(), of.begin(), of.end());
    }
    std::ranges::sort(members);
    members.erase(std::unique(members.begin(), members.end()), members.end());
    return sets_.intern(members);
  }

  void emit(uint32_t at, SetId set) {
    if (!labels_.empty() && labels_.back() == set) return;
    if (!labels_.empty()) changes_.push_back(at);
    labels_.push_back(set);
  }

  const RayBlock& fine_;
  const int shift_;
  const uint32_t last_;  // the last coarse cell
  SetTable& sets_;
  std::vector<uint32_t> lo_, hi_, seen_, changes_;
  std::vector<uint8_t> touch_;
  std::vector<SetId> labels_;
  std::vector<Event> events_;
  std::vector<Active> active_;
  std::vector<SetId> present_;
};

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

Chunk coarsen(const Chunk& chunk, int shift) {
  const RayBlock& fine = chunk.rays;
  const uint32_t width = 1u << shift;
  Chunk coarse{{}, chunk.sets};  // unions get ids in this table
  RayBlock& out = coarse.rays;
  out.reset((fine.nu + width - 1) >> shift, (fine.nv + width - 1) >> shift, static_cast<uint32_t>((uint64_t{fine.length} + width - 1) >> shift));
  if (fine.uniform()) {
    out.fill(out.nu, out.nv, out.length, fine.patterns.sets(0)[0]);
    return coarse;
  }
  CoarseRay ray(fine, shift, coarse.sets);
  std::array<uint32_t, kMostMerged> rays;
  for (uint32_t v = 0; v < fine.nv; v += width) {
    for (uint32_t u = 0; u < fine.nu; u += width) {
      uint32_t count = 0, differ = 0;
      const uint32_t first = fine.pattern[v * fine.nu + u];
      for (uint32_t y = v; y < std::min(v + width, fine.nv); ++y)
        for (uint32_t x = u; x < std::min(u + width, fine.nu); ++x) {
          rays[count++] = y * fine.nu + x;
          differ |= fine.pattern[y * fine.nu + x] ^ first;
        }
      ray.merge({rays.data(), count}, differ == 0, out);
    }
  }
  return coarse;
}

}  // namespace teracell::store
