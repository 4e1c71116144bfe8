// STL, binary and ASCII. Normals are ignored: the order of the vertices tells which side is outside.
//
// Binary: 80 arbitrary bytes, a 32-bit count, then 50 bytes per facet: the normal and three vertices as 12 little-endian
// float32, and two bytes of attributes. A file that is shorter than its count implies is refused; bytes after the last facet are
// skipped.
//
// ASCII: a sequence of words; line breaks mean nothing. A line that begins with none of the words of STL, such as
// `color 1 0 0`, is skipped, and a solid may lack its `endsolid`. A facet must be complete.
#include <algorithm>
#include <bit>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "mesher/surface/readers.hpp"
#include "store/base/error.hpp"
#include "store/base/in_order.hpp"
#include "store/base/system/vector_units.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {
namespace {

using namespace std::string_view_literals;

constexpr uint64_t kHeader = 84, kRecord = 50;

uint32_t load32(const char* p) {
  const auto* b = reinterpret_cast<const unsigned char*>(p);
  return uint32_t{b[0]} | uint32_t{b[1]} << 8 | uint32_t{b[2]} << 16 | uint32_t{b[3]} << 24;
}

uint64_t counted_facets(std::string_view head) { return load32(head.data() + 80); }

[[noreturn]] void cut_short(const Input& input, uint64_t facets, uint64_t found) {
  throw InputError(fmt::format("{}: the header counts {} facets ({} bytes), the file has {}: cut short, or not an STL file", input.at_byte(80),
                               facets, kHeader + kRecord * facets, found));
}

// Decodes one record. A finite float32 is always a coordinate: its magnitude is within the limits.
void decode(const char* record, uint64_t number, uint64_t offset, const Input& input, Facet& facet) {
  bool finite = true;
  for (int i = 0; i < 9; ++i) {
    const uint32_t bits = load32(record + 12 + size_t{4} * i);
    finite &= (bits & 0x7f800000) != 0x7f800000;
    facet.vertex[i / 3][i % 3] = std::bit_cast<float>(bits) + 0.0;
  }
  if (finite) return;
  for (const Vec3& v : facet.vertex)
    for (const double x : v) checked_coordinate(x, fmt::format("{}: facet {}", input.at_byte(offset), number));
}

// Decodes some records with eight coordinates side by side, to where next() says, and returns true; or returns false where a coordinate is not
// finite, or where numbers are not in the file's order of bytes.
template <class Next>
bool decode_side_by_side(const char* records, size_t count, const Next& next) {
  if constexpr (std::endian::native != std::endian::little) return false;
  using Floats [[gnu::vector_size(32)]] = float;
  using Bits [[gnu::vector_size(32)]] = int32_t;
  using Doubles [[gnu::vector_size(64)]] = double;
  constexpr int32_t kExponent = 0x7f800000;
  bool finite = true;
  on_vector_unit([&]() TERACELL_IN_LINE {
    Bits infinite{};
    int32_t last_infinite = 0;
    for (size_t i = 0; i < count; ++i) {
      Bits bits;
      int32_t last;
      __builtin_memcpy(&bits, records + kRecord * i + 12, sizeof bits), __builtin_memcpy(&last, records + kRecord * i + 44, sizeof last);
      infinite |= (bits & kExponent) == kExponent;
      last_infinite |= (last & kExponent) == kExponent;
    }
    for (int i = 0; i < 8; ++i) last_infinite |= infinite[i];
    finite = last_infinite == 0;
    for (size_t i = 0; finite && i < count; ++i) {
      Floats floats;
      float last;
      __builtin_memcpy(&floats, records + kRecord * i + 12, sizeof floats), __builtin_memcpy(&last, records + kRecord * i + 44, sizeof last);
      const Doubles doubles = __builtin_convertvector(floats, Doubles) + 0.0;
      Facet& facet = next();
      __builtin_memcpy(&facet, &doubles, sizeof doubles);
      facet.vertex[2][2] = last + 0.0;
    }
  });
  return finite;
}

// Decodes the records of facets `first` to first + count - 1, of which the first begins at `offset` of the file.
template <class Next>
void decode_all(const char* records, size_t count, uint64_t first, uint64_t offset, const Input& input, const Next& next) {
  if (decode_side_by_side(records, count, next)) return;
  for (uint64_t i = 0; i < count; ++i) decode(records + kRecord * i, first + i, offset + kRecord * i, input, next());
}

// The words of a text, one after the other, across lines.
class Words {
 public:
  explicit Words(Input& input) : input_(input) {}

  // Empty at the end of the text.
  std::string_view next() {
    for (;;) {
      const std::string_view word = next_word(line_);
      if (!word.empty() || !input_.next_line(line_)) return word;
      begin_ = line_.data();
    }
  }

  void expect(std::string_view keyword) {
    const std::string_view word = next();
    if (!is_keyword(word, keyword)) [[unlikely]]
      skip_lines(word, keyword);
  }
  [[gnu::cold]] void skip_lines(std::string_view word, std::string_view expected) {
    for (; !is_keyword(word, expected); word = next()) skip_line(word, expected);
  }
  // For a `word`, the last one taken, that is not what was expected. If it begins its line and is no word of STL, skips the line;
  // otherwise throws.
  [[gnu::cold]] void skip_line(std::string_view word, std::string_view expected) {
    if (word.empty() || is_of_stl(word) || !trimmed({begin_, static_cast<size_t>(word.data() - begin_)}).empty()) refuse(word, expected);
    const std::string_view line = trimmed({word.data(), word.size() + line_.size()});
    if (skipped_++ == 0) first_skipped_ = fmt::format("line {}, {}", input_.line(), shown(line));
    if (since_facet_.empty()) since_facet_ = fmt::format("line {}, {}", input_.line(), shown(line));
    line_ = {};
  }
  [[noreturn]] void refuse(std::string_view word, std::string_view keyword) const {
    const std::string skipped = since_facet_.empty() ? "" : fmt::format(" ({}, was skipped)", since_facet_);
    throw InputError(word.empty() ? fmt::format("{}: cut short: expected '{}', found the end of the file{}", input_.at_line(), keyword, skipped)
                                  : fmt::format("{}: expected '{}', found {}{}", input_.at_line(), keyword, shown(word), skipped));
  }
  void facet_is_complete() { since_facet_.clear(); }

  // After `solid`: the rest of the line, or the part of it before a facet.
  std::string_view solid_name() {
    const std::string_view name = line_.substr(0, next_facet());
    line_.remove_prefix(name.size());
    return trimmed(name);
  }
  // After `endsolid`: skips the name, which is given again. The next solid may follow on the same line.
  void skip_name(std::string_view name) {
    line_ = trimmed(line_);
    const size_t facet = next_facet();
    if (facet == line_.size()) {
      line_ = {};
      return;
    }
    if (line_.substr(0, facet).starts_with(name)) line_.remove_prefix(name.size());
    for (std::string_view rest = line_; !rest.empty(); line_ = rest)
      if (const std::string_view word = next_word(rest); is_keyword(word, "solid") || is_keyword(word, "facet")) return;
  }
  double coordinate() {
    line_ = trimmed(line_);
    if (!line_.empty()) return next_coordinate<float>(line_, input_);
    const std::string_view word = next();
    if (word.empty()) refuse(word, "a number");
    return text_coordinate<float>(word, input_);
  }

  void warn(FacetStream& out) const {
    if (skipped_ == 1) out.warn(fmt::format("a line that is not STL was skipped: {}", first_skipped_));
    if (skipped_ > 1) out.warn(fmt::format("{} lines that are not STL were skipped, the first is {}", skipped_, first_skipped_));
  }

 private:
  static bool is_of_stl(std::string_view word) {
    for (const char* known : {"solid", "facet", "normal", "outer", "loop", "vertex", "endloop", "endfacet", "endsolid"})
      if (is_keyword(word, known)) return true;
    const bool cut_off =
        word.size() < 5 && is_keyword(word, "facet"sv.substr(0, word.size()));  // a beginning of `facet`: the end of a file that is cut short
    const size_t digit = word.find_first_not_of("+-.");
    return cut_off || (digit != std::string_view::npos && word[digit] >= '0' && word[digit] <= '9');
  }
  static bool is_number(std::string_view word) {
    float v = 0;
    word = without_plus(word);
    return std::from_chars(word.data(), word.data() + word.size(), v).ec != std::errc::invalid_argument;
  }
  // Where a facet begins on the rest of the line: `facet normal` and a number. The length of the rest when no facet does, or
  // when it comes only after thousands of characters.
  size_t next_facet() const {
    constexpr size_t kLongestName = 4096;
    std::string_view rest = line_.substr(0, kLongestName);
    while (!rest.empty()) {
      const std::string_view word = next_word(rest);
      std::string_view ahead = rest;
      if (is_keyword(word, "facet") && is_keyword(next_word(ahead), "normal") && is_number(next_word(ahead)))
        return static_cast<size_t>(word.data() - line_.data());
    }
    return line_.size();
  }

  Input& input_;
  std::string_view line_;
  const char* begin_ = nullptr;  // of the whole line
  uint64_t skipped_ = 0;         // lines
  std::string first_skipped_, since_facet_;  // the first of them, and the first one since the last complete facet
};

// Reads from after the word `facet` to its `endfacet`.
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
  words.facet_is_complete();
}

// The size decides: many binary files begin with "solid", too.
Match recognises_binary(const Head& head) {
  if (head.bytes.size() < kHeader) return Match::kNo;
  if (head.size == kHeader + kRecord * counted_facets(head.bytes)) return Match::kSure;
  return head.text ? Match::kNo : Match::kPerhaps;
}

void skip_rest(Input& input, FacetStream& out, uint64_t facets) {
  uint64_t bytes = 0;
  for (size_t some; (some = input.window(1).size()) > 0; bytes += some) input.consume(some);
  if (bytes > 0 && facets == 0)
    throw InputError(
        fmt::format("{}: the header counts 0 facets, but {} bytes follow: the count is wrong, or this is not an STL file", input.at_byte(80), bytes));
  if (bytes > 0)
    out.warn(fmt::format("{} after the last facet {} skipped{}", plural(bytes, "byte"), bytes == 1 ? "was" : "were",
                         bytes % kRecord == 0 ? fmt::format(", as many as {} take{}: the header's count of {} may be wrong",
                                                            plural(bytes / kRecord, "facet"), bytes == kRecord ? "s" : "", facets)
                                              : ""));
}

// Whoever reads the next block of records also decodes it, while another thread reads the one after it. Returns how many bytes of records there were.
// (With 2048 facets in a block, and results of two per thread waiting, threads slept for an eighth of the time.)
uint64_t read_blocks(Input& input, uint64_t facets, const FacetBlocks& blocks) {
  struct Block {
    std::vector<char> records;
    uint64_t first, offset;
  };
  std::mutex mutex;
  std::vector<std::vector<char>> spare;
  uint64_t done = 0, bytes = 0;
  std::exception_ptr later;  // thrown while a block was read that has facets nevertheless
  const auto next = [&]() -> std::optional<Block> {
    if (later) std::rethrow_exception(later);
    if (done == facets || bytes < kRecord * done) return std::nullopt;
    Block block{{}, done, input.offset()};
    {
      std::lock_guard lock(mutex);
      if (!spare.empty()) block.records = std::move(spare.back()), spare.pop_back();
    }
    const uint64_t count = std::min<uint64_t>(FacetBlocks::kFacets, facets - done);
    block.records.resize(kRecord * count);
    size_t got = 0;
    try {
      input.take(block.records, got);
    } catch (...) {
      if (got < kRecord) throw;
      later = std::current_exception();
    }
    done += count, bytes += got;
    block.records.resize(got / kRecord * kRecord);
    return block;
  };
  const auto make = [&](Block block, int worker) {
    std::array<Facet, FacetBlocks::kSome> room;
    const size_t count = block.records.size() / kRecord;
    size_t decoded = 0;
    auto then = blocks.take(
        [&] {
          const size_t from = std::exchange(decoded, std::min(decoded + room.size(), count));
          Facet* to = room.data();
          decode_all(block.records.data() + kRecord * from, decoded - from, block.first + from, block.offset + kRecord * from, input,
                     [&to]() -> Facet& { return *to++; });
          return std::span<const Facet>(room).first(decoded - from);
        },
        worker);
    std::lock_guard lock(mutex);
    spare.push_back(std::move(block.records));
    return then;
  };
  in_order(
      blocks.threads, next, make, [](const std::function<void()>& then) { then(); }, blocks.ahead, blocks.idle);
  return bytes;
}

void read_binary(Input& input, FacetStream& out, SurfaceFile& file, const ReadOptions& options) {
  file.format = "STL (binary)";
  const bool wanted = out.wants("");
  const uint64_t facets = counted_facets(input.window(kHeader));
  if (input.size() && *input.size() < kHeader + kRecord * facets) cut_short(input, facets, *input.size());
  options.expect(facets);
  input.consume(kHeader);
  constexpr uint64_t kWorthThreads = 4 * FacetBlocks::kFacets;
  if (const FacetBlocks* blocks = wanted && facets >= kWorthThreads ? out.blocks(file.float32) : nullptr) {
    if (const uint64_t bytes = read_blocks(input, facets, *blocks); bytes < kRecord * facets) cut_short(input, facets, kHeader + bytes);
    out.add_blocks(facets);
    return skip_rest(input, out, facets);
  }
  for (uint64_t done = 0; done < facets;) {
    const std::string_view records = input.window(kRecord);
    const uint64_t whole = std::min(records.size() / kRecord, facets - done);
    if (whole == 0) cut_short(input, facets, input.offset() + records.size());
    Facet unwanted;
    constexpr uint64_t kAtOnce = 64;
    for (uint64_t first = 0; first < whole; first += kAtOnce)
      decode_all(records.data() + kRecord * first, std::min(kAtOnce, whole - first), done + first, input.offset() + kRecord * first, input,
                 [&]() -> Facet& { return wanted ? out.next() : unwanted; });
    input.consume(kRecord * whole);
    done += whole;
  }
  skip_rest(input, out, facets);
}

Match recognises_ascii(const Head& head) { return head.text && is_keyword(head.word, "solid") ? Match::kPerhaps : Match::kNo; }

void read_ascii(Input& input, FacetStream& out, SurfaceFile& file, const ReadOptions&) {
  file.format = "STL (ASCII)";
  Words words(input);
  std::string name;
  uint64_t unended = 0;  // solids that another solid follows without an `endsolid`
  bool inside = false, has_facet = false, wanted = false;  // of the current solid
  Facet facet;
  for (;;) {
    const std::string_view word = words.next();
    if (inside && is_keyword(word, "facet")) {
      read_ascii_facet(words, facet);
      if (wanted) out.next() = facet;
      has_facet = true;
    } else if (is_keyword(word, "solid")) {
      unended += inside;
      name = words.solid_name();
      wanted = out.wants(name);
      out.enter_patch(name);
      inside = true, has_facet = false;
    } else if (inside && is_keyword(word, "endsolid")) {
      words.skip_name(name);
      inside = false;
    } else if (word.empty() && (!inside || has_facet)) break;
    else words.skip_line(word, inside ? "facet" : "solid");
  }
  words.warn(out);
  if (unended > 0)
    out.warn(fmt::format("{} 'endsolid' before the next", unended == 1 ? "1 solid lacks its" : fmt::format("{} solids lack their", unended)));
  if (inside) out.warn("the file ends without 'endsolid': it may be cut short");
}

}  // namespace

const SurfaceReader kBinaryStlReader = {"STL", recognises_binary, read_binary};
const SurfaceReader kAsciiStlReader = {"STL", recognises_ascii, read_ascii};

}  // namespace teracell::mesher
