// A channel of cells has a frame for each chunk of level 0 that it says something of (FORMAT.md, "Channels of cells"). The frames of a page
// of chunks are followed by a frame that says which chunks they belong to, and the channel ends with frames that say where these pages are.
// They name each other by their numbers in the channel's cover, so they can be copied to other places.
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <span>

#include "store/base/bytes.hpp"
#include "store/grid/metadata.hpp"

namespace teracell::inline store {

// A frame that there is not.
inline constexpr uint64_t kNoFrame = ~uint64_t{0};

// Frames of one channel: which of them belong to the chunks of a page, by slot; kNoFrame where a chunk has none.
using CellPage = std::vector<uint64_t>;

// `number` is that of the page's own frame, which comes after those of its chunks.
Bytes encode_cell_page(const CellPage& page, uint64_t number);
// Throws FormatError unless the frame is that of a page with so many chunks.
CellPage decode_cell_page(std::span<const uint8_t> frame, size_t chunks, uint64_t number);

// The pages of level 0 are listed in blocks of so many.
inline constexpr uint64_t kPagesPerList = 4096;
inline uint64_t cell_lists(uint64_t pages) { return (pages + kPagesPerList - 1) / kPagesPerList; }
Bytes encode_cell_list(std::span<const uint64_t> pages);
// Throws FormatError unless the frame lists so many pages, with frames below `frames`.
std::vector<uint64_t> decode_cell_list(std::span<const uint8_t> frame, size_t pages, uint64_t frames);

// Goes through all frames of a channel as verify() does: `frame(i)` reads frame i of the cover. Calls check(key, frame) for each chunk; null if
// it has none. Throws FormatError unless every frame belongs to one chunk, page or list.
void check_cell_frames(const Metadata& meta, const Channel& channel, const std::function<Bytes(uint64_t)>& frame,
                       const std::function<void(const ChunkKey&, const Bytes*)>& check);

// Numbers the frames of a channel while they are written. Memory: 8 bytes per page, and the open pages.
class CellFrames {
 public:
  explicit CellFrames(const Metadata& meta) : shape_(meta, 0), pages_(shape_.pages(), kNotPut) {}

  // Takes what a chunk has: the frame with that number, or kNoFrame. If this was the last chunk of its page, returns the frame of the page,
  // which must get `next`, the next number; it is empty if none of the chunks has a frame. Throws FormatError for a chunk that was put before.
  std::optional<Bytes> put(const ChunkKey& key, uint64_t number, uint64_t next);
  // A page whose chunks were put elsewhere: its frame, or kNoFrame. Throws FormatError for a page of which something was put before.
  void put_page(uint64_t page, uint64_t number);
  // The frames that list the pages, which come last. Throws FormatError when chunks are missing.
  std::vector<Bytes> lists() const;

  void save(Bytes& state) const;
  void restore(ByteReader& state);

 private:
  static constexpr uint64_t kNotPut = kNoFrame - 1;
  struct Open {
    CellPage chunks;
    size_t missing;
  };
  LevelShape shape_;
  std::vector<uint64_t> pages_;
  std::map<uint64_t, Open> open_;
  uint64_t complete_ = 0;  // pages
};

}  // namespace teracell::store
