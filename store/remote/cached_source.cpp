#include "store/remote/cached_source.hpp"

#include <algorithm>
#include <chrono>

#include "store/base/wanted.hpp"

namespace teracell::inline store {

CachedSource::CachedSource(std::unique_ptr<ByteSource> far, std::unique_ptr<BlockFolder> disk, Kept kept, std::shared_ptr<BlockCache> cache)
    : far_(std::move(far)),
      disk_(std::move(disk)),
      kept_(std::move(kept)),
      cache_(std::move(cache)),
      number_(cache_->new_owner()),
      memory_(std::min(cache_->counts().limit, kMemory)) {}

size_t CachedSource::size_of(uint64_t block) const { return static_cast<size_t>(std::min(kBlock, size() - block * kBlock)); }

bool CachedSource::is_kept(uint64_t offset, uint64_t size) const {
  return offset >= kept_.offset && size <= kept_.bytes.size() && offset - kept_.offset <= kept_.bytes.size() - size;
}

void CachedSource::read(uint64_t offset, std::span<uint8_t> out) const {
  if (out.empty()) return;
  if (is_kept(offset, out.size())) {
    std::copy_n(kept_.bytes.data() + (offset - kept_.offset), out.size(), out.data());
    return;
  }
  if (offset < kHead && offset + out.size() <= kHead && is_far() && size() >= kHead) {
    std::ranges::copy_n(head().data() + offset, static_cast<std::ptrdiff_t>(out.size()), out.data());
    return;
  }
  // What is too large to be kept, or reaches beyond the end, which the source knows how to say.
  if (!is_far() || out.size() > memory_ / 4 || offset > size() || out.size() > size() - offset) return far_->read(offset, out);
  const uint64_t first = offset / kBlock, last = (offset + out.size() - 1) / kBlock;
  std::vector<uint64_t> wanted;
  bool missing = false;
  for (uint64_t b = first; b <= last; ++b) {
    wanted.push_back(b);
    missing = missing || !cache_->find({number_, b});
  }
  for (uint64_t b = last + 1, n = missing ? ahead_of(first, last) : 0; n > 0; --n, ++b) wanted.push_back(b);
  const std::vector<Block> found = blocks(wanted);
  for (uint64_t b = first; b <= last; ++b) {
    const Bytes& bytes = *found[b - first];
    const uint64_t from = std::max(offset, b * kBlock), to = std::min(offset + out.size(), b * kBlock + bytes.size());
    std::copy_n(bytes.data() + (from - b * kBlock), to - from, out.data() + (from - offset));
  }
}

const std::array<uint8_t, CachedSource::kHead>& CachedSource::head() const {
  head_read_([&] { far_->read(0, head_); });
  return head_;
}

// How many blocks behind these to fetch with them: some, more each time, while each read begins where the last one ended.
uint64_t CachedSource::ahead_of(uint64_t first, uint64_t last) const {
  const uint64_t end = (size() + kBlock - 1) / kBlock;
  std::lock_guard lock(mutex_);
  const bool in_a_row = first <= next_ && last >= next_ && next_ > 0;
  window_ = in_a_row ? std::clamp<uint64_t>(2 * window_, 2, kLongest) : 0;
  const uint64_t ahead = std::min(window_, end - last - 1);
  next_ = last + 1 + ahead;
  return ahead;
}

void CachedSource::prefetch(std::span<const ByteRange> soon) const {
  if (!is_far()) return;
  std::vector<uint64_t> wanted;
  for (const ByteRange& r : soon) {
    if (r.size == 0 || r.offset > size() || r.size > size() - r.offset || is_kept(r.offset, r.size)) continue;
    for (uint64_t b = r.offset / kBlock; b <= (r.offset + r.size - 1) / kBlock && wanted.size() < memory_ / kBlock; ++b) wanted.push_back(b);
  }
  std::ranges::sort(wanted);
  const auto [twice, end] = std::ranges::unique(wanted);
  wanted.erase(twice, end);
  wanted.resize(std::min(wanted.size(), memory_ / kBlock / 2));
  blocks(wanted);
}

std::vector<CachedSource::Block> CachedSource::blocks(const std::vector<uint64_t>& wanted) const {
  std::vector<Block> found(wanted.size());
  for (;;) {
    std::vector<uint64_t> mine;
    bool complete = true;
    {
      std::unique_lock lock(mutex_);
      bool others = false;
      for (size_t i = 0; i < wanted.size(); ++i) {
        if (!found[i]) found[i] = cache_->find({number_, wanted[i]});
        if (found[i]) continue;
        complete = false;
        if (fetched_now_.insert(wanted[i]).second) mine.push_back(wanted[i]);
        else others = true;
      }
      if (complete) return found;
      if (mine.empty() && others) {
        changed_.wait_for(lock, std::chrono::milliseconds(100));
        lock.unlock();
        Wanted::stop_if_not();
        continue;
      }
    }
    const auto done = [&] {
      {
        std::lock_guard lock(mutex_);
        for (const uint64_t b : mine) fetched_now_.erase(b);
      }
      changed_.notify_all();
    };
    std::vector<Block> fetched;
    try {
      fetched = fetch(mine);
    } catch (...) {
      done();
      throw;
    }
    auto next = fetched.begin();
    for (size_t i = 0, m = 0; i < wanted.size() && m < mine.size(); ++i)
      if (wanted[i] == mine[m]) found[i] = *next++, ++m;
    done();
  }
}

// From the disk, or else from far away.
std::vector<CachedSource::Block> CachedSource::fetch(const std::vector<uint64_t>& missing) const {
  std::vector<Block> out(missing.size());
  std::vector<size_t> far;  // their places in `missing`
  for (size_t i = 0; i < missing.size(); ++i) {
    if (auto kept = disk_ ? disk_->find(missing[i], size_of(missing[i])) : std::nullopt) out[i] = std::make_shared<const Bytes>(std::move(*kept));
    else far.push_back(i);
  }
  struct Stretch {
    uint64_t first, last;
    Bytes bytes;
  };
  std::vector<Stretch> stretches;
  for (const size_t i : far) {
    const uint64_t b = missing[i];
    if (!stretches.empty() && b - stretches.back().last <= kGap + 1 && b - stretches.back().first < kLongest) stretches.back().last = b;
    else stretches.push_back({b, b, {}});
  }
  auto next = far.begin();
  for (size_t done = 0; done < stretches.size(); done += kTogether) {  // most of a stretch may be gaps: not all of them at once
    const std::span together = std::span(stretches).subspan(done, std::min(kTogether, stretches.size() - done));
    std::vector<ByteRead> reads;
    for (Stretch& s : together) {
      s.bytes.resize(static_cast<size_t>((s.last - s.first) * kBlock + size_of(s.last)));
      reads.push_back({s.first * kBlock, s.bytes});
    }
    far_->read_many(reads);
    for (Stretch& s : together) {
      for (; next != far.end() && missing[*next] <= s.last; ++next) {
        const auto begin = s.bytes.begin() + static_cast<std::ptrdiff_t>((missing[*next] - s.first) * kBlock);
        out[*next] = std::make_shared<const Bytes>(begin, begin + static_cast<std::ptrdiff_t>(size_of(missing[*next])));
        if (disk_) disk_->add(missing[*next], *out[*next]);
      }
      s.bytes = {};
    }
  }
  for (size_t i = 0; i < missing.size(); ++i) cache_->add({number_, missing[i]}, out[i], out[i]->size() + 128);
  return out;
}

}  // namespace teracell::store
