#include "mesher/tiles/piece_log.hpp"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/format/format.hpp"

namespace teracell::mesher {

// In memory, too, it is a file. (Rejected: blocks of the heap, even with pages that another thread asked for ahead. On a virtual machine whose pages
// come one by one from its host, meshing 25.6 million facets took 1.13 times as long.)
PieceLog::PieceLog(const Budget& budget, uint64_t expected, bool in_memory, bool own_writer)
    : block_(std::bit_floor(std::clamp<uint64_t>(budget.bytes >> 10, uint64_t{1} << 16, uint64_t{1} << 18))),
      file_(budget.folder, expected, in_memory),
      writer_(own_writer && !file_.in_memory()) {
  begin_block();
}

void PieceLog::begin_block() {
  if (writer_.has_thread() || !waiting_) waiting_ = lists_.next();
  waiting_->clear();
  waiting_->reserve(block_);
}

PieceLog::Piece PieceLog::add(std::span<const uint8_t> bytes) {
  Piece out{end_, bytes.size(), 0};
  constexpr size_t kWorthACall = 8192;
  if (in_memory() && bytes.size() >= kWorthACall) {  // to copy it first, for fewer calls, would take longer
    write_waiting();
    file_.write(end_, bytes);
    handed_on_ = end_ += bytes.size();
    return out;
  }
  end_ += bytes.size();
  if (!in_memory()) out.checksum = checksum(bytes);
  while (!bytes.empty()) {
    const auto now = bytes.first(std::min(bytes.size(), block_ - waiting_->size()));
    waiting_->insert(waiting_->end(), now.begin(), now.end());
    bytes = bytes.subspan(now.size());
    if (waiting_->size() == block_) hand_on();
  }
  return out;
}

void PieceLog::hand_on() {
  writer_.run([this, offset = handed_on_, block = waiting_] { file_.write(offset, *block); });
  handed_on_ += waiting_->size();
  begin_block();
}

void PieceLog::write_waiting() {
  if (waiting_->empty()) return;
  file_.write(handed_on_, *waiting_);
  handed_on_ += waiting_->size();
  waiting_->clear();
}

// On a disk what waits stays, so that blocks begin where pages do.
void PieceLog::finish() {
  writer_.finish();
  if (!waiting_->empty()) file_.write(handed_on_, *waiting_);
}

std::span<const uint8_t> PieceLog::read(const Piece& piece, std::vector<uint8_t>& room) const {
  room.resize(piece.bytes);
  file_.read(piece.offset, room);
  if (!in_memory() && checksum(room) != piece.checksum)
    throw IoError(fmt::format("a temporary file is damaged: the {} bytes at {} are not those that were written", piece.bytes, piece.offset));
  return room;
}

}  // namespace teracell::mesher
