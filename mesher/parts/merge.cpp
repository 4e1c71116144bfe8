#include "mesher/parts/merge.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mesher/bodies/joining.hpp"
#include "mesher/report/make_report.hpp"
#include "mesher/report/report_json.hpp"
#include "mesher/run/checkpoint.hpp"
#include "mesher/run/part_found.hpp"
#include "store/base/system/system.hpp"

namespace teracell::mesher {
namespace {

// What is kept of a part while the others are read. There may be more parts than files that a process may open.
struct Listed {
  std::filesystem::path path;
  uint32_t number;
  TreeRange range;
  uint64_t bytes;  // of the grid
};

class Parts {
 public:
  // Throws InputError or FormatError unless these are all parts of one grid.
  explicit Parts(const std::vector<std::filesystem::path>& paths) {
    if (paths.empty()) throw UsageError("expected the parts of a grid, found none");
    for (const auto& path : paths) add(path);
    std::ranges::stable_sort(listed_, {}, &Listed::number);
    expect_all();
    expect_one_after_another();
    expect_room_for_pages();
  }
  const Metadata& meta() const { return head_.meta; }
  const std::vector<Listed>& listed() const { return listed_; }
  uint64_t bytes() const { return bytes_; }  // of the grid

  std::unique_ptr<PartReader> open(const Listed& part) const {
    auto reader = std::make_unique<PartReader>(part.path);
    const PartHead& head = reader->head();
    if (head.run != head_.run || head.of != head_.of || head.number != part.number || head.range != part.range || head.meta != head_.meta ||
        reader->bytes() != part.bytes)
      throw InputError(fmt::format("{}: another part took its place while the parts were merged", reader->name()));
    return reader;
  }

 private:
  void add(const std::filesystem::path& path) {
    if (path.extension() == ".partial" || path.extension() == ".resume")
      throw InputError(fmt::format("{}: expected a part, found one that is not complete: it is being made, or its run was killed", path.string()));
    PartReader part(path);
    if (listed_.empty()) head_ = part.head(), first_ = part.name();
    const PartHead& head = part.head();
    if (head.of != head_.of) throw InputError(fmt::format("{} is one of {} parts, but {} is one of {}", first_, head_.of, part.name(), head.of));
    if (head.run != head_.run)
      throw InputError(fmt::format("{} is a part of another run than {}: {}", part.name(), first_, difference(head_.run, head.run)));
    if (head.meta != head_.meta)
      throw FormatError(fmt::format("{}: expected a part of the grid of {}, found one of another grid", part.name(), first_));
    listed_.push_back({path, head.number, head.range, part.bytes()});
    bytes_ += part.bytes();
    file_bytes_ += part.file_bytes();
  }

  void expect_all() const {
    for (size_t i = 1; i < listed_.size(); ++i)
      if (listed_[i - 1].number == listed_[i].number)
        throw InputError(fmt::format("{} and {} are both part {}", listed_[i - 1].path.string(), listed_[i].path.string(), listed_[i].number));
    const uint64_t missing = head_.of - listed_.size();
    if (missing == 0) return;
    constexpr uint64_t kShown = 20;
    std::vector<uint32_t> shown;
    auto part = listed_.begin();
    for (uint32_t number = 0; shown.size() < std::min(missing, kShown); ++number)
      if (part != listed_.end() && part->number == number) ++part;
      else shown.push_back(number);
    throw InputError(fmt::format("expected {} parts, found {}: {} {}{} missing", head_.of, listed_.size(), fmt::join(shown, ", "),
                                 missing > kShown ? fmt::format("and {} more ", missing - kShown) : "", missing == 1 ? "is" : "are"));
  }

  void expect_one_after_another() const {
    uint64_t end = 0;
    for (const Listed& part : listed_) {
      if (part.range.first != end) throw FormatError(fmt::format("{}: does not begin where the part before it ends", part.path.string()));
      end = part.range.end;
    }
    if (end != TreeRange().end) throw FormatError(fmt::format("{}: expected the grid's last part to reach its end", listed_.back().path.string()));
  }

  // The index takes memory for each page, of which the parts hold several bytes.
  void expect_room_for_pages() const {
    for (int level = 0; level < meta().grid.levels(); ++level) {
      const LevelShape s(meta(), level);
      if (const double pages = double{1} * s.pages_u * s.pages_v * s.segments; level != 1 && pages > static_cast<double>(file_bytes_))
        throw FormatError(fmt::format("{}: damaged: a grid with {:.3g} index pages on level {} has parts of more than {} bytes", first_, pages, level,
                                      file_bytes_));
    }
  }

  PartHead head_;      // of the first one that was given
  std::string first_;  // its name
  std::vector<Listed> listed_;
  uint64_t bytes_ = 0, file_bytes_ = 0;
};

// Puts the bytes of a part into the file, and what joins it to others.
class Copying : public Joining {
 public:
  Copying(const PartReader& part, GridWriter& writer, PyramidWriter& pyramid, const std::function<void(uint64_t done)>& progress)
      : Joining(writer, pyramid), part_(part), progress_(progress) {}

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

 private:
  static constexpr size_t kPiece = 1 << 20;
  const PartReader& part_;
  const std::function<void(uint64_t done)>& progress_;
  ContentHash hash_;
  uint64_t offset_ = 0;
  Bytes buffer_;
};

}  // namespace

MeshReport merge(const std::vector<std::filesystem::path>& paths, const std::filesystem::path& output, const Progress& progress,
                 const std::atomic<bool>& stop) {
  const auto began = std::chrono::steady_clock::now();
  const Parts parts(paths);
  double cells = 1;
  for (const int64_t n : parts.meta().grid.cells()) cells *= static_cast<double>(n);
  uint64_t done = 0;

  GridWriter writer(output, parts.meta());
  PyramidWriter pyramid(writer);
  CastTotals totals;
  std::optional<SurfacesFound> surfaces;
  for (const Listed& listed : parts.listed()) {
    const auto part = parts.open(listed);
    const std::function<void(uint64_t)> copied = [&](uint64_t of_part) {
      if (stop) throw Interrupted(fmt::format("{}: interrupted: nothing was written", output.string()));
      progress("merge", static_cast<double>(done + of_part) / static_cast<double>(parts.bytes()), cells);
    };
    Copying(*part, writer, pyramid, copied).run();
    PartFound found = decode_found(part->found(), part->name());
    if (listed.number == 0) surfaces = std::move(found.surfaces);
    if (!surfaces) throw FormatError(fmt::format("{}: expected what was found of the surfaces, found none", part->name()));
    expect_fit(found.totals, *surfaces, parts.meta(), part->name());
    if (listed.number == 0) totals = std::move(found.totals);
    else totals.add(found.totals);
    done += part->bytes();
  }

  const Plan plan{writer.meta(), surfaces->rays, make_labels(surfaces->scene), surfaces->planes, surfaces->all_patches};
  MeshReport out;
  out.report = make_report(surfaces->scene, std::move(surfaces->bodies), surfaces->counts, plan, totals, surfaces->thin);
  out.json = report_json(out.report, surfaces->scene);
  progress("write", 0, cells);
  writer.finish(out.json, totals.crossings, &totals.sums);
  out.run.phases.push_back({"merge", std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count()});
  out.run.file_bytes = writer.bytes();
  out.run.exact_decisions = totals.exact_decisions;
  out.run.peak_memory_bytes = system::peak_bytes();
  out.scene = std::move(surfaces->scene);
  return out;
}

}  // namespace teracell::mesher
