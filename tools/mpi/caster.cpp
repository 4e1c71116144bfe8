#include "tools/mpi/caster.hpp"

namespace teracell::mpi {

Caster::Caster(const mesher::Scene& scene, const std::filesystem::path& output, const mesher::MeshOptions& options, uint32_t rank, uint32_t ranks)
    : scene_(scene), output_(output), options_(options), thread_([this, rank, ranks] {
        try {
          run(rank, ranks);
        } catch (...) {
          std::lock_guard lock(mutex_);
          error_ = std::current_exception();
        }
        std::lock_guard lock(mutex_);
        ended_ = true;
        changed_.notify_all();
      }) {}

Caster::~Caster() {
  stop(std::chrono::milliseconds(0));
  thread_.join();
}

bool Caster::stop(std::chrono::milliseconds patience) {
  stop_ = true;
  std::unique_lock lock(mutex_);
  changed_.notify_all();
  return changed_.wait_for(lock, patience, [&] { return ended_; });
}

void Caster::run(uint32_t rank, uint32_t ranks) {
  const mesher::Progress progress = [this](const char* phase, double share, double) { phase_ = phase, share_ = share; };
  pieces_ = std::make_unique<mesher::Pieces>(scene_, output_, options_, rank == 0, progress, stop_);
  if (options_.resume)
    for (uint32_t piece = rank; piece < pieces_->size(); piece += ranks)
      if (pieces_->is_made(piece)) kept_.push_back(piece);
  tell({Event::kPrepared});
  for (;;) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return stop_ || no_more_ || !orders_.empty(); });
    if (stop_) return;
    if (orders_.empty()) break;
    const mesher::PieceQueue::Order order = orders_.front();
    orders_.pop_front();
    lock.unlock();
    pieces_->make(order);
    tell({Event::kMade, order.piece});
  }
  if (rank == 0) pieces_->finish_counting();
  tell({Event::kFinished});
}

void Caster::tell(const Event& event) {
  std::lock_guard lock(mutex_);
  events_.push_back(event);
}

std::optional<Caster::Event> Caster::next_event() {
  std::lock_guard lock(mutex_);
  if (error_) std::rethrow_exception(error_);
  if (events_.empty()) return std::nullopt;
  const Event event = events_.front();
  events_.pop_front();
  return event;
}

void Caster::make(const mesher::PieceQueue::Order& order) {
  std::lock_guard lock(mutex_);
  orders_.push_back(order);
  changed_.notify_all();
}

void Caster::make_no_more() {
  std::lock_guard lock(mutex_);
  no_more_ = true;
  changed_.notify_all();
}

}  // namespace teracell::mpi
