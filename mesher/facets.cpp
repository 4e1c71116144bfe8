// Tells a surface file's format by its first bytes and calls its reader; and what the readers share (readers.hpp).
#include "mesher/facets.hpp"

#include <fnmatch.h>
#include <locale.h>
#include <stdlib.h>

#include <algorithm>
#include <initializer_list>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mesher/readers.hpp"
#include "mesher/scene_names.hpp"
#include "store/error.hpp"

namespace teracell {
namespace {

// The sure ones need no order: no file is two of them.
constexpr const SurfaceReader* kReaders[] = {&kBinaryStlReader, &kPlyReader, &kAsciiStlReader, &kObjReader};

constexpr size_t kPeek = size_t{1} << 16;

// Every binary STL has a zero byte in front: the count's highest one, the attributes, a 0.0 or 1.0. No text has one.
bool is_text(std::string_view head) { return head.substr(0, 1024).find('\0') == std::string_view::npos; }

// The first word of the first line that is no comment.
std::string_view first_word(std::string_view head) {
  while (!head.empty()) {
    std::string_view line = first_line(head);
    head.remove_prefix(std::min(line.size() + 1, head.size()));
    const std::string_view word = next_word(line);
    if (!word.empty() && word[0] != '#') return word;
  }
  return {};
}

// Leaves `input` behind the byte order mark.
Head head_of(Input& input) {
  const size_t mark = input.window(kPeek).starts_with("\xef\xbb\xbf") ? 3 : 0;
  Head head{.bytes = input.window(0), .size = input.size(), .text = false, .word = {}};
  if (!head.size && head.bytes.size() < kPeek) head.size = head.bytes.size();
  head.text = is_text(head.bytes);
  if (head.text) {
    input.consume(mark);
    head.bytes.remove_prefix(mark);
    if (head.bytes.find('\n') == std::string_view::npos && head.bytes.find('\r') != std::string_view::npos) input.set_newline('\r');
    head.word = first_word(head.bytes);
  }
  return head;
}

const SurfaceReader& reader_of(Input& input) {
  if (input.window(1).empty()) throw InputError(fmt::format("{}: the file is empty: expected STL, OBJ or PLY", input.name()));
  const Head head = head_of(input);
  const SurfaceReader* perhaps = nullptr;
  for (const SurfaceReader* reader : kReaders) {
    const Match match = reader->recognises(head);
    if (match == Match::kSure) return *reader;
    if (match == Match::kPerhaps && !perhaps) perhaps = reader;
  }
  if (const auto other = other_kind(head))
    throw InputError(fmt::format("{}: this is {}{}: expected STL, OBJ or PLY{}{}", input.name(), other->what, input.compressed() ? ", compressed by gzip" : "",
                                 other->advice.empty() ? "" : "; ", other->advice));
  if (perhaps) return *perhaps;
  throw InputError(fmt::format("{}: not a surface file: expected STL, OBJ or PLY, found {}", input.name(),
                               shown(head.bytes.substr(0, 64))));
}

// The C locale whatever the program has set: a decimal point is a point.
locale_t c_locale() {
  static const locale_t locale = newlocale(LC_ALL_MASK, "C", nullptr);
  return locale;
}

}  // namespace

FacetStream::FacetStream(const std::string& glob, const FacetSink& sink)
    : glob_(glob), sink_(sink) {}

bool FacetStream::wants(std::string_view part) {
  const std::string name(part);
  if (!name.empty() && !known_parts_.contains(name)) note(name);
  const bool wanted = glob_.empty() || fnmatch(glob_.c_str(), name.c_str(), 0) == 0;
  matched_ |= wanted;
  return wanted;
}

// The names are for messages only: those of a file that has millions are not worth the memory.
void FacetStream::note(const std::string& name) {
  constexpr uint64_t kMostBytes = uint64_t{1} << 23;
  const uint64_t bytes = 2 * (name.size() + 64);
  more_parts_ |= names_ + bytes > kMostBytes;
  if (more_parts_) return;
  names_ += bytes;
  known_parts_.insert(name);
  parts_.push_back(name);
}

void FacetStream::flush() {
  if (used_ == 0) return;
  sink_({batch_, used_});
  facets_ += used_;
  used_ = 0;
}

void FacetStream::make_room() {
  flush();
  if (capacity_ == kMany) return;
  many_ = std::make_unique_for_overwrite<Facet[]>(kMany);
  batch_ = many_.get();
  capacity_ = kMany;
}

void FacetStream::finish(const std::string& name, SurfaceFile& file) {
  flush();
  if (!matched_ && parts_.empty() && !more_parts_)
    throw InputError(fmt::format("{}: no part matches {}: the file names no parts", name, shown(glob_)));
  if (!matched_) {
    std::vector<std::string> some;
    for (size_t i = 0; i < std::min<size_t>(parts_.size(), 8); ++i) some.push_back(shown(parts_[i]));
    throw InputError(fmt::format("{}: no part matches {}: the file has {}{} parts: {}{}", name, shown(glob_),
                                 more_parts_ ? "more than " : "", parts_.size(), fmt::join(some, ", "),
                                 more_parts_ || parts_.size() > some.size() ? ", ..." : ""));
  }
  if (facets_ == 0)
    throw InputError(fmt::format("{}: {}{}{}", name, glob_.empty() ? "holds no facet" : fmt::format("the parts that match {} hold no facet", shown(glob_)),
                                 warnings_.empty() ? "" : ": ", fmt::join(warnings_, ". ")));
  file.facets = facets_;
  file.parts = std::move(parts_);
  file.warnings = std::move(warnings_);
}

std::string plural(uint64_t n, const char* what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string shown(std::string_view text) {
  constexpr size_t kLongest = 48;
  return fmt::format("'{}{}'", printable(text.substr(0, kLongest)), text.size() > kLongest ? "..." : "");
}

float round_extreme(std::string_view word, float) { return strtof_l(std::string(word).c_str(), nullptr, c_locale()); }
double round_extreme(std::string_view word, double) { return strtod_l(std::string(word).c_str(), nullptr, c_locale()); }

void refuse_number(std::string_view word, const char* expected, const Input& input) {
  throw InputError(fmt::format("{}: expected {}, found {}", input.at_line(), expected,
                               word.empty() ? "the end of the line" : shown(word)));
}

void refuse_too_large(std::string_view word, float, const Input& input) {
  throw InputError(fmt::format("{}: {}: expected a coordinate, found a number too large for float32 (at most 3.4e38)", input.at_line(), shown(word)));
}

void refuse_too_large(std::string_view word, double, const Input& input) {
  throw InputError(fmt::format("{}: {}: expected a coordinate of 0 or of size 1e-75 to 1e75, found a number too large for float64 (at most 1.8e308)",
                               input.at_line(), shown(word)));
}

void refuse_coordinate(std::string_view word, double v, const Input& input) {
  checked_coordinate(v, fmt::format("{}: {}", input.at_line(), shown(word)));
  throw std::logic_error("refuse_coordinate: nothing to refuse");
}

double checked_coordinate(double v, const std::string& where) {
  if (is_coordinate(v)) return v + 0.0;
  throw InputError(!std::isfinite(v)
                       ? fmt::format("{}: expected a finite coordinate, found {}", where, v)
                       : fmt::format("{}: expected a coordinate of 0 or of size 1e-75 to 1e75, found {}", where, v));
}

SurfaceFile read_facets(Input& input, const std::string& part, const FacetSink& sink, const Budget& budget, Background* helper) {
  SurfaceFile file;
  FacetStream out(part, sink);
  reader_of(input).read(input, out, file, budget, helper);
  out.finish(input.name(), file);
  file.bytes = input.bytes_on_disk();
  file.hash = input.hash();
  file.regular = input.regular();
  return file;
}

SurfaceFile read_facets(const std::filesystem::path& path, const std::string& part, const FacetSink& sink, const Budget& budget, Background* helper) {
  Input input(path);
  return read_facets(input, part, sink, budget, helper);
}

}  // namespace teracell
