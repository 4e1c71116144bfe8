// What the surface readers (mesher/formats) share: how a reader is chosen, where facets go, how words and numbers of a text are
// read. Private to the readers; others include read_facets.hpp.
#pragma once
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

#include "mesher/surface/facet.hpp"
#include "mesher/surface/input.hpp"
#include "mesher/surface/part_tree.hpp"
#include "mesher/surface/read_options.hpp"
#include "store/text/words.hpp"

namespace teracell::mesher {

inline constexpr size_t kLongestPartName = 256;  // bytes; names that are longer are cut

// Collects what a reader finds: facets for the sink, in batches, and the names of parts.
class FacetStream {
 public:
  // All must outlive it.
  FacetStream(const PartGlob& glob, const FacetSink& sink, const ReadOptions& options);
  FacetStream(const FacetStream&) = delete;

  // Records that the file, which has no tree, has this part ("": the unnamed one). Returns whether its facets are wanted.
  bool wants(std::string_view part);
  // The facets of the parts of a tree that are wanted, each part a patch, and with options.face_patches also its faces of a colour of their own.
  // Sets file.float32.
  void add_parts(PartTree& tree, SurfaceFile& file, const ReadOptions& options);
  // The facets that follow, of a file without a tree, belong to this patch ("": to the one of the body). Names are told apart by their first
  // bytes.
  void enter_patch(std::string_view name);
  // A new facet, which the caller fills in before the next call.
  Facet& next() {
    if (used_ == limit_) make_room();
    return batch_[used_++];
  }
  // One with vertices that the file names by number, from 0 on.
  void add(const Vec3& a, const Vec3& b, const Vec3& c, const std::array<uint64_t, 3>& numbers) {
    next().vertex = {a, b, c};
    if (numbers_) numbers_->push_back({vertex_number(numbers[0]), vertex_number(numbers[1]), vertex_number(numbers[2])});
  }
  // What takes blocks of facets, if that is wanted for those that follow, else null.
  const FacetBlocks* blocks(bool float32);
  // These went there.
  void add_blocks(uint64_t facets) { facets_ += facets; }
  // Adds to SurfaceFile::warnings; called once per kind of warning.
  void warn(std::string sentence) { warnings_.push_back(std::move(sentence)); }
  // Passes on the last facets and sets facets, parts and warnings of `file`. Throws InputError when there was no facet, or no
  // part matches.
  void finish(const std::string& name, SurfaceFile& file);

 private:
  static constexpr size_t kFew = 32, kMany = 4096;
  static uint32_t vertex_number(uint64_t number) { return static_cast<uint32_t>(std::min<uint64_t>(number, kNoVertexNumber)); }
  void note(const std::string& name);
  void add_by_color(PartTree& tree, const Part& part);
  void flush();
  void change_patch(std::string_view name);
  void make_room();
  void begin_patch();

  const PartGlob& glob_;
  const FacetSink& sink_;
  const std::function<void(uint32_t)>& enter_patch_;
  const FacetBlocks* const blocks_;
  std::vector<std::array<uint32_t, 3>>* const numbers_;  // null: they aren't wanted
  Facet few_[kFew];  // most files of an assembly are small
  std::unique_ptr<Facet[]> many_;
  Facet* batch_ = few_;
  size_t used_ = 0, capacity_ = kFew, limit_ = 0;  // up to the limit, next() has nothing to do; 0 before the first facet of a patch
  uint64_t facets_ = 0;
  bool matched_ = false;  // some part is wanted
  std::vector<std::string> parts_;
  std::unordered_set<std::string> known_parts_;
  uint64_t names_ = 0;       // bytes that these two take, approximately
  bool more_parts_ = false;  // the file has more parts than these two hold
  std::string patch_, raw_patch_;  // of the facets that follow; as the file has it
  std::unordered_map<std::string, uint32_t> patches_;
  std::vector<std::string> patch_names_;
  size_t patch_bytes_ = 0;  // of these names
  uint32_t entered_ = ~uint32_t{0};
  bool warned_of_patches_ = false;
  std::vector<std::string> warnings_;
};

// Throws the InputError for a pattern that matches none of a file's parts. `more`: there are more than these.
[[noreturn]] void refuse_no_match(const std::string& name, const std::string& glob, const std::vector<std::string>& parts, bool more = false);

// Turns a polygon, given vertex by vertex, into a fan of facets around its first vertex.
class Fan {
 public:
  Fan(FacetStream& out, bool wanted) : out_(out), wanted_(wanted) {}
  // `number`: of the vertex in the file.
  void add(const Vec3& v, uint64_t number) {
    if (vertices_ >= 2 && wanted_) out_.add(first_, last_, v, {first_number_, last_number_, number});
    if (vertices_++ == 0) first_ = v, first_number_ = number;
    last_ = v, last_number_ = number;
  }
  uint64_t vertices() const { return vertices_; }

 private:
  FacetStream& out_;
  const bool wanted_;
  Vec3 first_{}, last_{};
  uint64_t first_number_ = 0, last_number_ = 0, vertices_ = 0;
};

// The text up to the end of its first line. (find_first_of() makes one call per character.)
inline std::string_view first_line(std::string_view text) {
  return text.substr(0, static_cast<size_t>(std::find_if(text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }) - text.begin()));
}

// Removes the next word from the front of `line` and returns it; empty when only blanks are left.
inline std::string_view next_word(std::string_view& line) {
  const char* p = line.data();
  const char* const end = p + line.size();
  while (p != end && is_blank(*p)) ++p;
  const char* const word = p;
  while (p != end && !is_blank(*p)) ++p;
  line = {p, static_cast<size_t>(end - p)};
  return {word, static_cast<size_t>(p - word)};
}

// Whether `word`, in upper or lower case, is `keyword`, which is in lower case.
inline bool is_keyword(std::string_view word, std::string_view keyword) {
  if (word.size() != keyword.size()) return false;
  for (size_t i = 0; i < word.size(); ++i)
    if ((word[i] | 32) != keyword[i]) return false;
  return true;
}

// The word without a leading '+', which std::from_chars does not accept.
inline std::string_view without_plus(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  return word;
}

// The correctly rounded value of a number that is out of range for from_chars: an infinity, 0 or a denormal.
float round_extreme(std::string_view word, float);
double round_extreme(std::string_view word, double);
// `v` is the value of `word`. REQUIRES: !is_coordinate(v).
[[noreturn]] void refuse_coordinate(std::string_view word, double v, const Input& input);
// For a number that rounds to an infinity.
[[noreturn]] void refuse_too_large(std::string_view word, float, const Input& input);
[[noreturn]] void refuse_too_large(std::string_view word, double, const Input& input);
[[noreturn]] void refuse_number(std::string_view word, const char* expected, const Input& input);

// A word of the current line as a coordinate, rounded once, to the declared type T.
template <class T>
double text_coordinate(std::string_view word, const Input& input) {
  const std::string_view digits = without_plus(word);
  T v = 0;
  const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), v);
  if (stop != digits.data() + digits.size() || error == std::errc::invalid_argument) refuse_number(word, "a number", input);
  if (error == std::errc::result_out_of_range) {
    v = round_extreme(digits, T{});
    if (std::isinf(v)) refuse_too_large(word, v, input);
  }
  if (!is_coordinate(v)) refuse_coordinate(word, v, input);
  return v + 0.0;  // -0 is +0
}

// Appends the digits at `p` to `number`, which overflows with more than 19, and returns where they end. Eight bytes at once, without a branch for
// each: how many digits a number has can't be predicted.
inline const char* take_digits(const char* p, const char* end, uint64_t& number) {
  static constexpr uint64_t kPowers[] = {1, 10, 100, 1000, 10000, 100000, 1000000, 10000000, 100000000};
  while (end - p >= 8) {
    uint64_t bytes;
    std::memcpy(&bytes, p, 8);
    if constexpr (std::endian::native == std::endian::big) bytes = __builtin_bswap64(bytes);
    bytes ^= 0x3030303030303030;  // digits are 0 to 9 now
    const uint64_t others = ((bytes + 0x7676767676767676) | bytes) & 0x8080808080808080;  // right up to the first one
    const int digits = std::countr_zero(others) / 8;
    bytes = digits == 0 ? 0 : bytes << (64 - 8 * digits);  // so zeros lead
    bytes = bytes * 10 + (bytes >> 8);                     // pairs
    const uint64_t value = ((bytes & 0x000000FF000000FF) * 0x000F424000000064 + (bytes >> 16 & 0x000000FF000000FF) * 0x0000271000000001) >> 32;
    number = number * kPowers[digits] + value;
    p += digits;
    if (digits < 8) return p;
  }
  for (unsigned digit; p != end && (digit = static_cast<unsigned char>(*p) - unsigned{'0'}) <= 9; ++p) number = 10 * number + digit;
  return p;
}

// The number at `p`, if it is one as nearly all are: digits that make a whole number up to 2^53, perhaps with a sign and with a point between them,
// and then a blank or the end. Sets `v` to its value, rounded once, and returns where it ends; null for all others. Both the whole number and the
// power of ten are doubles, so their quotient is rounded once (Clinger, "How to Read Floating Point Numbers Accurately", 1990). This takes
// less than two thirds of the instructions of std::from_chars.
inline const char* plain_number(const char* p, const char* end, double& v) {
  static constexpr double kPowers[] = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18};
  const bool minus = p != end && *p == '-';
  p += minus;
  uint64_t number = 0;
  const char* const first = p;
  p = take_digits(p, end, number);
  const std::ptrdiff_t whole = p - first;
  std::ptrdiff_t decimals = 0;
  if (p != end && *p == '.') {
    const char* const point = p++;
    p = take_digits(p, end, number);
    decimals = p - point - 1;
    if (decimals == 0) return nullptr;
  }
  if (whole == 0 || whole + decimals > 19 || number > uint64_t{1} << 53 || (p != end && !is_blank(*p))) return nullptr;
  v = static_cast<double>(number) / kPowers[decimals];
  v = std::bit_cast<double>(std::bit_cast<uint64_t>(v) ^ uint64_t{minus} << 63);  // no branch
  return p;
}
// Half way between two floats a double may have been rounded to there, so it doesn't tell which of them is nearer. Of any other double it is known.
inline const char* plain_number(const char* p, const char* end, float& v) {
  double exact = 0;
  const char* const stop = plain_number(p, end, exact);
  if (!stop || (std::bit_cast<uint64_t>(exact) & 0x1fffffff) == 0x10000000) return nullptr;
  v = static_cast<float>(exact);
  return stop;
}

// Removes the next word of `line` and returns it as a coordinate. Nearly every word is a plain number, which takes one pass.
template <class T>
double next_coordinate(std::string_view& line, const Input& input) {
  const char* p = line.data();
  const char* const end = p + line.size();
  while (p != end && is_blank(*p)) ++p;
  T v = 0;
  const char* stop = plain_number(p, end, v);
  if (!stop) {
    const auto [at, error] = std::from_chars(p, end, v);
    if (error != std::errc{} || (at != end && !is_blank(*at))) return text_coordinate<T>(next_word(line), input);
    stop = at;
  }
  if (!is_coordinate(v)) return text_coordinate<T>(next_word(line), input);
  line = {stop, static_cast<size_t>(end - stop)};
  return v + 0.0;  // -0 is +0
}

inline int64_t text_integer(std::string_view word, const char* expected, const Input& input) {
  const std::string_view digits = without_plus(word);
  int64_t v = 0;
  const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), v);
  if (stop != digits.data() + digits.size() || error != std::errc{}) refuse_number(word, expected, input);
  return v;
}

// The beginning of a surface file, from which its format is recognised.
struct Head {
  std::string_view bytes;        // up to 64 KiB; a byte order mark of UTF-8 is left out
  std::optional<uint64_t> size;  // of the whole contents, where it is known
  bool text;                     // no byte of the first 1024 is zero, so it is no binary STL (see read_facets.cpp)
  std::string_view word;         // of a text: the first word that is not in a comment ("#")
};

// A reader's verdict on a head. kPerhaps: the reader takes the file unless other_kind() recognises it.
enum class Match { kNo, kPerhaps, kSure };

// A format. A new format is a file that defines one of these, and a line in the table of readers.hpp.
struct SurfaceReader {
  const char* name;  // of the format, in messages: "expected STL, OBJ, PLY, OFF, 3MF, glTF or STEP"; several readers may have the same
  Match (*recognises)(const Head& head);
  // Reads all of `input`, until window(1) is empty, and sets format and float32 of `file`.
  //
  // The same bytes give the same facets in the same order each time, whatever budget and helper are: a surface that is spilled is
  // read again, and what was found of its facets refers to them by their number.
  //
  // Throws InputError for what the file holds, with its name and the line or byte. What `input`, `out` and a SpillFile throw passes
  // through; so does what the sink behind `out` throws, for example when the run is interrupted.
  //
  // Runs on the thread that called read_facets(), and so does the sink. Jobs for options.helper touch neither `input` nor `out`, and
  // are finished before read() returns or throws. Several threads may read different files at once.
  void (*read)(Input& input, FacetStream& out, SurfaceFile& file, const ReadOptions& options);
  // Instead, of a format with a tree: makes the tree, and sets format, unit and factor of `file`. The rest is as above.
  PartTree (*open)(Input& input, SurfaceFile& file, const ReadOptions& options) = nullptr;
  // Of a format whose files may state a unit: the one that this file states. Reads as little as it can.
  std::string (*unit)(Input& input) = nullptr;
  // Of a format with exact surfaces, of which open() makes facets: what is known without them.
  struct Exact {
    PartTree (*outline)(Input& input, SurfaceFile& file, const ReadOptions& options) = nullptr;  // its shapes stand for facets
    std::optional<std::array<Vec3, 2>> (*box)(Input& input, const std::vector<TakenParts>& taken, const ReadOptions& options) = nullptr;
  } exact;
};

// What a file is that no reader takes, such as "a STEP file", and what to do about it. Empty when the format is unknown.
struct OtherKind {
  std::string what, advice;
};
std::optional<OtherKind> other_kind(const Head& head);

}  // namespace teracell::mesher
