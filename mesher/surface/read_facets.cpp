// Recognises the format of a surface file from its first bytes and calls the reader of that format.
#include "mesher/surface/read_facets.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mesher/surface/readers.hpp"
#include "store/base/error.hpp"

namespace teracell::mesher {
namespace {

constexpr size_t kPeek = size_t{1} << 16;

// Every binary STL has a zero byte near its beginning: the highest byte of the count, an attribute, part of a 0.0 or 1.0. No text
// has one.
bool is_text(std::string_view head) { return head.substr(0, 1024).find('\0') == std::string_view::npos; }

// The first word that is not in a comment.
std::string_view first_word(std::string_view head) {
  while (!head.empty()) {
    std::string_view line = first_line(head);
    head.remove_prefix(std::min(line.size() + 1, head.size()));
    const std::string_view word = next_word(line);
    if (!word.empty() && word[0] != '#') return word;
  }
  return {};
}

// Skips the byte order mark of a text.
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

// "STL, OBJ, PLY, OFF, 3MF, glTF or STEP": the formats in the order of the readers.
std::string known_formats() {
  std::vector<std::string> names;
  for (const SurfaceReader* reader : kReaders)
    if (std::ranges::count(names, reader->name) == 0) names.push_back(reader->name);
  const std::string last = names.back();
  names.pop_back();
  return fmt::format("{} or {}", fmt::join(names, ", "), last);
}

const SurfaceReader& reader_of(Input& input) {
  if (input.window(1).empty()) throw InputError(fmt::format("{}: the file is empty: expected {}", input.name(), known_formats()));
  const Head head = head_of(input);
  const SurfaceReader* perhaps = nullptr;
  for (const SurfaceReader* reader : kReaders) {
    const Match match = reader->recognises(head);
    if (match == Match::kSure) return *reader;
    if (match == Match::kPerhaps && !perhaps) perhaps = reader;
  }
  if (const auto other = other_kind(head))
    throw InputError(fmt::format("{}: this is {}{}: expected {}{}{}", input.name(), other->what, input.compressed() ? ", compressed by gzip" : "",
                                 known_formats(), other->advice.empty() ? "" : "; ", other->advice));
  if (perhaps) return *perhaps;
  throw InputError(fmt::format("{}: not a surface file: expected {}, found {}", input.name(), known_formats(), shown(head.bytes.substr(0, 64))));
}

// `file` has the bytes of files beside this one, and their hashes, one after another: then the hash is that of the list of hashes.
void describe(const Input& input, const std::string& units, SurfaceFile& file) {
  file.bytes += input.bytes_on_disk();
  const std::string list = input.hash() + file.hash;
  file.hash = file.hash.empty() ? list : Input("", list).hash();
  file.regular = input.regular();
  file.units = units;
}

SurfaceFile read_parts(KeptTree& kept, const std::string& part, const FacetSink& sink, const ReadOptions& options) {
  SurfaceFile file = kept.file;
  const PartGlob glob(part);
  FacetStream out(glob, sink, options);
  out.add_parts(*kept.tree, file, options);
  out.finish(kept.tree->name(), file);
  return file;
}

}  // namespace

void KeptTree::open(Input& input, const SurfaceReader& reader, const ReadOptions& options) {
  *this = {};
  const auto make = options.outline && reader.exact.outline ? reader.exact.outline : reader.open;
  tree = std::make_shared<PartTree>(make(input, file, options));
  describe(input, options.units, file);
  name = input.name(), units = options.units;
  if (file.cad) deflection = options.cad->deflection, angle = options.cad->angle;
}

bool KeptTree::open(Input& input, const ReadOptions& options) {
  const SurfaceReader& reader = reader_of(input);
  if (reader.open) open(input, reader, options);
  return reader.open;
}

KeptTree* KeptTrees::find(const std::string& name, const ReadOptions& options) {
  const auto found = std::ranges::find_if(trees_, [&](const KeptTree& t) {
    return t.name == name && t.units == options.units && (!t.file.cad || (t.deflection == options.cad->deflection && t.angle == options.cad->angle));
  });
  if (found == trees_.end()) return nullptr;
  trees_.splice(trees_.begin(), trees_, found);
  return &trees_.front();
}

KeptTree& KeptTrees::add(KeptTree&& tree, uint64_t bytes) {
  constexpr size_t kMost = 64;
  trees_.push_front(std::move(tree));
  const auto all = [&] {
    uint64_t sum = 0;
    for (const KeptTree& t : trees_) sum += t.tree->bytes_in_memory();
    return sum;
  };
  while (trees_.size() > 1 && (trees_.size() > kMost || all() > bytes)) trees_.pop_back();
  return trees_.front();
}

SurfaceFile read_facets(Input& input, const std::string& part, const FacetSink& sink, const ReadOptions& options) {
  const SurfaceReader& reader = reader_of(input);
  if (reader.open) {
    KeptTree here;
    here.open(input, reader, options);
    return read_parts(options.kept ? options.kept->add(std::move(here), options.budget.bytes / 4) : here, part, sink, options);
  }
  SurfaceFile file;
  const PartGlob glob(part);
  FacetStream out(glob, sink, options);
  reader.read(input, out, file, options);
  out.finish(input.name(), file);
  describe(input, options.units, file);
  return file;
}

bool has_exact_surfaces(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  Input input(path);
  const Head head = head_of(input);
  return std::ranges::any_of(kReaders, [&](const SurfaceReader* r) { return r->exact.box && r->recognises(head) == Match::kSure; });
}

std::optional<std::array<Vec3, 2>> exact_box(const std::filesystem::path& path, const std::vector<TakenParts>& taken, const ReadOptions& options) {
  Input input(path);
  return reader_of(input).exact.box(input, taken, options);
}

std::string stated_unit(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return "";
  Input input(path);
  const SurfaceReader& reader = reader_of(input);
  return reader.unit ? reader.unit(input) : "";
}

std::string first_stated_unit(const std::vector<std::filesystem::path>& paths, std::filesystem::path* unsaid) {
  std::string first;
  std::filesystem::path without;
  for (const std::filesystem::path& path : paths) {
    const std::string unit = stated_unit(path);
    if (first.empty()) first = unit;
    if (unit.empty() && without.empty()) without = path;
    if (!first.empty() && (!unsaid || !without.empty())) break;
  }
  if (unsaid && !first.empty()) *unsaid = without;
  return first.empty() ? "m" : first;
}

SurfaceFile read_facets(const std::filesystem::path& path, const std::string& part, const FacetSink& sink, const ReadOptions& options) {
  if (options.kept)
    if (KeptTree* kept = options.kept->find(path.string(), options)) return read_parts(*kept, part, sink, options);
  Input input(path);
  return read_facets(input, part, sink, options);
}

}  // namespace teracell::mesher
