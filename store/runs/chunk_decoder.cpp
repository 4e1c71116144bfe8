#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "store/base/system/vector_units.hpp"
#include "store/runs/chunk_walk.hpp"

namespace teracell::inline store {

namespace {

void decode_palette(ByteReader& in, SetTable& sets, std::vector<SetId>& palette) {
  palette.resize(in.varint(1, in.remaining(), "palette size"));
  for (SetId& id : palette) id = sets.intern(take_set(in, sets.labels(), sets.labels()));
}

void decode_patterns(ByteReader& in, RayBlock& b, const std::vector<SetId>& palette, std::vector<SetId>& sets) {
  const uint64_t count = in.varint(1, std::min<uint64_t>(b.rays(), in.remaining()), "pattern count");
  for (uint64_t p = 0; p < count; ++p) {
    sets.resize(in.varint(0, std::min<uint64_t>(b.length - 1, in.remaining()), "changes of a pattern") + 1);
    for (size_t i = 0; i < sets.size(); ++i) {
      sets[i] = palette[in.varint(0, palette.size() - 1, "palette index")];
      if (i > 0 && sets[i] == sets[i - 1]) in.fail("a pattern repeats a set");
    }
    if (b.patterns.intern(sets) != p) in.fail("a pattern occurs twice");
  }
}

// The loops that take time are functions of their own: browsers compile one function after the other, and small ones soon (web/module).
[[gnu::noinline]] void decode_pattern_of_rays(ByteReader& in, RayBlock& b, bool in_groups) {
  const uint64_t count = in.varint(0, std::min<uint64_t>(b.rays(), in.remaining() / 2), "exceptions");
  std::vector<std::pair<uint32_t, uint32_t>> exceptions(count);  // ray, pattern
  uint64_t next = 0;
  for (auto& [ray, pattern] : exceptions) {
    next += in.varint(0, b.rays(), "gap");
    if (next >= b.rays()) in.fail("an exception lies beyond the last ray");
    ray = static_cast<uint32_t>(next++);
  }
  for (auto& [ray, pattern] : exceptions) pattern = static_cast<uint32_t>(in.varint(0, b.patterns.size() - 1, "pattern"));

  const uint64_t most =
      std::min<uint64_t>(kMaxChunkChanges, uint64_t{in.remaining()} * (in_groups ? kGroup : 1));  // that the bytes can hold; also keeps 32 bits
  b.pattern.resize(b.rays());
  b.begin.resize(b.rays() + 1);
  uint64_t changes = 0;  // so far
  const auto add = [&](uint64_t further) {
    changes += further;
    if (changes > most) in.fail("the rays have more changes than the chunk has bytes for");
  };
  uint32_t* const pattern = b.pattern.data();
  uint32_t* const begin = b.begin.data();
  // The rays [ray, end) have this pattern.
  const auto fill = [&](uint32_t ray, uint32_t end, uint32_t with) {
    const uint32_t each = b.patterns.changes(with);
    auto next_begin = static_cast<uint32_t>(changes);
    add(uint64_t{each} * (end - ray));
    for (; ray < end; ++ray, next_begin += each) pattern[ray] = with, begin[ray] = next_begin;
  };
  auto exception = exceptions.begin();
  for (uint32_t row = 0; row < b.rays(); row += b.nu) {
    begin[row] = static_cast<uint32_t>(changes);
    for (uint32_t ray = row, end = row + b.nu; ray < end;) {
      const uint32_t next =
          exception == exceptions.end() ? end : std::min(end, exception->first);  // what is before it is as expected_pattern() has it
      if (ray == next) {
        fill(ray, ray + 1, exception++->second);
        ++ray;
      } else if (row == 0) {
        fill(ray, next, ray == 0 ? 0 : pattern[ray - 1]);
        ray = next;
      } else if (ray > row && pattern[ray - 1] != pattern[ray - b.nu - 1]) {  // as the ray to the left, up to where that is as the one above it
        const uint32_t left = pattern[ray - 1], from = ray++;
        while (ray < next && pattern[ray - b.nu - 1] != left) ++ray;
        fill(from, ray, left);
      } else {  // as the rays above
        const uint32_t *const above = begin + ray - b.nu, further = static_cast<uint32_t>(changes) - *above;
        add(above[next - ray] - *above);
        std::copy_n(pattern + ray - b.nu, next - ray, pattern + ray);
        std::transform(above, above + (next - ray), begin + ray, [further](uint32_t of_above) { return of_above + further; });
        ray = next;
      }
    }
  }
  begin[b.rays()] = static_cast<uint32_t>(changes);
}

// Eight numbers side by side: compilers find vectors in few of these loops.
using Eight [[gnu::vector_size(32)]] = uint32_t;
TERACELL_IN_LINE inline void load_eight(Eight& numbers, const uint32_t* from) { std::memcpy(&numbers, from, sizeof numbers); }
TERACELL_IN_LINE inline void store_eight(uint32_t* to, const Eight& numbers) { std::memcpy(to, &numbers, sizeof numbers); }

// The sums of the first one, two ... five residuals of each group, filled up to eight.
constexpr auto kSums = [] {
  std::array<std::array<uint32_t, 8>, kSpelled> out{};
  for (uint32_t group = 0; group < kSpelled; ++group)
    for (uint32_t i = 0, rest = group, sum = 0; i < 8; ++i, rest /= 3) out[group][i] = sum += static_cast<uint32_t>(unzigzag(rest % 3));
  return out;
}();

// The running sums of narrow residuals, some at a time: along a row, a change moves from that of the ray above by such a sum, which several
// rays can add at once. Numbers are modulo 2^32.
class Sums {
 public:
  static constexpr uint32_t kMost = 1024;  // of one call: these stay in the cache
  struct Buffer {
    std::array<uint32_t, kMost + 2 * 8> sums;
    std::array<uint16_t, kMost + 2 * 8> escapes;  // which of them end with an escape
  };

  // Of `count` residuals, which it takes from `in`. Their escapes take further bytes there, as they are met.
  Sums(ByteReader& in, uint64_t count, Buffer& buffer) : in_(in), groups_(in.take((count + kGroup - 1) / kGroup)), buffer_(buffer) {
    uint8_t largest = 0;
    uint64_t spelled = 0;
    for (size_t i = 0; i < groups_.size();) {
      uint8_t some = 0;  // a byte, so that vectors count many at once
      for (const size_t end = std::min(groups_.size(), i + 255); i < end; ++i) {
        some += groups_[i] == kSpelled;
        largest = std::max(largest, groups_[i]);
      }
      spelled += some;
    }
    if (largest > kSpelled) in.fail(fmt::format("a group of residuals must be at most {}, found {}", kSpelled, largest));
    const std::span<const uint8_t> full = in.take(kGroup * spelled);
    spelled_ = full.data();
    if (const uint32_t used = count % kGroup; used != 0) {
      uint32_t rest = groups_.back();
      for (uint32_t i = 0; i < used; ++i) rest /= 3;
      if (groups_.back() == kSpelled) rest = std::ranges::any_of(full.last(kGroup - used), [](uint8_t r) { return r != 0; });
      if (rest != 0) in.fail("the last group of residuals must end with zeros");
    }
  }

  // The next `count` sums, and the one before them.
  struct Some {
    const uint32_t* sums;
    uint32_t before;
  };
  // REQUIRES: 0 < count <= kMost, and that many are left.
  Some take(uint32_t count) {
    if (end_ - at_ < count) fill();
    const uint32_t* const sums = buffer_.sums.data() + at_;
    const uint32_t before = std::exchange(before_, sums[count - 1]);
    at_ += count;
    if (escape_ < escapes_ && buffer_.escapes[escape_] < at_) add_escapes();
    return {sums, before};
  }

 private:
  // As many sums as there is room for.
  void fill() {
    const auto drop = [](auto& list, uint32_t& at, uint32_t& end) {
      std::copy(list.begin() + at, list.begin() + end, list.begin());
      end -= at, at = 0;
    };
    for (uint32_t i = escape_; i < escapes_; ++i) buffer_.escapes[i] = static_cast<uint16_t>(buffer_.escapes[i] - at_);
    drop(buffer_.escapes, escape_, escapes_);
    drop(buffer_.sums, at_, end_);
    const std::span<const uint8_t> next = groups_.first(std::min<size_t>(groups_.size(), (kMost + 8 - end_) / kGroup));
    on_vector_unit([this, next]() TERACELL_IN_LINE {
      const uint8_t *group = next.data(), *const end = group + next.size(), *full = spelled_;
      uint32_t sum = sum_, *out = buffer_.sums.data() + end_;
      for (; group != end; ++group, out += kGroup) {
        if (*group < kSpelled) {
          const auto& first = kSums[*group];
          Eight sums;
          load_eight(sums, first.data());
          store_eight(out, sums + sum);
          sum += first[kGroup - 1];
          continue;
        }
        for (uint32_t i = 0; i < kGroup; ++i) {
          const uint8_t r = *full++;
          if (r == kEscape) buffer_.escapes[escapes_++] = static_cast<uint16_t>(out + i - buffer_.sums.data());
          out[i] = sum += static_cast<uint32_t>(unzigzag(r));
        }
      }
      sum_ = sum, spelled_ = full;
    });
    end_ += static_cast<uint32_t>(kGroup * next.size());
    groups_ = groups_.subspan(next.size());
  }

  // Adds what the escapes before at_ say to all sums behind them, up to there.
  void add_escapes() {
    uint32_t added = 0, i = buffer_.escapes[escape_];
    while (i < at_) {
      const auto wide = static_cast<uint32_t>(in_.varint(0, ~0u - kEscape, "residual"));
      added += static_cast<uint32_t>(unzigzag(kEscape + wide)) - static_cast<uint32_t>(unzigzag(kEscape));
      ++escape_;
      const uint32_t end = escape_ < escapes_ ? std::min<uint32_t>(buffer_.escapes[escape_], at_) : at_;
      for (; i < end; ++i) buffer_.sums[i] += added;
    }
  }

  ByteReader& in_;
  std::span<const uint8_t> groups_;  // that are not in the buffer yet
  const uint8_t* spelled_;           // the residuals of those among them that are spelled
  uint32_t sum_ = 0, before_ = 0;    // of all in the buffer; of all that were taken
  Buffer& buffer_;
  uint32_t at_ = 0, end_ = 0;           // what is left there
  uint32_t escape_ = 0, escapes_ = 0;  // the same of the escapes
};

// Rays that are predicted in the same way: see walk().
struct RayStretch {
  uint32_t from, to;
  From how;
};

// Whether the changes of these rays ascend and lie within the length. All rays have n changes.
bool are_sound(std::span<const uint32_t> changes, uint32_t n, uint32_t length) {
  uint32_t wrong = 0;
  on_vector_unit([=, &wrong]() TERACELL_IN_LINE {
    const uint32_t *const at = changes.data(), cells = length;
    const size_t end = changes.size();
    uint32_t any = 0;
    if (n == 1)
      for (size_t i = 0; i < end; ++i) any |= (at[i] == 0) | (at[i] >= cells);
    else if (n == 2)
      for (size_t i = 0; i < end; i += 2) any |= (at[i] == 0) | (at[i] >= at[i + 1]) | (at[i + 1] >= cells);
    else
      for (size_t i = 0; i < end; i += n) {
        any |= (at[i] == 0) | (at[i + n - 1] >= cells);
        for (size_t k = 1; k < n; ++k) any |= at[i + k - 1] >= at[i + k];
      }
    wrong = any;
  });
  return wrong == 0;
}

// The changes of rays that the plane predicts. All have n changes. `at` and `up` are those of the first ray and of the one above it, and the
// rays to the left of these stand before them.
void decode_plane(Sums& sums, uint32_t* at, const uint32_t* up, uint32_t n, uint32_t rays) {
  if (n > 2 || n * rays > Sums::kMost) {
    for (uint32_t change = 0; change < n; ++change)
      for (uint32_t from = 0, to; from < rays; from = to) {
        to = std::min(rays, from + Sums::kMost);
        const Sums::Some some = sums.take(to - from);
        uint32_t* out = at + size_t{from} * n + change;
        const uint32_t *above = up + size_t{from} * n + change, moved = *(out - n) - *(above - n) - some.before;
        for (uint32_t ray = 0; ray < to - from; ++ray, out += n, above += n) *out = *above + some.sums[ray] + moved;
      }
    return;
  }
  const Sums::Some some = sums.take(n * rays);
  on_vector_unit([=]() TERACELL_IN_LINE {
    uint32_t* __restrict const out = at;
    const uint32_t *const above = up, *const of_first = some.sums, *const of_second = of_first + rays;
    const size_t many = rays;
    const uint32_t moved = *(at - n) - *(up - n) - some.before, moved_too = n == 2 ? *(at - 1) - *(up - 1) - *(of_second - 1) : 0;
    // The rays [ray, ray + 8).
    const auto eight = [=](size_t ray) TERACELL_IN_LINE {
      Eight first, second, low, high;
      load_eight(first, of_first + ray);
      load_eight(low, above + n * ray);
      if (n == 1) return store_eight(out + ray, low + first + moved);
      load_eight(second, of_second + ray);
      load_eight(high, above + 2 * ray + 8);
      first += moved, second += moved_too;
      store_eight(out + 2 * ray, low + __builtin_shufflevector(first, second, 0, 8, 1, 9, 2, 10, 3, 11));
      store_eight(out + 2 * ray + 8, high + __builtin_shufflevector(first, second, 4, 12, 5, 13, 6, 14, 7, 15));
    };
    if (many < 8) {
      for (size_t ray = 0; ray < many; ++ray) {
        out[n * ray] = above[n * ray] + of_first[ray] + moved;
        if (n == 2) out[2 * ray + 1] = above[2 * ray + 1] + of_second[ray] + moved_too;
      }
      return;
    }
    for (size_t ray = 0; ray + 8 < many; ray += 8) eight(ray);
    eight(many - 8);  // some of them again
  });
}

// `plane` decodes the changes of a stretch that the plane predicts.
template <class Plane>
void decode_stretches(ByteReader& in, RayBlock& b, const std::vector<RayStretch>& stretches, Plane plane) {
  const auto number = [&]() -> uint32_t {  // a varint, which has mostly one byte
    const uint32_t first = in.take(1).front();
    return first < 0x80 ? first : (first & 0x7F) | static_cast<uint32_t>(in.varint(0, ~0u >> 7, "change")) << 7;
  };
  for (const RayStretch& s : stretches) {
    uint32_t* const at = b.at.data() + b.begin[s.from];
    const uint32_t n = b.begin[s.from + 1] - b.begin[s.from];
    if (s.how == From::kPlane) {
      plane(at, b.at.data() + b.begin[s.from - b.nu], n, s.to - s.from);
      continue;
    }
    const uint32_t* like = b.at.data() + b.begin[s.how == From::kUp ? s.from - b.nu : s.from - (s.how == From::kLeft)];
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t wide = number();
      at[i] = s.how == From::kNothing ? (i == 0 ? 0 : at[i - 1]) + wide + 1 : like[i] + static_cast<uint32_t>(unzigzag(wide));
    }
  }
  // Rays with equally many changes at once. Those between them that have none take no place.
  const auto changes_of = [&](const RayStretch& s) { return b.begin[s.from + 1] - b.begin[s.from]; };
  bool sound = true;
  for (size_t i = 0, end; i < stretches.size(); i = end) {
    const uint32_t n = changes_of(stretches[i]);
    for (end = i + 1; end < stretches.size() && changes_of(stretches[end]) == n;) ++end;
    const uint32_t from = b.begin[stretches[i].from], to = b.begin[stretches[end - 1].to];
    sound &= are_sound(std::span(b.at).subspan(from, to - from), n, b.length);
  }
  if (!sound) in.clause("11.4"), in.fail("the changes of a ray must ascend within it");
}

[[gnu::noinline]] void decode_changes(ByteReader& in, RayBlock& b, bool in_groups, std::vector<RayStretch>& stretches, Sums::Buffer& buffer) {
  b.at.resize(b.begin.back());
  stretches.clear();
  uint64_t planar = 0;
  walk(
      b,
      [&](uint32_t ray, From from) {
        stretches.push_back({ray, ray + 1, from});
      },
      [&](uint32_t from, uint32_t to) {
        stretches.push_back({from, to, From::kPlane});
        planar += b.begin[to] - b.begin[from];
      });
  if (in_groups) {
    Sums sums(in, planar, buffer);
    return decode_stretches(in, b, stretches,
                            [&](uint32_t* at, const uint32_t* up, uint32_t n, uint32_t rays) { decode_plane(sums, at, up, n, rays); });
  }
  const uint8_t* narrow = in.take(planar).data();
  decode_stretches(in, b, stretches, [&](uint32_t* at, const uint32_t* up, uint32_t n, uint32_t rays) {
    for (uint32_t i = 0; i < n * rays; ++i) {
      uint32_t r = *narrow++;
      if (r == kEscape) r += static_cast<uint32_t>(in.varint(0, ~0u - kEscape, "residual"));
      at[i] = (at - n)[i] + up[i] - (up - n)[i] + static_cast<uint32_t>(unzigzag(r));
    }
  });
}

}  // namespace

struct ChunkDecoder::Scratch {
  ZstdDecoder zstd;
  Bytes body;
  std::vector<SetId> palette, sets;
  std::vector<RayStretch> stretches;
  Sums::Buffer sums;
};

ChunkDecoder::ChunkDecoder() : s_(std::make_unique<Scratch>()) {}
ChunkDecoder::~ChunkDecoder() = default;

void ChunkDecoder::decode(std::span<const uint8_t> frame, uint32_t nu, uint32_t nv, uint32_t length, uint32_t labels, Chunk& out) {
  if (uint64_t{nu} * nv > kMaxChunkRays)
    throw FormatError(fmt::format("a chunk of {} x {} rays is larger than a file may have (FORMAT.md 7.6)", nu, nv));
  Scratch& s = *s_;
  s.zstd.decode(frame, kChunkBound, "chunk", s.body);

  ByteReader in(s.body, "chunk", "11.1");
  out.rays.nu = nu, out.rays.nv = nv, out.rays.length = length;
  out.rays.patterns.clear();  // all else is overwritten, and need not be cleared
  out.sets = SetTable(labels);
  const bool in_groups = !s.body.empty() && s.body.front() == kInGroups;
  if (in_groups) in.take(1);
  decode_palette(in, out.sets, s.palette);
  decode_patterns(in, out.rays, s.palette, s.sets);
  decode_pattern_of_rays(in, out.rays, in_groups);
  in.clause("11.3");
  decode_changes(in, out.rays, in_groups, s.stretches, s.sums);
  in.expect_end();
}

}  // namespace teracell::store
