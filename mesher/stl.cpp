// STL, binary and ASCII. Normals are ignored: the order of the vertices says which side is out.
//
// Binary: 80 bytes of anything, a 32-bit count, then 50 bytes a facet: normal and three vertices as 12 little-endian
// float32, and two bytes of attributes. The count must agree with the size: a file cut short is no surface.
#include <algorithm>
#include <bit>
#include <utility>

#include <fmt/format.h>

#include "mesher/readers.hpp"
#include "store/error.hpp"

namespace teracell {
namespace {

constexpr uint64_t kHeader = 84, kRecord = 50;

uint32_t load32(const char* p) {
  const auto* b = reinterpret_cast<const unsigned char*>(p);
  return uint32_t{b[0]} | uint32_t{b[1]} << 8 | uint32_t{b[2]} << 16 | uint32_t{b[3]} << 24;
}

[[noreturn]] void wrong_size(const Input& input, uint64_t facets, uint64_t found, bool more) {
  const uint64_t expected = kHeader + kRecord * facets;
  throw InputError(fmt::format("{}: the header counts {} facets ({} bytes), the file has {}{}: {}", input.at_byte(80),
                               facets, expected, more ? "more than " : "", found,
                               found < expected ? "cut short, or no STL" : "bytes follow the last facet, or no STL"));
}

// One record -> one facet. A float32 that is finite is always within the limits of a coordinate.
void decode(const char* record, uint64_t number, uint64_t offset, const Input& input, Facet& facet) {
  bool finite = true;
  for (int i = 0; i < 9; ++i) {
    const uint32_t bits = load32(record + 12 + 4 * i);
    finite &= (bits & 0x7f800000) != 0x7f800000;
    facet.vertex[i / 3][i % 3] = std::bit_cast<float>(bits) + 0.0;
  }
  if (finite) return;
  for (const Vec3& v : facet.vertex)
    for (const double x : v) checked_coordinate(x, fmt::format("{}: facet {}", input.at_byte(offset), number));
}

// The words of a text one after the other, whatever the lines.
class Words {
 public:
  explicit Words(Input& input) : input_(input) {}

  // Empty at the end of the text.
  std::string_view next() {
    for (;;) {
      const std::string_view word = next_word(line_);
      if (!word.empty() || !input_.next_line(line_)) return word;
    }
  }
  std::string_view rest_of_line() { return std::exchange(line_, {}); }

  void expect(const char* keyword) {
    const std::string_view word = next();
    if (!is_keyword(word, keyword)) refuse(word, keyword);
  }
  [[noreturn]] void refuse(std::string_view word, const char* keyword) const {
    throw InputError(
        word.empty() ? fmt::format("{}: cut short: expected '{}', found the end of the file", input_.at_line(), keyword)
                     : fmt::format("{}: expected '{}', found {}", input_.at_line(), keyword, shown(word)));
  }
  double coordinate() {
    const std::string_view word = next();
    if (word.empty()) refuse(word, "a number");
    return text_coordinate<float>(word, input_);
  }

 private:
  Input& input_;
  std::string_view line_;
};

// After the word `facet`, up to its `endfacet`.
void read_ascii_facet(Words& words, Facet& facet) {
  words.expect("normal");
  for (int i = 0; i < 3; ++i)
    if (words.next().empty()) words.refuse({}, "a number");
  words.expect("outer");
  words.expect("loop");
  for (Vec3& v : facet.vertex) {
    words.expect("vertex");
    for (double& x : v) x = words.coordinate();
  }
  words.expect("endloop");
  words.expect("endfacet");
}

}  // namespace

void read_binary_stl(Input& input, FacetStream& out) {
  const bool wanted = out.wants("");
  const uint64_t facets = load32(input.window(kHeader).data() + 80);
  if (input.size() && *input.size() != kHeader + kRecord * facets) wrong_size(input, facets, *input.size(), false);
  input.consume(kHeader);
  for (uint64_t done = 0; done < facets;) {
    const std::string_view records = input.window(kRecord);
    const uint64_t whole = std::min(records.size() / kRecord, facets - done);
    if (whole == 0) wrong_size(input, facets, input.offset() + records.size(), false);
    Facet unwanted;
    for (uint64_t i = 0; i < whole; ++i)
      decode(records.data() + kRecord * i, done + i, input.offset() + kRecord * i, input,
             wanted ? out.next() : unwanted);
    input.consume(kRecord * whole);
    done += whole;
  }
  if (!input.window(1).empty()) wrong_size(input, facets, input.offset(), true);
}

void read_ascii_stl(Input& input, FacetStream& out) {
  Words words(input);
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (!is_keyword(word, "solid")) words.refuse(word, "solid");
    const bool wanted = out.wants(trimmed(words.rest_of_line()));
    Facet facet;
    for (word = words.next(); !is_keyword(word, "endsolid"); word = words.next()) {
      if (!is_keyword(word, "facet")) words.refuse(word, word.empty() ? "endsolid" : "facet");
      read_ascii_facet(words, facet);
      if (wanted) out.next() = facet;
    }
    words.rest_of_line();  // the name once more
  }
}

}  // namespace teracell
