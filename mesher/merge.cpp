#include "mesher/merge.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mesher/checkpoint.hpp"
#include "mesher/make_report.hpp"
#include "mesher/part_found.hpp"
#include "mesher/report_json.hpp"
#include "store/part.hpp"
#include "store/pyramid_writer.hpp"
#include "store/writer.hpp"

namespace teracell {
namespace {

// The parts in their order. Throws InputError unless they are all parts of one grid.
std::vector<std::unique_ptr<PartReader>> open_parts(const std::vector<std::filesystem::path>& paths) {
  std::vector<std::unique_ptr<PartReader>> parts;
  for (const auto& path : paths) parts.push_back(std::make_unique<PartReader>(path));
  if (parts.empty()) throw UsageError("expected the parts of a grid, found none");
  std::ranges::stable_sort(parts, {}, [](const auto& part) { return part->head().number; });
  const PartReader& first = *parts.front();
  for (const auto& part : parts) {
    if (part->head().of != first.head().of)
      throw InputError(fmt::format("{} is one of {} parts, but {} is one of {}", first.name(), first.head().of, part->name(), part->head().of));
    if (part->head().run != first.head().run)
      throw InputError(
          fmt::format("{} is a part of another run than {}: {}", part->name(), first.name(), difference(first.head().run, part->head().run)));
  }
  std::vector<uint32_t> missing;
  size_t at = 0;
  for (uint32_t number = 0; number < first.head().of; ++number) {
    if (at == parts.size() || parts[at]->head().number != number) missing.push_back(number);
    else if (++at; at < parts.size() && parts[at]->head().number == number)
      throw InputError(fmt::format("{} and {} are both part {}", parts[at - 1]->name(), parts[at]->name(), number));
  }
  if (!missing.empty()) {
    constexpr size_t kShown = 20;
    const size_t shown = std::min(missing.size(), kShown);
    throw InputError(fmt::format("expected {} parts, found {}: {} {}{} missing", first.head().of, parts.size(),
                                 fmt::join(missing.begin(), missing.begin() + static_cast<ptrdiff_t>(shown), ", "),
                                 missing.size() > shown ? fmt::format("and {} more ", missing.size() - shown) : "",
                                 missing.size() == 1 ? "is" : "are"));
  }
  uint64_t end = 0;
  for (const auto& part : parts) {
    if (part->head().range.first != end) throw FormatError(fmt::format("{}: does not begin where the part before it ends", part->name()));
    end = part->head().range.end;
  }
  if (end != TreeRange().end) throw FormatError(fmt::format("{}: expected the grid's last part to reach its end", parts.back()->name()));
  return parts;
}

// Puts the bytes of a part into the file, and what joins it to others.
class Joining : public PartTaker {
 public:
  Joining(const PartReader& part, GridWriter& writer, PyramidWriter& pyramid, const std::function<void(uint64_t done)>& progress)
      : part_(part), writer_(writer), pyramid_(pyramid), progress_(progress) {}

  void run() {
    part_.replay(*this);
    if (hash_.digest() != part_.hash()) throw FormatError(fmt::format("{}: damaged: expected other bytes, by their hash", part_.name()));
  }

  void bytes(uint64_t size) override {
    for (uint64_t left = size; left > 0; left -= buffer_.size(), offset_ += buffer_.size()) {
      buffer_.resize(std::min<uint64_t>(left, kPiece));
      part_.read(offset_, buffer_);
      hash_.add(buffer_);
      writer_.put_bytes(buffer_);
      progress_(offset_);
    }
  }
  void chunk(const ChunkKey& key, ChunkEntry&& entry, uint64_t changes) override { writer_.put_entry(key, std::move(entry), changes); }
  void page(const LevelInfo& chunks, uint64_t page, uint64_t size, uint64_t checksum) override { writer_.put_page(chunks, page, size, checksum); }
  void child(int level, uint32_t cu, uint32_t cv, Chunk&& coarsened) override {
    const auto node = pyramid_.node_above(level, cu, cv);
    node->add(cu, cv, std::move(coarsened), encoder_);
    pyramid_.put_above(node, cu, cv);
  }

 private:
  static constexpr size_t kPiece = 1 << 20;
  const PartReader& part_;
  GridWriter& writer_;
  PyramidWriter& pyramid_;
  const std::function<void(uint64_t done)>& progress_;
  ContentHash hash_;
  uint64_t offset_ = 0;
  Bytes buffer_;
  ChunkEncoder encoder_;
};

}  // namespace

MeshReport merge(const std::vector<std::filesystem::path>& paths, const std::filesystem::path& output, const Progress& progress,
                 const std::atomic<bool>& stop) {
  const auto began = std::chrono::steady_clock::now();
  const auto parts = open_parts(paths);
  double cells = 1;
  for (const int64_t n : parts.front()->head().meta.grid.cells()) cells *= static_cast<double>(n);
  uint64_t all = 0, done = 0;
  for (const auto& part : parts) all += part->bytes();

  GridWriter writer(output, parts.front()->head().meta);
  PyramidWriter pyramid(writer);
  CastTotals totals;
  std::optional<SurfacesFound> surfaces;
  for (const auto& part : parts) {
    Joining(*part, writer, pyramid, [&](uint64_t of_part) {
      if (stop) throw Interrupted(fmt::format("{}: interrupted: nothing was written", output.string()));
      progress("merge", static_cast<double>(done + of_part) / static_cast<double>(all), cells);
    }).run();
    PartFound found = decode_found(part->found(), part->name());
    if (found.surfaces) surfaces = std::move(found.surfaces);
    if (totals.cells.empty()) totals = std::move(found.totals);
    else totals.add(found.totals);
    done += part->bytes();
  }
  if (!surfaces) throw FormatError(fmt::format("{}: expected what was found of the surfaces, found none", parts.front()->name()));

  const Plan plan{writer.meta(), surfaces->rays, {}};
  MeshReport out;
  out.report = make_report(surfaces->scene, std::move(surfaces->bodies), surfaces->counts, plan, totals, surfaces->thin);
  out.json = report_json(out.report, surfaces->scene);
  progress("write", 0, cells);
  writer.finish(out.json, totals.crossings);
  out.run.phases.push_back({"merge", std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count()});
  out.run.file_bytes = writer.bytes();
  out.run.exact_decisions = totals.exact_decisions;
  out.run.peak_memory_bytes = peak_memory_bytes();
  out.scene = std::move(surfaces->scene);
  return out;
}

}  // namespace teracell
