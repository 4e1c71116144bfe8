#include "mesher/tiles/welded_records.hpp"

#include <cstring>

#include "mesher/closing/vertex_hash.hpp"

namespace teracell::mesher {
namespace {

// A block: this, its vertices, its runs (how many records, and their other bytes), and codes, one for each vertex of each record. 0: the next new
// vertex; 1 to 254: so many back from that; 255: its number follows, in 4 bytes.
struct Header {
  uint32_t records, vertices, runs;
};
constexpr uint8_t kNew = 0, kFar = 255;
constexpr size_t kTelling = 64;  // records that tell whether those to come share vertices

template <size_t kBytes>
uint64_t hash(const uint8_t* vertex) {
  uint64_t out = 0, word;
  for (size_t at = 0; at + 8 <= kBytes; at += 8) {
    std::memcpy(&word, vertex + at, 8);
    out += word * kHashKeys[at / 8];
  }
  if constexpr (kBytes % 8 != 0) {
    uint32_t last;
    std::memcpy(&last, vertex + kBytes - 4, 4);
    out += last * kHashKeys[3];
  }
  return out;
}

// (For memcmp() a library was called.)
template <size_t kBytes>
bool are_equal(const uint8_t* a, const uint8_t* b) {
  uint64_t x, y;
  for (size_t at = 0; at + 8 <= kBytes; at += 8) {
    std::memcpy(&x, a + at, 8), std::memcpy(&y, b + at, 8);
    if (x != y) return false;
  }
  if constexpr (kBytes % 8 == 0) return true;
  uint32_t s, t;
  std::memcpy(&s, a + kBytes - 4, 4), std::memcpy(&t, b + kBytes - 4, 4);
  return s == t;
}

}  // namespace

template <size_t kVertex>
void RecordWelder::weld_vertices(std::span<const uint8_t> records, UnfilledVector<uint8_t>& block) {
  const size_t each = shape_.bytes(), count = records.size() / each, run_bytes = sizeof(uint32_t) + shape_.rest;
  block.resize(sizeof(Header) + 3 * count * kVertex);
  codes_.resize(3 * count * 5);
  const uint8_t* const first = block.data() + sizeof(Header);
  const bool looks = unlooked_ == 0;
  uint8_t *next = block.data() + sizeof(Header), *code = codes_.data();
  uint32_t vertices = 0;
  for (const uint8_t* record = records.data(); record != records.data() + records.size(); record += each)
    for (int i = 0; i < 3; ++i) {
      const uint8_t* const vertex = record + i * kVertex;
      uint32_t& latest = latest_[looks ? hash<kVertex>(vertex) >> (64 - kLatestBits) : 0];
      if (looks && latest < vertices && are_equal<kVertex>(first + latest * kVertex, vertex)) {
        const uint32_t ago = vertices - latest;
        *code++ = ago < kFar ? static_cast<uint8_t>(ago) : kFar;
        if (ago < kFar) continue;
        std::memcpy(code, &latest, sizeof latest);
        code += sizeof latest;
        continue;
      }
      std::memcpy(next, vertex, kVertex);
      next += kVertex;
      *code++ = kNew;
      latest = vertices++;
    }
  if (!looks) --unlooked_;
  else if (count >= kTelling && vertices > count * 11 / 4) unlooked_ = kUnlooked;
  block.resize(static_cast<size_t>(next - block.data()));
  Header header{static_cast<uint32_t>(count), vertices, 0};
  for (size_t from = 0; from < count; ++header.runs) {
    const auto rest = [&](size_t record) { return records.data() + record * each + 3 * kVertex; };
    uint32_t run = 1;
    while (from + run < count && std::memcmp(rest(from), rest(from + run), shape_.rest) == 0) ++run;
    const size_t at = block.size();
    block.resize(at + run_bytes);
    std::memcpy(block.data() + at, &run, sizeof run);
    std::memcpy(block.data() + at + sizeof run, rest(from), shape_.rest);
    from += run;
  }
  std::memcpy(block.data(), &header, sizeof header);
  block.insert(block.end(), codes_.data(), code);
}

void RecordWelder::weld(std::span<const uint8_t> records, UnfilledVector<uint8_t>& block) {
  if (shape_.vertex == 12) weld_vertices<12>(records, block);
  else weld_vertices<24>(records, block);
}

void WeldedRecords::read(std::span<const uint8_t> block) {
  Header header;
  std::memcpy(&header, block.data(), sizeof header);
  first_vertex_ = block.data() + sizeof header;
  vertex_count_ = header.vertices;
  const uint8_t* from = first_vertex_ + vertex_count_ * shape_.vertex;
  runs_.resize(header.runs);
  for (Run& run : runs_) {
    std::memcpy(&run.records, from, sizeof run.records);
    std::memcpy(run.rest.data(), from + sizeof run.records, shape_.rest);
    from += sizeof run.records + shape_.rest;
  }
  vertices_.resize(header.records);
  uint32_t next = 0;
  for (std::array<uint32_t, 3>& of : vertices_)
    for (uint32_t& number : of) {
      const uint8_t code = *from++;
      number = next - code;
      next += code == kNew;
      if (code != kFar) continue;
      std::memcpy(&number, from, sizeof number);
      from += sizeof number;
    }
}

}  // namespace teracell::mesher
