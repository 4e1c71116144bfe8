#include "mesher/tiles/piece_log.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/base/populate.hpp"
#include "store/format/format.hpp"

namespace teracell::mesher {

PieceLog::PieceLog(const Budget& budget, uint64_t expected, bool in_memory, bool own_writer)
    : expected_(expected),
      block_(std::bit_floor(std::clamp<uint64_t>(budget.bytes >> 10, uint64_t{1} << 16, uint64_t{1} << 18))),
      writer_(own_writer) {
  if (in_memory) return;
  file_.emplace(budget.folder, expected);
  begin_block();
}

void PieceLog::begin_block() {
  if (writer_.has_thread() || !waiting_) waiting_ = lists_.next();
  waiting_->clear();
  waiting_->reserve(block_);
}

// The kernel clears memory that is new, which may take longer than filling it. So the other thread asks for the next block where one is expected.
// (Not in huge pages: where they had to come from the host of a virtual machine, the bins of 25.6 million facets took an eighth longer.)
void PieceLog::hold_block() {
  const auto new_block = [] { return std::make_unique_for_overwrite<uint8_t[]>(kBlockInMemory); };
  writer_.finish();
  held_.push_back(next_held_ ? std::move(next_held_) : new_block());
  used_ = 0;
  if (!writer_.has_thread() || expected_ < (held_.size() + 1) * kBlockInMemory) return;
  writer_.run([this, new_block] {
    next_held_ = new_block();
    system::populate(next_held_.get(), kBlockInMemory);
  });
}

PieceLog::Piece PieceLog::add(std::span<const uint8_t> bytes) {
  Piece out{end_, bytes.size(), 0};
  end_ += bytes.size();
  if (in_memory()) {
    if (used_ + bytes.size() > kBlockInMemory) hold_block();
    out.offset = (held_.size() - 1) * kBlockInMemory + used_;
    std::memcpy(held_.back().get() + used_, bytes.data(), bytes.size());
    used_ += bytes.size();
    return out;
  }
  out.checksum = checksum(bytes);
  while (!bytes.empty()) {
    const auto now = bytes.first(std::min(bytes.size(), block_ - waiting_->size()));
    waiting_->insert(waiting_->end(), now.begin(), now.end());
    bytes = bytes.subspan(now.size());
    if (waiting_->size() == block_) hand_on();
  }
  return out;
}

void PieceLog::hand_on() {
  writer_.run([this, offset = handed_on_, block = waiting_] { file_->write(offset, *block); });
  handed_on_ += waiting_->size();
  begin_block();
}

// What waits stays, so that blocks begin where pages do.
void PieceLog::finish() {
  if (in_memory()) return;
  writer_.finish();
  if (!waiting_->empty()) file_->write(handed_on_, *waiting_);
}

void PieceLog::close() {
  finish();
  if (!in_memory()) return;
  writer_.finish();
  next_held_.reset();
}

std::span<const uint8_t> PieceLog::read(const Piece& piece, std::vector<uint8_t>& room) const {
  if (in_memory()) return {held_[piece.offset / kBlockInMemory].get() + piece.offset % kBlockInMemory, piece.bytes};
  room.resize(piece.bytes);
  file_->read(piece.offset, room);
  if (checksum(room) != piece.checksum)
    throw IoError(fmt::format("a temporary file is damaged: the {} bytes at {} are not those that were written", piece.bytes, piece.offset));
  return room;
}

}  // namespace teracell::mesher
