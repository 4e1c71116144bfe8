#include "store/runs/run.hpp"

#include <tuple>

namespace teracell::inline store {

void RayBlock::reset(uint32_t new_nu, uint32_t new_nv, uint32_t new_length) {
  nu = new_nu;
  nv = new_nv;
  length = new_length;
  patterns.clear();
  pattern.clear();
  begin.assign(1, 0);
  at.clear();
}

void RayBlock::reset_in_place(uint32_t new_nu, uint32_t new_nv, uint32_t new_length, size_t changes) {
  nu = new_nu;
  nv = new_nv;
  length = new_length;
  patterns.clear();
  pattern.resize(rays());
  begin.resize(rays() + 1);
  begin[0] = 0;
  at.resize(changes);
}

void RayBlock::fill(uint32_t new_nu, uint32_t new_nv, uint32_t new_length, SetId set) {
  reset(new_nu, new_nv, new_length);
  patterns.intern({&set, 1});
  pattern.assign(rays(), 0);
  begin.assign(rays() + 1, 0);
}

SegmentCutter::SegmentCutter(const RayBlock& block) : block_(block) {
  for (uint32_t first = 0, end; first < block.rays(); first = end) {
    const uint32_t pattern = block.pattern[first], n = block.patterns.changes(pattern);
    for (end = first + 1; end < block.rays() && block.pattern[end] == pattern;) ++end;
    stretches_.push_back({first, end, pattern, least_.size()});
    const uint32_t *const begin = block.at.data() + block.begin[first], *const stop = block.at.data() + block.begin[end];
    for (uint32_t i = 0; i < n; ++i) {
      uint32_t least = ~uint32_t{0}, most = 0;
      for (const uint32_t* at = begin + i; at < stop; at += n) least = std::min(least, *at), most = std::max(most, *at);
      least_.push_back(least), most_.push_back(most);
    }
  }
}

RayBlock SegmentCutter::cut(uint32_t from, uint32_t to) const {
  RayBlock out;
  out.reset(block_.nu, block_.nv, to - from);
  out.pattern.reserve(block_.rays());
  out.begin.reserve(block_.rays() + 1);
  for (const Stretch& s : stretches_) {
    const uint32_t n = block_.patterns.changes(s.pattern);
    const std::span<const uint32_t> least(least_.data() + s.extremes, n), most(most_.data() + s.extremes, n);
    const auto up_to = [](std::span<const uint32_t> all, uint32_t cell) {  // how many changes
      return static_cast<uint32_t>(std::ranges::upper_bound(all, cell) - all.begin());
    };
    const auto piece = [&](uint32_t lo, uint32_t hi) { return out.patterns.intern(block_.patterns.sets(s.pattern).subspan(lo, hi - lo + 1)); };
    const uint32_t lo = up_to(most, from), hi = up_to(most, to - 1);
    if (lo == up_to(least, from) && hi == up_to(least, to - 1)) {  // the same changes of all these rays
      const uint32_t rays = s.end - s.first, each = hi - lo;
      const size_t ray = out.pattern.size(), place = out.at.size();
      out.pattern.resize(ray + rays, piece(lo, hi));
      out.begin.resize(ray + rays + 1);
      out.at.resize(place + size_t{each} * rays);
      uint32_t *begin = out.begin.data() + ray + 1, *to_at = out.at.data() + place;
      for (uint32_t i = 0; i < rays; ++i) begin[i] = static_cast<uint32_t>(place) + each * (i + 1);
      const uint32_t* at = block_.at.data() + block_.begin[s.first];
      if (each == n)
        for (size_t i = 0; i < size_t{each} * rays; ++i) to_at[i] = at[i] - from;
      else if (each > 0)
        for (uint32_t i = 0; i < rays; ++i, at += n)
          for (uint32_t change = lo; change < hi; ++change) *to_at++ = at[change] - from;
      continue;
    }
    uint32_t lo_before = ~uint32_t{0}, hi_before = 0, pattern = 0;
    for (uint32_t ray = s.first; ray < s.end; ++ray) {
      const std::span<const uint32_t> at = block_.changes(ray);
      const uint32_t first = up_to(at, from), end = up_to(at, to - 1);
      if (first != lo_before || end != hi_before) pattern = piece(first, end), lo_before = first, hi_before = end;
      out.pattern.push_back(pattern);
      for (uint32_t i = first; i < end; ++i) out.at.push_back(at[i] - from);
      out.begin.push_back(static_cast<uint32_t>(out.at.size()));
    }
  }
  return out;
}

Chunk join(std::span<const Piece> pieces, uint32_t labels) {
  Chunk out;
  uint32_t nu = 0, nv = 0, length = 0;
  for (const Piece& p : pieces) {
    nu = std::max(nu, p.u + p.chunk->rays.nu);
    nv = std::max(nv, p.v + p.chunk->rays.nv);
    length = std::max(length, p.w + p.chunk->rays.length);
  }
  out.rays.reset(nu, nv, length);
  out.sets = SetTable(labels);
  out.rays.pattern.reserve(out.rays.rays());
  out.rays.begin.reserve(out.rays.rays() + 1);
  // Sorted by place: row by row, and within a row by piles, which are the pieces along the same rays.
  std::vector<Piece> order(pieces.begin(), pieces.end());
  std::ranges::sort(order, [](const Piece& a, const Piece& b) { return std::tie(a.v, a.u, a.w) < std::tie(b.v, b.u, b.w); });
  struct Source {
    Piece piece;
    std::vector<std::vector<SetId>> patterns;  // of the piece, in the ids of `out`
    std::vector<uint32_t> known;               // each of them as a pattern of `out`; ~0: no ray had it yet
  };
  std::vector<Source> sources;
  for (const Piece& p : order) {
    Source s{p, {}, std::vector<uint32_t>(p.chunk->rays.patterns.size(), ~0u)};
    const PatternTable& from = p.chunk->rays.patterns;
    for (uint32_t i = 0; i < from.size(); ++i) {
      std::vector<SetId> sets;
      for (const SetId id : from.sets(i)) sets.push_back(id < labels ? id : out.sets.intern(p.chunk->sets.members(id)));
      s.patterns.push_back(std::move(sets));
    }
    sources.push_back(std::move(s));
  }
  // Appends a ray that runs through a pile of pieces.
  std::vector<SetId> sets;
  std::vector<uint32_t> changes;
  const auto append = [&](std::span<const Source> pile, uint32_t ray) {
    sets.clear();
    changes.clear();
    for (const Source& s : pile) {
      const RayBlock& rays = s.piece.chunk->rays;
      const std::vector<SetId>& pattern = s.patterns[rays.pattern[ray]];
      const auto at = rays.changes(ray);
      for (size_t k = 0; k < pattern.size(); ++k) {
        if (!sets.empty() && sets.back() == pattern[k]) continue;
        if (!sets.empty()) changes.push_back(s.piece.w + (k == 0 ? 0 : at[k - 1]));
        sets.push_back(pattern[k]);
      }
    }
    out.rays.append(sets, changes);
  };
  // The same for a row of rays that are those of one piece.
  const auto append_row = [&](Source& s, uint32_t first, uint32_t end) {
    const RayBlock& rays = s.piece.chunk->rays;
    const auto moved = static_cast<uint32_t>(out.rays.at.size()) - rays.begin[first];
    out.rays.at.insert(out.rays.at.end(), rays.at.begin() + rays.begin[first], rays.at.begin() + rays.begin[end]);
    for (uint32_t ray = first; ray < end; ++ray) {
      uint32_t& pattern = s.known[rays.pattern[ray]];
      if (pattern == ~0u) pattern = out.rays.patterns.intern(s.patterns[rays.pattern[ray]]);
      out.rays.pattern.push_back(pattern);
      out.rays.begin.push_back(rays.begin[ray + 1] + moved);
    }
  };
  // The end of the sources that are like the one at `first`.
  const auto group = [&](size_t first, size_t last, auto same) {
    size_t end = first;
    while (end < last && same(sources[end].piece, sources[first].piece)) ++end;
    return end;
  };
  for (size_t row = 0; row < sources.size();) {
    const size_t row_end = group(row, sources.size(), [](const Piece& a, const Piece& b) { return a.v == b.v; });
    const uint32_t height = sources[row].piece.chunk->rays.nv;
    for (uint32_t y = 0; y < height; ++y) {
      for (size_t pile = row; pile < row_end;) {
        const size_t pile_end = group(pile, row_end, [](const Piece& a, const Piece& b) { return a.u == b.u; });
        const uint32_t width = sources[pile].piece.chunk->rays.nu;
        if (pile_end - pile == 1) append_row(sources[pile], y * width, y * width + width);
        else
          for (uint32_t x = 0; x < width; ++x) append({&sources[pile], pile_end - pile}, y * width + x);
        pile = pile_end;
      }
    }
    row = row_end;
  }
  return out;
}

}  // namespace teracell::store
