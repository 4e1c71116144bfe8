// Facets that don't fit into memory, on disk in bins: nodes of the tree of rays that hold few enough each to be loaded
// one at a time. A facet lies in every bin that has a ray that it may meet or the place of a vertex of it; so facets that
// share a vertex share a bin, and what connects two bins are the facets that lie in both.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "mesher/tiles/rays.hpp"
#include "mesher/surface/spill.hpp"
#include "store/background.hpp"

namespace teracell {

// A facet as a bin has it.
struct BinnedFacet {
  Facet facet;     // in its file's coordinates
  uint32_t layer;  // of its body, closing.hpp
  bool at_home;    // in just one of the bins that it lies in
  bool shared;     // it lies in several
  bool added;      // its file doesn't have it: it closes a hole
  bool ignored;    // it counts for nothing
};

// Not thread-safe while it is filled; then threads may take different bins at once.
class FacetBins {
 public:
  using Move = std::function<Facet(const Facet&, uint32_t layer)>;
  // For about `facets` facets, in single precision if `float32`. `move` takes them to where the grid sees them. A bin
  // takes some sixteenth of the budget when it is loaded, so do all buffers together while bins are filled.
  // With `own_writer` a thread of its own writes to the disk. `wide` bodies as in rays.hpp.
  FacetBins(const Metadata& meta, uint64_t facets, bool float32, const Budget& budget, bool own_writer, Move move, std::vector<bool> wide);

  // Where a facet comes from: its body's file, its closing in the file's coordinates, or in the grid's.
  enum Origin { kOfFile, kAdded, kPlaced };
  void add(const Facet& facet, uint32_t layer, Origin origin);
  // When all are added. Splits the bins that are too large, as far as the tree goes.
  void finish();

  // After finish(). A node of the tree is a bin, has bins below it, or lies in a bin.
  bool is_split(const TreePlace& place) const { return !bin_at(place).children.empty(); }
  uint64_t facets(const TreePlace& place) const { return bin_at(place).facets; }
  // Calls f with the facets of a bin, each also as the grid sees it and with its rays: none where it is to be ignored. Once only.
  void take(const TreePlace& place, const std::function<void(const BinnedFacet&, const Facet& moved, const RayRange&)>& f);
  uint64_t bytes() const { return end_; }  // ever written

 private:
  struct Extent {
    uint64_t offset, bytes, checksum;
  };
  struct Bin {
    TreePlace place;
    uint64_t facets = 0;
    std::vector<uint8_t> buffer;
    std::vector<Extent> extents;
    std::vector<Bin> children;  // none or 16
  };
  const Bin& bin_at(const TreePlace& place) const;
  uint64_t bins_at(int depth) const;
  void open_children(Bin& bin) const;
  void open_leaves(Bin& bin) const;  // of all leaves
  // The tile groups of a facet's rays and vertices, inclusive.
  struct Places {
    uint32_t u0, u1, v0, v1;
  };
  Places places_of(const RayRange& rays) const;
  void put(Bin& bin, const Places& places, std::span<const uint8_t> record);
  void flush(Bin& bin);
  void split_large(Bin& bin);
  template <class F>
  void take_records(Bin& bin, F&& f);
  // A record: nine coordinates, then the layer, in which two bits tell the origin.
  static constexpr uint32_t kNotOfFile = uint32_t{1} << 31, kInPlace = uint32_t{1} << 29;
  static uint32_t layer_in(uint32_t tag) { return tag & ~(kNotOfFile | kIgnored | kInPlace); }
  Facet placed(const Facet& facet, uint32_t tag) const { return tag & kInPlace ? facet : move_(facet, layer_in(tag)); }
  void encode(const Facet& facet, uint32_t tag, std::span<uint8_t> record) const;
  Facet decode(std::span<const uint8_t> record, uint32_t& tag) const;

  RayFrame rays_;
  const bool float32_;
  const size_t record_bytes_;
  const uint64_t most_facets_;  // of a bin that is loaded
  size_t buffer_bytes_;
  const Move move_;
  SpillFile file_;
  uint64_t end_ = 0;  // of the file, with what the writer still has to write
  Bin root_;
  Background writer_;  // last: its thread uses the file
};

}  // namespace teracell
