// What the surface readers (stl, obj, ply) share: how one is chosen, where facets go, words and numbers of a text.
// Private to the mesher; users include facets.hpp.
#pragma once
#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <string_view>
#include <unordered_set>

#include "mesher/facets.hpp"
#include "mesher/input.hpp"

namespace teracell {

// Collects what a reader finds: facets for the sink, in batches, and the names of parts.
class FacetStream {
 public:
  // Both must outlive it.
  FacetStream(const std::string& glob, const FacetSink& sink);
  FacetStream(const FacetStream&) = delete;

  // Notes a part of the file ("" is the unnamed one): are its facets wanted?
  bool wants(std::string_view part);
  // A new facet, to be filled in before the next call.
  Facet& next() {
    if (used_ == capacity_) make_room();
    return batch_[used_++];
  }
  void add(const Vec3& a, const Vec3& b, const Vec3& c) { next().vertex = {a, b, c}; }
  // For SurfaceFile::warnings; once for each kind of thing.
  void warn(std::string sentence) { warnings_.push_back(std::move(sentence)); }
  // Hands on the last facets and fills in facets, parts and warnings. Throws InputError when there was no facet or no such part.
  void finish(const std::string& name, SurfaceFile& file);

 private:
  static constexpr size_t kFew = 32, kMany = 4096;
  void note(const std::string& name);
  void flush();
  void make_room();

  const std::string& glob_;
  const FacetSink& sink_;
  Facet few_[kFew];  // most files of an assembly are small
  std::unique_ptr<Facet[]> many_;
  Facet* batch_ = few_;
  size_t used_ = 0, capacity_ = kFew;
  uint64_t facets_ = 0;
  bool matched_ = false;  // some part is wanted
  std::vector<std::string> parts_;
  std::unordered_set<std::string> known_parts_;
  uint64_t names_ = 0;       // bytes that these two take, about
  bool more_parts_ = false;  // than they hold
  std::vector<std::string> warnings_;
};

// A polygon as a fan from its first vertex, one vertex after the other.
class Fan {
 public:
  Fan(FacetStream& out, bool wanted) : out_(out), wanted_(wanted) {}
  void add(const Vec3& v) {
    if (vertices_ >= 2 && wanted_) out_.add(first_, last_, v);
    if (vertices_++ == 0) first_ = v;
    last_ = v;
  }
  uint64_t vertices() const { return vertices_; }

 private:
  FacetStream& out_;
  const bool wanted_;
  Vec3 first_{}, last_{};
  uint64_t vertices_ = 0;
};

inline bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

// Up to the end of the first line. (find_first_of() makes a call for every character.)
inline std::string_view first_line(std::string_view text) {
  return text.substr(0, static_cast<size_t>(std::find_if(text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }) - text.begin()));
}

// Cuts the next word off the front of `line`; empty when only blanks are left.
inline std::string_view next_word(std::string_view& line) {
  const char* p = line.data();
  const char* const end = p + line.size();
  while (p != end && is_blank(*p)) ++p;
  const char* const word = p;
  while (p != end && !is_blank(*p)) ++p;
  line = {p, static_cast<size_t>(end - p)};
  return {word, static_cast<size_t>(p - word)};
}

// `keyword` in lower case, `word` in any.
inline bool is_keyword(std::string_view word, std::string_view keyword) {
  if (word.size() != keyword.size()) return false;
  for (size_t i = 0; i < word.size(); ++i)
    if ((word[i] | 32) != keyword[i]) return false;
  return true;
}

// "1 facet", "2 facets".
std::string plural(uint64_t n, const char* what);

// Without blanks around it.
std::string_view trimmed(std::string_view text);
// Text from a file as a message may show it: quoted, cut to a few dozen characters, printable.
std::string shown(std::string_view text);

// Predicates stay exact within these limits (facets.hpp).
inline bool is_coordinate(double v) {
  const double size = std::abs(v);
  return v == 0 || (size >= 1e-75 && size <= 1e75);
}

// std::from_chars takes no '+'.
inline std::string_view without_plus(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  return word;
}

// A number too large or too small for from_chars, correctly rounded all the same: an infinity, 0 or a denormal.
float round_extreme(std::string_view word, float);
double round_extreme(std::string_view word, double);
// `v` is what `word` is as a number of the type; REQUIRES: !is_coordinate(v).
[[noreturn]] void refuse_coordinate(std::string_view word, double v, const Input& input);
// `word` is a number, but rounds to an infinity.
[[noreturn]] void refuse_too_large(std::string_view word, float, const Input& input);
[[noreturn]] void refuse_too_large(std::string_view word, double, const Input& input);
[[noreturn]] void refuse_number(std::string_view word, const char* expected, const Input& input);

// A word on the current line as a coordinate: rounded once, straight to T, the declared type.
template <class T>
double text_coordinate(std::string_view word, const Input& input) {
  const std::string_view digits = without_plus(word);
  T v = 0;
  const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), v);
  if (stop != digits.data() + digits.size() || error == std::errc::invalid_argument)
    refuse_number(word, "a number", input);
  if (error == std::errc::result_out_of_range) {
    v = round_extreme(digits, T{});
    if (std::isinf(v)) refuse_too_large(word, v, input);
  }
  if (!is_coordinate(v)) refuse_coordinate(word, v, input);
  return v + 0.0;  // -0 is +0
}

// The next word of `line` as a coordinate; nearly every one is a plain number, found in one pass.
template <class T>
double next_coordinate(std::string_view& line, const Input& input) {
  const char* p = line.data();
  const char* const end = p + line.size();
  while (p != end && is_blank(*p)) ++p;
  T v = 0;
  const auto [stop, error] = std::from_chars(p, end, v);
  if (error != std::errc{} || (stop != end && !is_blank(*stop)) || !is_coordinate(v)) return text_coordinate<T>(next_word(line), input);
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

// The beginning of a surface file, which tells what it is.
struct Head {
  std::string_view bytes;        // up to 64 KiB; a byte order mark of UTF-8 is left out
  std::optional<uint64_t> size;  // of all the contents, where it is known
  bool text;                     // no byte of the first 1024 is zero: so it is no binary STL (see facets.cpp)
  std::string_view word;         // of a text: the first word that is not in a line of comment ("#")
};

// Of a reader that looks at a head. kPerhaps: unless the file proves to be of a kind that nobody here reads.
enum class Match { kNo, kPerhaps, kSure };

// A format. A new one is a file with one of these, and a line in the table of facets.cpp.
struct SurfaceReader {
  Match (*recognises)(const Head& head);
  // Takes all of `input`, and sets format and float32 of `file`. Vertices that must be kept stay within `budget`; `helper`,
  // where there is one, may do part of the work.
  void (*read)(Input& input, FacetStream& out, SurfaceFile& file, const Budget& budget, Background* helper);
};
extern const SurfaceReader kBinaryStlReader, kAsciiStlReader, kObjReader, kPlyReader;

// What a file is that no reader takes: "a STEP file", and what to do about it. Empty: nobody knows.
struct OtherKind {
  std::string what, advice;
};
std::optional<OtherKind> other_kind(const Head& head);

// read_facets() of facets.hpp over a file already opened, or over bytes in memory.
SurfaceFile read_facets(Input& input, const std::string& part, const FacetSink& sink, const Budget& budget = {}, Background* helper = nullptr);

}  // namespace teracell
