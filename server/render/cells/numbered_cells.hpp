// What the cells of a grid hold, as the numbers that a numbering gives to sets of labels. Each thread has its own.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "store/read/reader.hpp"

namespace teracell::server {

// REQUIRES of a numbering: of() a label and of() a set are numbers; shows_damage(), and kDamaged is the number of what can't be read.
template <class Numbering>
class NumberedCells {
 public:
  // Keeps references.
  NumberedCells(const GridReader& reader, Numbering& numbering) : reader_(reader), numbering_(numbering), frame_(reader.meta().frame()) {
    for (int level = 0; level < reader.levels(); ++level) shapes_.push_back(reader.shape(level));
    last_.resize(shapes_.size());
  }

  uint32_t at(int level, const Index3& cell) {
    const Place p = place(level, cell);
    if (!p.known.chunk) return p.known.all;
    const SetId set = p.known.chunk->rays.set_at(p.ray, p.at);
    const uint32_t labels = p.known.chunk->sets.labels();
    return set < labels ? numbering_.of(Label{set}) : p.known.of_sets[set - labels];
  }
  // REQUIRES: the cell can be read.
  std::vector<Label> labels(int level, const Index3& cell) {
    const Place p = place(level, cell);
    return p.known.chunk ? p.known.chunk->sets.members(p.known.chunk->rays.set_at(p.ray, p.at)) : p.known.set;
  }

 private:
  static constexpr size_t kKept = 256;  // chunks that a thread finds without asking others

  // What is known of a chunk: its cells, or the set of all of them.
  struct Known {
    ChunkKey key{-1, 0, 0, 0};
    std::shared_ptr<const Chunk> chunk;
    uint32_t all = 0;                // the number, when there is no chunk
    std::vector<uint32_t> of_sets;   // the numbers of those of several labels
    std::vector<Label> set;          // when there is no chunk
  };
  struct Place {
    const Known& known;
    uint32_t ray, at;  // of the chunk
  };

  Place place(int level, const Index3& cell) {
    const LevelShape& shape = shapes_[static_cast<size_t>(level)];
    const auto u = static_cast<uint32_t>(cell[frame_.u]), v = static_cast<uint32_t>(cell[frame_.v]), w = static_cast<uint32_t>(cell[frame_.w]);
    const uint32_t cu = u / shape.chunk_rays, cv = v / shape.chunk_rays, segment = w / shape.chunk_cells;
    const Known& chunk = known({level, cu, cv, segment});
    return {chunk, (v - cv * shape.chunk_rays) * shape.rays_u(cu) + (u - cu * shape.chunk_rays), w - segment * shape.chunk_cells};
  }

  const Known& known(const ChunkKey& key) {
    size_t& last = last_[static_cast<size_t>(key.level)];
    if (kept_[last].key == key) return kept_[last];
    last = ChunkKeyHash()(key) % kept_.size();
    Known& out = kept_[last];
    if (out.key == key) return out;
    out = Known{};
    try {
      if (const auto set = reader_.uniform(key)) {
        out.all = numbering_.of(*set);
        out.set = *set;
      } else {
        out.chunk = reader_.chunk(key, scratch_);
        scratch_.reset();  // without a keeper it would be overwritten
        const SetTable& sets = out.chunk->sets;
        for (uint32_t id = sets.labels(); id < sets.ids(); ++id) out.of_sets.push_back(numbering_.of(sets.members(id)));
      }
    } catch (const FormatError&) {
      if (!numbering_.shows_damage()) throw;
      out = Known{};
      out.all = Numbering::kDamaged;
    }
    out.key = key;  // last, so that an error leaves nothing
    return out;
  }

  const GridReader& reader_;
  Numbering& numbering_;
  const RayFrame frame_;
  std::vector<LevelShape> shapes_;
  std::vector<Known> kept_ = std::vector<Known>(kKept);
  std::vector<size_t> last_;  // of each level, in kept_
  std::shared_ptr<Chunk> scratch_;
};

}  // namespace teracell::server
