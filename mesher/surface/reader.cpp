#include "mesher/surface/reader.hpp"

#include <locale.h>
#include <stdlib.h>

#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mesher/surface/cad_parts.hpp"
#include "store/base/error.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {
namespace {

// The C locale, in which the decimal point is a point, whatever the program has set.
locale_t c_locale() {
  static const locale_t locale = newlocale(LC_ALL_MASK, "C", nullptr);
  return locale;
}

// Names are UTF-8, whatever a file holds, and not longer than may be stored.
std::string clean(std::string_view name) { return std::string(first_bytes(utf8_of(name), kLongestPartName)); }

}  // namespace

FacetStream::FacetStream(const PartGlob& glob, const FacetSink& sink, const ReadOptions& options)
    : glob_(glob), sink_(sink), enter_patch_(options.enter_patch), blocks_(options.blocks), numbers_(options.numbers) {}

void FacetStream::enter_patch(std::string_view name) {
  if (name == raw_patch_) return;
  raw_patch_ = name;
  change_patch(clean(name));
}

void FacetStream::change_patch(std::string_view name) {
  flush();
  patch_ = name;
  limit_ = 0;
}

// A file may name more patches than can be remembered: the others are not told apart.
void FacetStream::begin_patch() {
  constexpr size_t kMostPatchesOfFile = size_t{1} << 16, kMostBytes = size_t{1} << 23;
  auto known = patches_.find(patch_);
  if (known == patches_.end()) {
    const bool one_too_many = !patch_.empty() && (patches_.size() >= kMostPatchesOfFile || patch_bytes_ + patch_.size() > kMostBytes);
    if (one_too_many && !std::exchange(warned_of_patches_, true))
      warn(
          fmt::format("more groups or solids are named than are told apart, {} or {} bytes of names: facets of the others belong to the patch of "
                      "the body",
                      kMostPatchesOfFile, kMostBytes));
    const std::string name = one_too_many ? "" : patch_;
    const auto [place, fresh] = patches_.emplace(name, static_cast<uint32_t>(patch_names_.size()));
    if (fresh) patch_names_.push_back(name), patch_bytes_ += name.size();
    known = place;
  }
  if (std::exchange(entered_, known->second) != known->second) enter_patch_(known->second);
}

bool FacetStream::wants(std::string_view part) {
  const std::string name = clean(part);
  if (!name.empty() && !known_parts_.contains(name)) note(name);
  const bool wanted = glob_.matches_name(name);
  matched_ |= wanted;
  return wanted;
}

void refuse_empty(const std::string& name, const SurfaceFile& file) {
  throw InputError(fmt::format("{}: holds no facet{}{}", name, file.warnings.empty() ? "" : ": ", fmt::join(file.warnings, ". ")));
}

namespace {

std::string color_word(const std::string& color) {
  for (const auto& [code, word] : {std::pair{"#ff0000", "red"},
                                   {"#00ff00", "green"},
                                   {"#0000ff", "blue"},
                                   {"#ffff00", "yellow"},
                                   {"#00ffff", "cyan"},
                                   {"#ff00ff", "magenta"},
                                   {"#ffffff", "white"},
                                   {"#000000", "black"}})
    if (color == code) return word;
  return color;
}

}  // namespace

void FacetStream::add_parts(PartTree& tree, SurfaceFile& file, const ReadOptions& options) {
  if (tree.parts().empty()) refuse_empty(tree.name(), file);
  matched_ = glob_.takes_all();
  const std::vector<uint32_t> taken = tree.matching(glob_);
  if (file.cad) {
    file.cad_parts = cad_parts(tree, taken, *file.cad);
    for (std::string& w : cad_warnings(file.cad_parts, *file.cad)) file.warnings.push_back(std::move(w));
  }
  for (const uint32_t i : taken) {
    const Part& part = tree.parts()[i];
    matched_ = true;
    file.float32 &= file.factor.is_one() && tree.float32(part);
    if (options.face_patches && tree.groups(part).size() > 1) {
      add_by_color(tree, part);
      continue;
    }
    change_patch(part.path);
    if (options.take_part) {
      begin_patch();
      if (options.take_part(part)) {
        facets_ += tree.facets(part);
        continue;
      }
    }
    tree.read(part, [this](const Facet& facet) { next() = facet; });
  }
  if (matched_) return;
  for (const Part& part : tree.parts()) note(part.path);  // for the message
}

void FacetStream::add_by_color(PartTree& tree, const Part& part) {
  auto group = tree.groups(part).begin();
  uint64_t left = 0;  // of the group
  tree.read(part, [&](const Facet& facet) {
    for (; left == 0; ++group) {
      left = group->facets;
      if (left > 0) change_patch(group->color.empty() ? part.path : fmt::format("{}:{}", part.path, color_word(group->color)));
    }
    --left;
    next() = facet;
  });
}

// The names are only for messages, so millions of them are not worth their memory.
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
  if (numbers_) numbers_->clear();
  facets_ += used_;
  used_ = 0;
}

const FacetBlocks* FacetStream::blocks(bool float32) {
  if (!blocks_) return nullptr;
  begin_patch();
  limit_ = capacity_;
  return blocks_->wanted(float32) ? blocks_ : nullptr;
}

void FacetStream::make_room() {
  if (limit_ == 0) begin_patch();
  if (std::exchange(limit_, capacity_) == 0) return;
  flush();
  if (capacity_ == kMany) return;
  many_ = std::make_unique_for_overwrite<Facet[]>(kMany);
  batch_ = many_.get();
  capacity_ = limit_ = kMany;
}

void refuse_no_match(const std::string& name, const std::string& glob, const std::vector<std::string>& parts, bool more) {
  constexpr size_t kShown = 8;
  if (parts.empty() && !more) throw InputError(fmt::format("{}: no part matches {}: the file names no parts", name, shown(glob)));
  std::vector<std::string> some;
  for (size_t i = 0; i < std::min(parts.size(), kShown); ++i) some.push_back(shown(parts[i]));
  throw InputError(fmt::format("{}: no part matches {}: the file has {}{}: {}{}", name, shown(glob), more ? "more than " : "",
                               parts.size() == 1 ? "1 part" : fmt::format("{} parts", parts.size()), fmt::join(some, ", "),
                               more || parts.size() > some.size() ? ", ..." : ""));
}

void FacetStream::finish(const std::string& name, SurfaceFile& file) {
  flush();
  if (!matched_) refuse_no_match(name, glob_.text(), parts_, more_parts_);
  if (facets_ == 0)
    throw InputError(fmt::format("{}: {}{}{}", name,
                                 glob_.takes_all() ? "holds no facet" : fmt::format("the parts that match {} hold no facet", shown(glob_.text())),
                                 warnings_.empty() ? "" : ": ", fmt::join(warnings_, ". ")));
  file.facets = facets_;
  file.parts = std::move(parts_);
  file.patches = std::move(patch_names_);
  for (std::string& w : warnings_) file.warnings.push_back(std::move(w));
}

float round_extreme(std::string_view word, float) { return strtof_l(std::string(word).c_str(), nullptr, c_locale()); }
double round_extreme(std::string_view word, double) { return strtod_l(std::string(word).c_str(), nullptr, c_locale()); }

void refuse_number(std::string_view word, const char* expected, const Input& input) {
  throw InputError(fmt::format("{}: expected {}, found {}", input.at_line(), expected, word.empty() ? "the end of the line" : shown(word)));
}

void refuse_too_large(std::string_view word, float, const Input& input) {
  throw InputError(fmt::format("{}: {}: expected a coordinate, found a number too large for float32 (at most 3.4e38)", input.at_line(), shown(word)));
}

void refuse_too_large(std::string_view word, double, const Input& input) {
  throw InputError(fmt::format(
      "{}: {}: expected a coordinate that is 0 or has a magnitude from 1e-75 to 1e75, found a number too large for float64 (at most 1.8e308)",
      input.at_line(), shown(word)));
}

void refuse_coordinate(std::string_view word, double v, const Input& input) {
  checked_coordinate(v, fmt::format("{}: {}", input.at_line(), shown(word)));
  throw std::logic_error("refuse_coordinate: the number is a coordinate");
}

}  // namespace teracell::mesher
