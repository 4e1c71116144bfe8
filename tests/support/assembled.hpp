// .tcell files put together part by part, under right checksums, without cells that they came from: as small as a hostile hand would
// make them. forged.hpp changes a sound file; this needs none, so grid, chunks and index may be of any size.
#pragma once
#include <functional>
#include <map>

#include "store/format/format.hpp"
#include "store/grid/metadata.hpp"

namespace teracell::testing {

// A zstd frame of `body`, as small as zstd makes it; or, if that is more than `ratio` times smaller, about `ratio` times smaller.
Bytes squeezed(const Bytes& body, uint64_t ratio = ~uint64_t{0});

// Bytes `unit` again and again.
Bytes repeated(const Bytes& unit, size_t times);

class Assembly {
 public:
  // The levels that are stored are 0, 2, 4 ...
  explicit Assembly(Metadata meta);

  // Appends a frame; the entry of a chunk that has it. `stats` is for level 0.
  ChunkEntry chunk(const Bytes& frame, std::vector<LabelStats> stats = {});
  static ChunkEntry uniform(std::vector<Label> set = {0}) { return {0, 0, 0, std::move(set), {}}; }

  // What stands at each place. Pages that are equal are stored once, and so named by many entries of directories, unless they are to
  // have frames of their own.
  using At = std::function<ChunkEntry(const ChunkKey&)>;
  Bytes finish(const At& at, const std::string& report = "{}", uint64_t page_ratio = ~uint64_t{0});

  bool own_pages = false;
  const Metadata& meta() const { return meta_; }

 private:
  DirectoryEntry append(const Bytes& frame);
  Metadata meta_;
  Bytes out_;
  std::map<Bytes, DirectoryEntry> pages_;
};

}  // namespace teracell::testing
