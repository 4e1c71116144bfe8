#include "mesher/parts/pieces.hpp"

#include <fmt/format.h>

#include "mesher/engines/engines.hpp"
#include "mesher/report/make_report.hpp"
#include "mesher/report/report_json.hpp"
#include "mesher/run/part_found.hpp"
#include "store/base/error.hpp"
#include "store/base/system/system.hpp"
#include "store/base/zstd_frame.hpp"

namespace teracell::mesher {
namespace {

MeshOptions of_process(MeshOptions options, bool first) {
  if (!first) options.write_caps.clear();
  options.count_aside = first;  // all others wait until the first has read its facets
  return options;
}

}  // namespace

Pieces::Pieces(const Scene& scene, const std::filesystem::path& output, const MeshOptions& options, bool first, const Progress& progress,
               const std::atomic<bool>& stop)
    : output_(output),
      run_(scene, output, of_process(options, first), first, progress, stop),
      pieces_(run_.costs().pieces()),
      facets_(run_.scene, run_.bodies, run_.plan.meta, run_.widened, run_.budget, run_.threads, run_.options.links ? &*run_.patches : nullptr,
              [this](double share) { run_.progress("spill", share); }) {
  const std::string identity = run_.identity();
  ContentHash hash;
  hash.add({reinterpret_cast<const uint8_t*>(identity.data()), identity.size()});
  for (const uint8_t byte : hash.digest()) run_id_ += fmt::format("{:02x}", byte);
}

std::filesystem::path Pieces::path(uint32_t piece) const { return fmt::format("{}.piece-{}-of-{}", output_.string(), piece, size()); }

std::unique_ptr<PartReader> Pieces::open(uint32_t piece) const {
  auto part = std::make_unique<PartReader>(path(piece));
  const PartHead& head = part->head();
  if (head.run != run_id_ || head.number != piece || head.of != size() || head.range.first != pieces_[piece].range.first ||
      head.range.end != pieces_[piece].range.end)
    throw FormatError(fmt::format("{}: expected piece {} of {} of this run, found another one", part->name(), piece, size()));
  return part;
}

bool Pieces::is_made(uint32_t piece) const try {
  const auto part = open(piece);
  part->check_records();
  decode_found(part->found(), part->name());
  ContentHash hash;
  Bytes block;
  for (uint64_t at = 0; at < part->bytes(); at += block.size()) {
    run_.progress("resume", 0);
    block.resize(std::min<uint64_t>(part->bytes() - at, 1 << 20));
    part->read(at, block);
    hash.add(block);
  }
  return hash.digest() == part->hash();
} catch (const FormatError&) {
  return false;
} catch (const IoError&) {
  return false;
}

void Pieces::settle(const PieceQueue::Order& order) { settle(TreeRange{pieces_[order.first].range.first, pieces_[order.end - 1].range.end}); }

void Pieces::make(const PieceQueue::Order& order) {
  if (pieces_[order.piece].range.first < reached_) home_ = {1, 0};
  settle(order);
  const TreeRange& range = pieces_[order.piece].range;
  reached_ = range.end;
  PartWriter writer(path(order.piece), {run_id_, order.piece, size(), range, meta()});
  PyramidWriter pyramid(writer, range);
  CastTotals totals = no_totals(run_.scene);
  casting_->cast(
      *tiling_, [&] { return next_in(range); }, pyramid,
      [&](const TileGroupWork& group) {
        add_totals(totals, group);
        run_.progress("mesh", 0);
      });
  writer.finish(encode_found(totals, nullptr), false);
}

void Pieces::settle(const TreeRange& home) {
  if (home.first == home_.first && home.end == home_.end) return;
  if (tiling_) finish_counting();
  waiting_.reset();
  const bool counts = run_.counts && !tiling_;
  tiling_ = &facets_.tile(home, counts, true);
  counting_ = counts && !in_memory();
  home_ = home, reached_ = 0;
  if (!casting_) casting_.emplace(run_, engine_maker(run_.options.engine, meta().frame(), [&] { return run_.of_solids(facets_.in_memory()); }));
}

// The facets of bins are counted as the groups are taken.
void Pieces::finish_counting() {
  if (run_.counts && !tiling_) settle(TreeRange{});  // every piece was there already
  if (counting_) tiling_->pass(~uint64_t{0}, run_.threads, [&](uint64_t) { run_.progress("mesh", 0); });
  counting_ = false;
}

// Groups before the range lie in pieces that others make or have made, and are passed by.
std::optional<TileGroup> Pieces::next_in(const TreeRange& range) {
  if (in_memory()) tiling_->skip_to(range.first);
  if (!waiting_) waiting_ = tiling_->next();
  if (!waiting_) return std::nullopt;
  const uint64_t key = tree_key(waiting_->cu, waiting_->cv);
  if (!waiting_->passed && key >= range.end) return std::nullopt;
  auto group = std::exchange(waiting_, std::nullopt);
  group->passed |= key < range.first;
  return group;
}

MeshReport Pieces::report(const CastTotals& totals) {
  run_.end_phase("cast");
  MeshReport out;
  out.report = make_report(run_.scene, std::move(run_.bodies), facets_.counts(), run_.plan, totals, run_.options.thin);
  out.json = report_json(out.report, run_.scene);
  out.run = std::move(run_.run);
  out.run.threads = run_.threads;
  out.run.engine = run_.options.engine;
  out.run.exact_decisions = totals.exact_decisions;
  out.run.spilled_bytes = facets_.spilled_bytes();
  out.run.peak_memory_bytes = system::peak_bytes() + facets_.held_bytes();
  out.scene = run_.scene;
  out.caps_written = run_.caps();
  return out;
}

std::vector<Pieces::PieceFile> Pieces::files() const {
  const std::string begin = output_.filename().string() + ".piece-";
  const std::filesystem::path folder = output_.has_parent_path() ? output_.parent_path() : ".";
  std::vector<PieceFile> out;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    const std::string name = file.path().filename().string();
    if (!name.starts_with(begin)) continue;
    uint32_t piece = 0, of = 0;
    int used = 0;
    if (std::sscanf(name.c_str() + begin.size(), "%u-of-%u%n", &piece, &of, &used) != 2) continue;
    const std::string rest = name.substr(begin.size() + static_cast<size_t>(used));
    if (rest.empty() || rest == ".partial") out.push_back({file.path(), piece, of, rest.empty()});
  }
  return out;
}

void Pieces::expect_own_files() const {
  for (const PieceFile& file : files()) {
    std::string run;
    try {
      if (file.whole) run = PartReader(file.path).head().run;
    } catch (const FormatError&) {  // it is damaged, so it is made anew
    } catch (const IoError&) {
    }
    if (!run.empty() && run != run_id_)
      throw InputError(fmt::format("{}: can't resume: expected a piece of this run, found one of a run with other inputs or options, or of another "
                                   "version of the program: expected run {}, found {}",
                                   file.path.string(), run_id_, run),
                       Remedy::kFreshStart);
  }
}

void Pieces::remove_files(const std::function<bool(uint32_t piece)>& keep) const {
  for (const PieceFile& file : files()) {
    if (file.whole && file.of == size() && file.piece < size() && keep(file.piece)) continue;
    std::error_code error;
    std::filesystem::remove(file.path, error);
    if (error) throw IoError(fmt::format("{}: can't remove what another run has left: {}", file.path.string(), error.message()));
  }
}

}  // namespace teracell::mesher
