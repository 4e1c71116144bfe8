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

enum class Format { kBinaryStl, kAsciiStl, kObj, kPly };

constexpr size_t kPeek = size_t{1} << 16;

// Every binary STL has a zero byte in front: the count's highest one, the attributes, a 0.0 or 1.0. No text has one.
bool is_text(std::string_view head) { return head.substr(0, 1024).find('\0') == std::string_view::npos; }

// The first word of the first line that is no comment.
std::string_view first_word(std::string_view head) {
  while (!head.empty()) {
    const size_t stop = std::min(head.find_first_of("\r\n"), head.size());
    std::string_view line = head.substr(0, stop);
    head.remove_prefix(std::min(stop + 1, head.size()));
    const std::string_view word = next_word(line);
    if (!word.empty() && word[0] != '#') return word;
  }
  return {};
}

bool is_obj_word(std::string_view word) {
  for (const char* known : {"v",   "vt",   "vn",     "vp",     "f",      "fo",       "g",        "o",
                            "s",   "l",    "p",      "mtllib", "usemtl", "mg",       "lod",      "cstype",
                            "deg", "surf", "maplib", "usemap", "bevel",  "c_interp", "d_interp", "shadow_obj"})
    if (word == known) return true;
  return false;
}

Format format_of(Input& input) {
  const std::string_view head = input.window(kPeek);
  if (head.empty()) throw InputError(fmt::format("{}: the file is empty: expected STL, OBJ or PLY", input.name()));
  if (head.starts_with("ply\n") || head.starts_with("ply\r")) {
    if (!head.starts_with("ply\r\n") && head[3] == '\r') input.set_newline('\r');
    return Format::kPly;
  }
  // The size decides for binary STL: many of them begin with "solid" too.
  const uint64_t size = input.size() ? *input.size() : head.size() < kPeek ? head.size() : 0;
  if (head.size() >= 84) {
    uint64_t facets = 0;
    for (int i = 3; i >= 0; --i) facets = facets << 8 | static_cast<unsigned char>(head[80 + i]);
    if (size == 84 + 50 * facets || !is_text(head)) return Format::kBinaryStl;
  }
  if (is_text(head)) {
    if (head.find('\n') == std::string_view::npos && head.find('\r') != std::string_view::npos) input.set_newline('\r');
    const size_t mark = head.starts_with("\xef\xbb\xbf") ? 3 : 0;  // of UTF-8
    const std::string_view word = first_word(head.substr(mark));
    const bool comments_only = word.empty() && head.find('#') != std::string_view::npos;
    const Format format = is_keyword(word, "solid") ? Format::kAsciiStl : Format::kObj;
    if (format == Format::kAsciiStl || comments_only || is_obj_word(word)) {
      input.consume(mark);
      return format;
    }
  }
  throw InputError(fmt::format("{}: not a surface file: expected STL, OBJ or PLY, found {}", input.name(),
                               shown(head.substr(0, 64))));
}

// The C locale whatever the program has set: a decimal point is a point.
locale_t c_locale() {
  static const locale_t locale = newlocale(LC_ALL_MASK, "C", nullptr);
  return locale;
}

}  // namespace

FacetStream::FacetStream(const std::string& glob, const FacetSink& sink)
    : glob_(glob), sink_(sink), batch_(std::make_unique_for_overwrite<Facet[]>(kBatch)) {}

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
  sink_({batch_.get(), used_});
  facets_ += used_;
  used_ = 0;
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
    throw InputError(glob_.empty() ? fmt::format("{}: holds no facet", name)
                                   : fmt::format("{}: the parts that match {} hold no facet", name, shown(glob_)));
  file.facets = facets_;
  file.parts = std::move(parts_);
}

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
  switch (format_of(input)) {
    case Format::kBinaryStl:
      file.format = "STL (binary)";
      read_binary_stl(input, out);
      break;
    case Format::kAsciiStl:
      file.format = "STL (ASCII)";
      read_ascii_stl(input, out);
      break;
    case Format::kObj:
      file.format = "OBJ";
      file.float32 = false;
      read_obj(input, out, budget, helper);
      break;
    case Format::kPly:
      file.format = read_ply(input, out, budget, file.float32);
      break;
  }
  out.finish(input.name(), file);
  file.bytes = input.bytes_on_disk();
  file.hash = input.hash();
  return file;
}

SurfaceFile read_facets(const std::filesystem::path& path, const std::string& part, const FacetSink& sink, const Budget& budget, Background* helper) {
  Input input(path);
  return read_facets(input, part, sink, budget, helper);
}

}  // namespace teracell
