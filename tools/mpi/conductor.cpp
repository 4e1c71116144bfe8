#include "tools/mpi/conductor.hpp"

#include <random>

#include <fmt/format.h>

#include "mesher/run/part_found.hpp"
#include "store/base/error.hpp"
#include "tools/cli/commands/mesh_summary.hpp"

namespace teracell::mpi {

Conductor::Conductor(Ranks& ranks, Caster& caster, const Member& self, const cli::MeshArguments& arguments)
    : ranks_(ranks), caster_(caster), self_(self), arguments_(arguments), line_(arguments.progress, "mesh") {
  if (!arguments.report.empty()) report_file_.emplace(arguments.report);
  const std::string text = fmt::format("{:016x}", std::random_device()() * 0x100000001b3u);
  const std::string name = arguments.output + ".ranks";
  seen_.emplace(name);
  seen_->append({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
  seen_->sync();
  Bytes body;
  put_sized(body, name + ".partial");
  put_sized(body, text);
  ranks_.send_all(Tag::kSee, body);
}

void Conductor::take(const Message& message) {
  ByteReader in(message.body, "a message");
  switch (message.tag) {
    case Tag::kFailed: {
      if (complete_) return;
      const auto status = static_cast<int>(in.varint());
      throw RankFailed(status, take_text(in));
    }
    case Tag::kPrepared: return take_prepared(message);
    case Tag::kAsk: return queue_ ? answer(message.from) : asking_.push_back(message.from);
    case Tag::kMade:
      owner_[in.varint()] = message.from;
      --has_[message.from];
      ++made_;
      return;
    case Tag::kCopied: ++copied_; return;
    case Tag::kSynced:
      ++synced_;
      memory_ += in.varint();
      return;
    default: return;
  }
}

// Ranks have to agree on what they make.
void Conductor::take_prepared(const Message& message) {
  ByteReader in(message.body, "a message");
  const std::string run = take_text(in);
  const uint64_t pieces = in.varint();
  if (run_ && (run != *run_ || pieces != owner_.size()))
    throw InputError(
        fmt::format("rank {} has other inputs, or another version of the program, than the ranks that were ready before it: expected {} pieces "
                    "of run {}, found {} of {}",
                    message.from, owner_.size(), *run_, pieces, run));
  if (!run_) run_ = run, owner_.resize(pieces, -1);
  threads_ += static_cast<int>(in.varint());
  in_memory_ &= in.varint() != 0;
  while (in.remaining() > 0) {
    owner_[in.varint(0, pieces - 1, "piece")] = message.from;
    ++made_;
  }
  ++prepared_;
}

void Conductor::begin() {
  const mesher::Pieces& pieces = caster_.pieces();
  if (arguments_.resume) pieces.expect_own_files();
  assembly_.emplace(arguments_.output, pieces.meta());
  pieces.remove_files([&](uint32_t piece) { return owner_[piece] >= 0; });
  std::vector<uint32_t> missing;
  for (uint32_t piece = 0; piece < owner_.size(); ++piece)
    if (owner_[piece] < 0) missing.push_back(piece);
  if (in_memory_) mesher::last_by_cost(missing, ranks_.size(), [&](uint32_t piece) { return pieces.cost(piece); });
  queue_.emplace(std::move(missing), in_memory_ ? 1 : static_cast<uint32_t>(ranks_.size()));
  has_.resize(ranks_.size());
  for (const int rank : asking_) answer(rank);
}

// A rank has two pieces, so that it needn't wait for the next one. Towards the end it has one, and others make those that are left; it asks again
// when its own is made.
void Conductor::answer(int rank) {
  if (has_[rank] > 0 && queue_->left() < 2 * has_.size()) return;
  Bytes body;
  if (const auto order = queue_->next(in_memory_ ? 0 : static_cast<uint32_t>(rank))) {
    for (const uint32_t n : {order->piece, order->first, order->end}) put_varint(body, n);
    ++has_[rank];
  }
  ranks_.send(rank, Tag::kMake, std::move(body));
}

bool Conductor::step() {
  show_progress();
  if (!queue_) {
    if (prepared_ < ranks_.size()) return false;
    begin();
    return true;
  }
  if (placed_ < owner_.size()) {
    if (owner_[placed_] < 0 || !place()) return false;
    if (placed_ < owner_.size()) return true;
  }
  if (copied_ == owner_.size()) {
    ++copied_;
    ranks_.send_all(Tag::kSync);
    return true;
  }
  if (synced_ < ranks_.size() || !self_.finished()) return false;
  synced_ = 0;
  finish();
  return true;
}

// The next piece in order. Whoever made it copies it: its machine has the bytes in memory. False while a network file system does not show a
// piece that another machine has made.
bool Conductor::place() {
  if (std::error_code error; !std::filesystem::exists(caster_.pieces().path(placed_), error) && owner_[placed_] != 0) {
    const auto now = std::chrono::steady_clock::now();
    if (!missed_) missed_ = now;
    if (now - *missed_ < kPatience) return false;
  }
  missed_.reset();
  const auto part = caster_.pieces().open(placed_);
  Bytes body;
  put_varint(body, placed_);
  for (const mesher::Placed& place : assembly_->add(*part)) put_varint(body, place.to), put_varint(body, place.bytes);
  const mesher::PartFound found = mesher::decode_found(part->found(), part->name());
  if (totals_.cells.empty()) totals_ = found.totals;
  else totals_.add(found.totals);
  ranks_.send(owner_[placed_++], Tag::kCopy, std::move(body));
  return true;
}

void Conductor::finish() {
  const auto began = std::chrono::steady_clock::now();
  mesher::Pieces& pieces = caster_.pieces();
  report_ = pieces.report(totals_);
  assembly_->finish(report_.json, totals_.crossings, totals_.sums);
  complete_ = true;
  pieces.commit_caps();
  mesher::RunReport& run = report_.run;
  run.phases.push_back({"finish", std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count()});
  run.threads = threads_;
  run.peak_memory_bytes = memory_;
  run.file_bytes = assembly_->bytes();
  if (report_file_) cli::write_report(report_, *report_file_, arguments_.output);
  ranks_.send_all(Tag::kEnd);
}

void Conductor::show_progress() {
  const auto pieces = static_cast<double>(owner_.size());
  if (!queue_) {
    const auto [phase, share] = caster_.progress();
    line_(phase, share);
    return;
  }
  double cells = 1;
  for (const int64_t n : caster_.pieces().meta().grid.cells()) cells *= static_cast<double>(n);
  line_.set_cells(cells);
  if (made_ < owner_.size()) line_("mesh", made_ / pieces);
  else line_("write", std::min<double>(copied_, pieces) / pieces);
}

uint32_t Conductor::clean_up() {
  if (!queue_) return 0;
  assembly_.reset();
  try {
    caster_.pieces().remove_files([&](uint32_t piece) { return !complete_ && owner_[piece] >= 0; });
  } catch (const IoError&) {  // what has failed first is told
  }
  return complete_ ? 0 : made_;
}

}  // namespace teracell::mpi
