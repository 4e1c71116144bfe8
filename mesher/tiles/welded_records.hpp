// Records of facets in fewer bytes: facets that come one after another mostly share vertices, and each vertex is kept once.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "mesher/surface/facet.hpp"
#include "store/base/populate.hpp"

namespace teracell::mesher {

// The bytes of a record: those of its three vertices, and others, which mostly are those of the record before.
struct RecordShape {
  size_t vertex, rest;  // 12 or 24; 0, 4 or 8
  size_t bytes() const { return 3 * vertex + rest; }
};

// Not thread-safe.
class RecordWelder {
 public:
  // A block takes at most a fifth more bytes than its records, and some tens.
  static constexpr size_t most_bytes(size_t of_records) { return of_records / 5 * 6 + 64; }

  explicit RecordWelder(const RecordShape& shape) : shape_(shape), latest_(kLatest) {}
  // Writes a block of these records. They are bytes without a meaning: vertices are equal when their bytes are. Equal ones may be kept twice: of
  // facets far apart, and where few facets share any.
  void weld(std::span<const uint8_t> records, UnfilledVector<uint8_t>& block);

 private:
  template <size_t kVertex>
  void weld_vertices(std::span<const uint8_t> records, UnfilledVector<uint8_t>& block);

  static constexpr int kLatestBits = 12;
  static constexpr size_t kLatest = size_t{1} << kLatestBits;
  const RecordShape shape_;
  std::vector<uint32_t> latest_;  // by a hash of the vertex, the number of the one that came last; perhaps of an earlier block, so it is a guess
  UnfilledVector<uint8_t> codes_;
  // Where facets come in no order, a block has hardly any vertex twice. After one of these, so many blocks are written without looking for such.
  static constexpr uint32_t kUnlooked = 15;
  uint32_t unlooked_ = 0;  // blocks to come
};

// Facets that come together, as a block of records that have no other bytes than their vertices. Not thread-safe.
class FacetWelder {
 public:
  static constexpr size_t kMost = 256;
  // REQUIRES: at most kMost.
  void weld(std::span<const Facet> facets);
  // Of those that came last: their vertices, each once or a few times, and which of these are a facet's.
  std::span<const Vec3> vertices() const { return std::span(vertices_).first(vertex_count_); }
  const std::array<uint16_t, 3>& vertices_of(size_t facet) const { return numbers_[facet]; }
  // Appends them as a block, in single precision if `float32`.
  void append_to(UnfilledVector<uint8_t>& blocks, bool float32) const;

 private:
  static constexpr int kLatestBits = 10;
  size_t count_ = 0, vertex_count_ = 0, code_bytes_ = 0;
  std::array<Vec3, 3 * kMost> vertices_{};
  std::array<std::array<uint16_t, 3>, kMost> numbers_;
  std::array<uint16_t, size_t{1} << kLatestBits> latest_{};  // as RecordWelder's
  std::array<uint8_t, 3 * kMost * 5> codes_;
};

// The records of a block.
class WeldedRecords {
 public:
  explicit WeldedRecords(const RecordShape& shape) : shape_(shape) {}
  // Calls f(block) with each of blocks that follow one another.
  template <class F>
  static void for_each(std::span<const uint8_t> blocks, F&& f) {
    for (size_t bytes; !blocks.empty(); blocks = blocks.subspan(bytes)) bytes = bytes_of(blocks), f(blocks.first(bytes));
  }
  static size_t bytes_of(std::span<const uint8_t> blocks);  // the first of them
  static size_t records_in(std::span<const uint8_t> block);
  // REQUIRES: the block was written by a welder. It must stay as long as its vertices are used.
  void read(std::span<const uint8_t> block);

  // The facets of the records, in place of what `out` had.
  void facets(std::vector<Facet>& out) const;

  // The other bytes of the records, if all have the same.
  std::optional<std::span<const uint8_t>> rest_of_all() const {
    return runs_.size() == 1 ? std::optional(std::span(runs_[0].rest).first(shape_.rest)) : std::nullopt;
  }
  // Appends a block of all or some of the records to `out`; there each of them has these other bytes.
  void append_all(std::span<const uint8_t> rest, UnfilledVector<uint8_t>& out) const;
  void append_some(std::span<const uint32_t> which, std::span<const uint8_t> rest, UnfilledVector<uint8_t>& out);

  size_t records() const { return vertices_.size(); }
  size_t vertices() const { return vertex_count_; }
  std::span<const uint8_t> vertex(size_t number) const { return {first_vertex_ + number * shape_.vertex, shape_.vertex}; }
  const std::array<uint32_t, 3>& vertices_of(size_t record) const { return vertices_[record]; }
  // Calls f(first, last, rest) for successive records first to last - 1 with the same other bytes.
  template <class F>
  void for_each_run(F&& f) const {
    size_t first = 0;
    for (const Run& run : runs_) f(first, first + run.records, std::span(run.rest).first(shape_.rest)), first += run.records;
  }

 private:
  struct Run {
    uint32_t records;
    std::array<uint8_t, 8> rest;
  };
  const RecordShape shape_;
  size_t vertex_count_ = 0;
  const uint8_t* first_vertex_ = nullptr;
  std::span<const uint8_t> codes_;
  std::vector<std::array<uint32_t, 3>> vertices_;  // of each record, by number
  std::vector<Run> runs_;
  UnfilledVector<uint8_t> appended_codes_;
  std::vector<uint32_t> appended_;  // of vertices: number + 1 in the block that is appended, or 0
};

}  // namespace teracell::mesher
