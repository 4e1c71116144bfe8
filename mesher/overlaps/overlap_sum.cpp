#include "mesher/overlaps/overlap_sum.hpp"

#include <algorithm>
#include <queue>
#include <utility>

namespace teracell::mesher {
namespace {

constexpr size_t kBlock = size_t{1} << 16;
constexpr uint64_t kLeastLimit = uint64_t{1} << 20, kLeastMerge = uint64_t{1} << 18;

}  // namespace

// Goes through a piece.
class OverlapSum::Cursor {
 public:
  Cursor(const Piece& piece, const Disk* disk) : piece_(piece), disk_(disk) { advance(); }
  const std::optional<Overlap>& now() const { return now_; }
  void advance() {
    const std::array<uint32_t, 2> before = now_ ? now_->bodies : std::array<uint32_t, 2>{};
    now_.reset();
    while (!(block_ && (now_ = block_->next())) && next_ < piece_.size()) open(piece_[next_++]);
    if (now_ && now_->bodies <= before) throw FormatError("the overlaps: expected pairs of bodies that ascend, found others");
  }

 private:
  void open(const Block& block) {
    if (block.size == 0) {
      block_.emplace(block.bytes);
    } else {
      buffer_.resize(block.size);
      disk_->file.read(block.offset, buffer_);
      block_.emplace(buffer_);
    }
  }
  const Piece& piece_;
  const Disk* disk_;
  size_t next_ = 0;
  Bytes buffer_;
  std::optional<OverlapUnpacker> block_;
  std::optional<Overlap> now_;
};

void OverlapSum::bound(const Budget& budget) {
  limit_ = std::max(budget.bytes / 16, kLeastLimit);
  folder_ = budget.folder;
}

void OverlapSum::add(Bytes&& packed) {
  if (packed.empty()) return;
  Piece piece;
  piece.push_back({std::move(packed)});
  add(std::move(piece));
}

void OverlapSum::add(Piece&& piece) {
  for (const Block& block : piece) recent_bytes_ += block.bytes.size();
  pieces_.push_back(std::move(piece));
  if (recent_bytes_ > std::max(kLeastMerge, merged_bytes_)) merge_recent();
}

// Pieces on disk are read, because `other` may have a disk of its own.
void OverlapSum::add(const OverlapSum& other) {
  if (other.on_disk_ > 0) {
    other.pack(other.pieces_, [&](Bytes&& block) { add(std::move(block)); });
    return;
  }
  for (const Piece& piece : other.pieces_) add(Piece(piece));
}

// Each time as much is new as was merged before, so a pair is merged few times however many tiles there are.
void OverlapSum::merge_recent() {
  Piece merged;
  merged_bytes_ = recent_bytes_ = 0;
  pack(std::span(pieces_).subspan(on_disk_), [&](Bytes&& block) {
    merged_bytes_ += block.size();
    merged.push_back({std::move(block)});
  });
  pieces_.resize(on_disk_);
  pieces_.push_back(std::move(merged));
  if (merged_bytes_ > limit_) spill();
}

void OverlapSum::spill() {
  if (!disk_) disk_ = std::make_shared<Disk>(folder_, merged_bytes_);
  for (Block& block : pieces_.back()) {
    disk_->file.write(disk_->end, block.bytes);
    const auto size = static_cast<uint32_t>(block.bytes.size());
    block = {{}, disk_->end, size};
    disk_->end += size;
  }
  ++on_disk_;
  merged_bytes_ = 0;
}

void OverlapSum::merge(std::span<const Piece> pieces, const std::function<void(const Overlap&)>& f) const {
  std::vector<Cursor> cursors;
  cursors.reserve(pieces.size());
  const auto after = [&](size_t a, size_t b) { return cursors[a].now()->bodies > cursors[b].now()->bodies; };
  std::priority_queue<size_t, std::vector<size_t>, decltype(after)> queue(after);
  for (const Piece& piece : pieces) {
    cursors.emplace_back(piece, disk_.get());
    if (cursors.back().now()) queue.push(cursors.size() - 1);
  }
  std::optional<Overlap> sum;
  while (!queue.empty()) {
    const size_t least = queue.top();
    queue.pop();
    const Overlap& found = *cursors[least].now();
    if (sum && sum->bodies == found.bodies) {
      sum->add(found);
    } else {
      if (sum) f(*sum);
      sum = found;
    }
    cursors[least].advance();
    if (cursors[least].now()) queue.push(least);
  }
  if (sum) f(*sum);
}

void OverlapSum::pack(std::span<const Piece> pieces, const std::function<void(Bytes&&)>& put_block) const {
  OverlapPacker packer;
  merge(pieces, [&](const Overlap& o) {
    packer.put(o);
    if (packer.bytes() >= kBlock) put_block(packer.take());
  });
  if (packer.bytes() > 0) put_block(packer.take());
}

void OverlapSum::for_each(const std::function<void(const Overlap&)>& f) const { merge(pieces_, f); }

void OverlapSum::save(Bytes& out) const {
  pack(pieces_, [&](Bytes&& block) { put_sized(out, block); });
  put_varint(out, 0);
}

OverlapSum OverlapSum::restored(ByteReader& in) {
  OverlapSum out;
  Piece piece;
  while (const uint64_t size = in.varint()) {
    const auto bytes = in.take(size);
    piece.push_back({{bytes.begin(), bytes.end()}});
  }
  if (!piece.empty()) out.add(std::move(piece));
  return out;
}

}  // namespace teracell::mesher
