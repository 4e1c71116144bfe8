#include "mesher/tiles/welded_records.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "mesher/closing/vertex_hash.hpp"

namespace teracell::mesher {
namespace {

// A block: this, its vertices, its runs (how many records, and their other bytes), and codes, one for each vertex of each record. 0: the next new
// vertex; 1 to 254: so many back from that; 255: its number follows, in 4 bytes.
struct Header {
  uint32_t records, vertices, runs;
  uint32_t bytes;  // of the block

  static Header of(std::span<const uint8_t> block) {
    Header out;
    std::memcpy(&out, block.data(), sizeof out);
    return out;
  }
  void put_into(uint8_t* block) const { std::memcpy(block, this, sizeof *this); }
};
constexpr uint8_t kNew = 0, kFar = 255;
constexpr size_t kMostOfCode = 1 + sizeof(uint32_t);
constexpr size_t kTelling = 64;  // records that tell whether those to come share vertices

// The code of a vertex. `next`: the number of the next new one, which may be this one. Returns where it ends.
inline uint8_t* put_code(uint8_t* to, uint32_t next, uint32_t number) {
  static_assert(kNew == 0);
  const uint32_t ago = next - number;
  *to++ = static_cast<uint8_t>(std::min<uint32_t>(ago, kFar));
  if (ago < kFar) return to;
  std::memcpy(to, &number, sizeof number);
  return to + sizeof number;
}

size_t bytes_with_one_run(size_t vertex_bytes, size_t rest, size_t codes) { return sizeof(Header) + vertex_bytes + sizeof(uint32_t) + rest + codes; }

// Writes all but the vertices of a block with one run, which has been given room.
void put_rest_of_block(UnfilledVector<uint8_t>& blocks, size_t begin, size_t records, size_t vertices, size_t vertex_bytes,
                       std::span<const uint8_t> rest, std::span<const uint8_t> codes) {
  const auto count = static_cast<uint32_t>(records);
  Header{count, static_cast<uint32_t>(vertices), 1, static_cast<uint32_t>(blocks.size() - begin)}.put_into(blocks.data() + begin);
  uint8_t* to = blocks.data() + begin + sizeof(Header) + vertex_bytes;
  std::memcpy(to, &count, sizeof count), to += sizeof count;
  if (!rest.empty()) std::memcpy(to, rest.data(), rest.size()), to += rest.size();
  std::memcpy(to, codes.data(), codes.size());
}

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
  codes_.resize(3 * count * kMostOfCode);
  const uint8_t* const first = block.data() + sizeof(Header);
  const bool looks = unlooked_ == 0;
  uint8_t *next = block.data() + sizeof(Header), *code = codes_.data();
  uint32_t vertices = 0;
  for (const uint8_t* record = records.data(); record != records.data() + records.size(); record += each)
    for (int i = 0; i < 3; ++i) {
      const uint8_t* const vertex = record + i * kVertex;
      uint32_t& latest = latest_[looks ? hash<kVertex>(vertex) >> (64 - kLatestBits) : 0];
      if (looks && latest < vertices && are_equal<kVertex>(first + latest * kVertex, vertex)) {
        code = put_code(code, vertices, latest);
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
  Header header{static_cast<uint32_t>(count), vertices, 0, 0};
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
  block.insert(block.end(), codes_.data(), code);
  header.bytes = static_cast<uint32_t>(block.size());
  header.put_into(block.data());
}

void RecordWelder::weld(std::span<const uint8_t> records, UnfilledVector<uint8_t>& block) {
  if (shape_.vertex == 12) weld_vertices<12>(records, block);
  else weld_vertices<24>(records, block);
}

// (Without branches that depend on the vertices it took a tenth longer.)
void FacetWelder::weld(std::span<const Facet> facets) {
  const auto bits = [](const Vec3& v) { return std::bit_cast<std::array<uint64_t, 3>>(v); };
  uint32_t vertices = 0;
  uint8_t* code = codes_.data();
  for (size_t f = 0; f < facets.size(); ++f)
    for (size_t i = 0; i < 3; ++i) {
      const Vec3& vertex = facets[f].vertex[i];
      const auto [x, y, z] = bits(vertex);
      uint16_t& latest = latest_[(x * kHashKeys[0] + y * kHashKeys[1] + z * kHashKeys[2]) >> (64 - kLatestBits)];
      const auto [a, b, c] = bits(vertices_[latest]);
      if (latest < vertices && a == x && b == y && c == z) {
        code = put_code(code, vertices, latest);
        numbers_[f][i] = latest;
        continue;
      }
      vertices_[vertices] = vertex;
      numbers_[f][i] = latest = static_cast<uint16_t>(vertices++);
      *code++ = kNew;
    }
  count_ = facets.size(), vertex_count_ = vertices, code_bytes_ = static_cast<size_t>(code - codes_.data());
}

void FacetWelder::append_to(UnfilledVector<uint8_t>& blocks, bool float32) const {
  const size_t vertex_bytes = 3 * vertex_count_ * (float32 ? sizeof(float) : sizeof(double)), before = blocks.size();
  const std::span codes = std::span(codes_).first(code_bytes_);
  blocks.resize(before + bytes_with_one_run(vertex_bytes, 0, codes.size()));
  uint8_t* to = blocks.data() + before + sizeof(Header);
  if (!float32) std::memcpy(to, vertices_.data(), vertex_bytes);
  else
    for (const Vec3& v : vertices()) {
      const std::array<float, 3> single = {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
      std::memcpy(to, &single, sizeof single), to += sizeof single;
    }
  put_rest_of_block(blocks, before, count_, vertex_count_, vertex_bytes, {}, codes);
}

size_t WeldedRecords::bytes_of(std::span<const uint8_t> blocks) { return Header::of(blocks).bytes; }
size_t WeldedRecords::records_in(std::span<const uint8_t> block) { return Header::of(block).records; }

void WeldedRecords::read(std::span<const uint8_t> block) {
  const Header header = Header::of(block);
  first_vertex_ = block.data() + sizeof header;
  vertex_count_ = header.vertices;
  const uint8_t* from = first_vertex_ + vertex_count_ * shape_.vertex;
  runs_.resize(header.runs);
  for (Run& run : runs_) {
    std::memcpy(&run.records, from, sizeof run.records);
    std::memcpy(run.rest.data(), from + sizeof run.records, shape_.rest);
    from += sizeof run.records + shape_.rest;
  }
  codes_ = block.subspan(static_cast<size_t>(from - block.data()));
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

void WeldedRecords::append_all(std::span<const uint8_t> rest, UnfilledVector<uint8_t>& out) const {
  const size_t before = out.size(), vertex_bytes = vertex_count_ * shape_.vertex;
  out.resize(before + bytes_with_one_run(vertex_bytes, rest.size(), codes_.size()));
  std::memcpy(out.data() + before + sizeof(Header), first_vertex_, vertex_bytes);
  put_rest_of_block(out, before, records(), vertex_count_, vertex_bytes, rest, codes_);
}

void WeldedRecords::append_some(std::span<const uint32_t> which, std::span<const uint8_t> rest, UnfilledVector<uint8_t>& out) {
  const size_t before = out.size();
  out.resize(before + sizeof(Header) + 3 * which.size() * shape_.vertex);
  uint8_t* to = out.data() + before + sizeof(Header);
  appended_.assign(vertex_count_, 0);
  appended_codes_.resize(3 * which.size() * kMostOfCode);
  uint8_t* code = appended_codes_.data();
  uint32_t vertices = 0;
  for (const uint32_t record : which)
    for (const uint32_t vertex : vertices_[record]) {
      uint32_t& appended = appended_[vertex];
      const bool is_new = appended == 0;
      if (is_new) std::memcpy(to, first_vertex_ + vertex * shape_.vertex, shape_.vertex), to += shape_.vertex, appended = vertices + 1;
      code = put_code(code, vertices, appended - 1);
      vertices += is_new;
    }
  const std::span<const uint8_t> codes(appended_codes_.data(), code);
  const size_t vertex_bytes = vertices * shape_.vertex;
  out.resize(before + bytes_with_one_run(vertex_bytes, rest.size(), codes.size()));
  put_rest_of_block(out, before, which.size(), vertices, vertex_bytes, rest, codes);
}

void WeldedRecords::facets(std::vector<Facet>& out) const {
  const auto fill = [&]<class T>(T) {
    for (size_t i = 0; i < records(); ++i)
      for (size_t k = 0; k < 3; ++k) {
        std::array<T, 3> vertex;
        std::memcpy(vertex.data(), first_vertex_ + vertices_[i][k] * sizeof vertex, sizeof vertex);
        out[i].vertex[k] = {vertex[0], vertex[1], vertex[2]};
      }
  };
  out.resize(records());
  if (shape_.vertex == 3 * sizeof(float)) fill(float());
  else fill(double());
}

}  // namespace teracell::mesher
