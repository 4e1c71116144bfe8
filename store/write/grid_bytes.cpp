#include "store/write/grid_bytes.hpp"

#include <algorithm>

namespace teracell::inline store {

void GridBytes::append(std::span<const uint8_t> bytes) {
  hash_.add(bytes);
  file_.append(bytes);
}

DirectoryEntry GridBytes::append_frame(std::span<const uint8_t> frame) {
  const DirectoryEntry place{file_.size(), frame.size(), checksum(frame)};
  append(frame);
  return place;
}

void GridBytes::save(Bytes& state) {
  file_.sync();
  put_fixed(state, file_.size());
  const auto hash = hash_.digest();
  state.insert(state.end(), hash.begin(), hash.end());
}

void GridBytes::restore(ByteReader& state, uint64_t first) {
  Bytes piece(1 << 20);
  for (uint64_t at = first; at < file_.size(); at += piece.size()) {
    piece.resize(std::min<uint64_t>(piece.size(), file_.size() - at));
    file_.read_kept(at, piece);
    hash_.add(piece);
  }
  if (std::ranges::equal(state.take(16), hash_.digest())) return;
  file_.abandon();
  state.fail("the partial file has other bytes than it had: it is damaged", Remedy::kFreshStart);
}

}  // namespace teracell::store
