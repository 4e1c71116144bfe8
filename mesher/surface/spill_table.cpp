#include "mesher/surface/spill_table.hpp"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/format/format.hpp"

namespace teracell::mesher {
namespace {

template <class T>
std::span<uint8_t> bytes_of(T& value) {
  return {reinterpret_cast<uint8_t*>(&value), sizeof value};
}

}  // namespace

template <class T>
SpillTable<T>::SpillTable(const Budget& budget)
    : folder_(budget.folder), last_place_(std::bit_floor(std::max(budget.bytes / 8, kLeastBytes) / sizeof(Piece)) - 1) {}

template <class T>
void SpillTable<T>::begin_piece() {
  const uint64_t number = size_ / kPiece;
  if (number <= last_place_) places_.push_back(std::make_unique_for_overwrite<Piece>());
  Piece& place = *places_[number & last_place_];
  make_room(place);
  place.number = number;
}

template <class T>
void SpillTable<T>::load(uint64_t number, Piece& place) {
  make_room(place);
  file_->read(number * sizeof(Piece), bytes_of(place));
  if (place.number != number || place.checksum != checksum(bytes_of(place.elements)))
    throw IoError(fmt::format("{}: a temporary file has changed: its {} bytes at {} are not those that were written", folder_.string(), sizeof(Piece),
                              number * sizeof(Piece)));
}

template <class T>
void SpillTable<T>::make_room(Piece& place) {
  if (!place.changed) return;
  if (!file_) file_.emplace(folder_, sizeof(Piece));
  place.changed = false;
  place.checksum = checksum(bytes_of(place.elements));
  file_->write(place.number * sizeof(Piece), bytes_of(place));
}

template class SpillTable<Vec3>;
template class SpillTable<std::array<uint32_t, 3>>;

}  // namespace teracell::mesher
