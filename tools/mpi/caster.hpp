// The thread of a rank that reads the surfaces and makes pieces, while the rank's main thread talks to others and copies.
#pragma once
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>

#include "mesher/parts/pieces.hpp"

namespace teracell::mpi {

class Caster {
 public:
  // Keeps references. With options.resume it finds those that are made already of the pieces rank, rank + ranks ...
  Caster(const mesher::Scene& scene, const std::filesystem::path& output, const mesher::MeshOptions& options, uint32_t rank, uint32_t ranks);
  ~Caster();  // as soon as the thread notices that it shall stop

  struct Event {
    enum Kind { kPrepared, kMade, kFinished } kind;
    uint32_t piece = 0;
  };
  std::optional<Event> next_event();  // throws what the thread has thrown
  void make(const mesher::PieceQueue::Order& order);
  void make_no_more();
  // Whether the thread has ended this long after it was told to.
  bool stop(std::chrono::milliseconds patience);

  // After kPrepared. Other threads may use what is const.
  mesher::Pieces& pieces() { return *pieces_; }
  const std::vector<uint32_t>& kept() const { return kept_; }
  // Of the thread's work before it makes pieces, and the share that is done.
  std::pair<const char*, double> progress() const { return {phase_, share_}; }

 private:
  void run(uint32_t rank, uint32_t ranks);
  void tell(const Event& event);

  const mesher::Scene& scene_;
  const std::filesystem::path& output_;
  const mesher::MeshOptions& options_;
  std::atomic<bool> stop_ = false;
  std::atomic<const char*> phase_ = "read";
  std::atomic<double> share_ = 0;
  std::unique_ptr<mesher::Pieces> pieces_;
  std::vector<uint32_t> kept_;

  std::mutex mutex_;  // of what follows
  std::condition_variable changed_;
  std::deque<Event> events_;
  std::deque<mesher::PieceQueue::Order> orders_;
  std::exception_ptr error_;
  bool no_more_ = false, ended_ = false;
  std::thread thread_;  // last: it uses the others
};

}  // namespace teracell::mpi
