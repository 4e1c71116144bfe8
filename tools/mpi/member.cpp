#include "tools/mpi/member.hpp"

#include <fstream>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/base/system/system.hpp"

namespace teracell::mpi {

Member::Member(Ranks& ranks, Caster& caster, const std::filesystem::path& output, int threads, std::function<void()> attend)
    : ranks_(ranks), caster_(caster), output_(output), threads_(threads), attend_(std::move(attend)) {}

void Member::take(const Message& message) {
  ByteReader in(message.body, "a message");
  switch (message.tag) {
    case Tag::kSee:
      seen_path_ = take_text(in);
      seen_text_ = take_text(in);
      look_until_ = std::chrono::steady_clock::now() + kPatience;
      break;
    case Tag::kMake:
      if (in.remaining() == 0) caster_.make_no_more();
      else caster_.make({static_cast<uint32_t>(in.varint()), static_cast<uint32_t>(in.varint()), static_cast<uint32_t>(in.varint())});
      break;
    case Tag::kCopy: {
      Copy& copy = copies_.emplace_back(static_cast<uint32_t>(in.varint()));
      while (in.remaining() > 0) copy.places.push_back({in.varint(), in.varint()});
      break;
    }
    case Tag::kSync: sync_ = true; break;
    case Tag::kEnd:
      for (const uint32_t piece : copied_) {
        std::error_code ignored;
        std::filesystem::remove(caster_.pieces().path(piece), ignored);
      }
      ended_ = true;
      break;
    default: break;
  }
}

bool Member::step() {
  bool busy = false;
  if (!seen_ && !seen_path_.empty()) busy |= seen_ = look_for_file();
  for (auto event = caster_.next_event(); event; event = caster_.next_event(), busy = true) {
    if (event->kind == Caster::Event::kPrepared) prepared_ = true;
    if (event->kind == Caster::Event::kFinished) finished_ = true;
    if (event->kind != Caster::Event::kMade) continue;
    Bytes body;
    put_varint(body, event->piece);
    ranks_.send(0, Tag::kMade, std::move(body));
    ranks_.send(0, Tag::kAsk);
  }
  if (prepared_ && seen_ && !told_) tell_prepared();
  if (!copies_.empty()) {
    copy();
    return true;
  }
  if (!sync_) return busy;
  if (file_) file_->sync();
  sync_ = false;
  Bytes body;
  put_varint(body, system::peak_bytes());
  ranks_.send(0, Tag::kSynced, std::move(body));
  return true;
}

bool Member::look_for_file() {
  std::string text;
  std::getline(std::ifstream(seen_path_), text);
  if (text == seen_text_) return true;
  if (std::chrono::steady_clock::now() > look_until_)
    throw IoError(fmt::format("{}: rank 0 has written this file, and it can't be seen here: expected a folder that all ranks share",
                              std::filesystem::absolute(seen_path_).string()));
  return false;
}

void Member::tell_prepared() {
  told_ = true;
  Bytes body;
  put_sized(body, caster_.pieces().run());
  put_varint(body, caster_.pieces().size());
  put_varint(body, static_cast<uint64_t>(threads_));
  put_varint(body, caster_.pieces().in_memory());
  for (const uint32_t piece : caster_.kept()) put_varint(body, piece);
  ranks_.send(0, Tag::kPrepared, std::move(body));
  for (int i = 0; i < 2; ++i) ranks_.send(0, Tag::kAsk);  // one is made while the other one waits
}

void Member::copy() {
  const Copy copy = std::move(copies_.front());
  copies_.pop_front();
  if (!file_) file_.emplace(output_);
  copy_placed(*caster_.pieces().open(copy.piece), copy.places, *file_, attend_);
  copied_.push_back(copy.piece);
  Bytes body;
  put_varint(body, copy.piece);
  ranks_.send(0, Tag::kCopied, std::move(body));
}

}  // namespace teracell::mpi
