// Files that lie under right checksums: a .tcell file taken apart and put together again, changed on the way. What
// damage by chance never reaches (the checksums stop it) is where a hostile file begins.
#pragma once
#include <functional>

#include "store/channels/mixed_cells.hpp"
#include "store/format/format.hpp"
#include "store/grid/metadata.hpp"

namespace teracell::testing {

enum class FilePart { kHeader, kChunk, kPage, kDirectory, kMetadata, kReport, kFooter };

// A channel of any bytes; no reader knows it unless it is called like one that is known.
struct ForgedChannel {
  std::string name;
  std::vector<Bytes> frames;
  std::string coding{}, about{};
};

struct Lies {
  // Each sees what an honest writer would write and may change it; whatever covers it is computed afterwards.
  std::function<void(int level, std::vector<ChunkEntry>&)> page;
  std::function<void(int level, std::vector<DirectoryEntry>&)> directory;
  std::function<void(const std::string& channel, std::vector<DirectoryEntry>&)> cover;
  std::function<void(Metadata&)> metadata;
  std::function<void(Footer&)> footer;
  // The plain bytes: of chunk, page, metadata and report before they are compressed; of header, directory block and
  // footer before their checksum is appended.
  std::function<void(FilePart, Bytes&)> bytes;
  std::vector<ForgedChannel> channels;  // added to the file
  uint64_t gap = 0;  // bytes behind the header that belong to nothing
};

// REQUIRES: `file` is a sound .tcell file with no channel but the labels.
Bytes forge(const Bytes& file, const Lies& lies);
// The file as one of before 3.1 is: its metadata do not tell how many cells each label has.
inline Bytes without_amounts(const Bytes& file) {
  return forge(file, {.metadata = [](Metadata& m) { m.amounts.clear(); }});
}

// What the frame of a chunk with mixed cells holds (FORMAT.md 13.5).
struct MixedFrame {
  std::string body;
  Bytes counts;
};
MixedFrame mixed_frame(std::span<const uint8_t> frame);
Bytes forge(const MixedFrame& parts);
// The same frame as programs before version 3.2 wrote it (FORMAT.md 13.2).
Bytes old_mixed_frame(const MixedCells& cells);

}  // namespace teracell::testing
