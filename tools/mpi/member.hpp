// What every rank does, rank 0 among them: makes pieces, and copies pieces to their places in the file of the grid.
#pragma once
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>

#include "mesher/bodies/assembly.hpp"
#include "mesher/parts/pieces.hpp"
#include "tools/mpi/ranks.hpp"

namespace teracell::mpi {

// The thread of a rank that reads the surfaces and makes pieces, while the rank's main thread talks to others and copies.
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

// How long another machine may take to see a new file: network file systems remember for some seconds that there was none.
inline constexpr std::chrono::seconds kPatience{30};

class Member {
 public:
  // Keeps references. `attend` is called while copying takes long.
  Member(Ranks& ranks, Caster& caster, const std::filesystem::path& output, int threads, std::function<void()> attend);
  void take(const Message& message);
  bool step();  // whether there was anything to do
  bool ended() const { return ended_; }
  bool finished() const { return finished_; }  // nothing is to be made any more

 private:
  struct Copy {
    uint32_t piece;
    std::vector<mesher::Placed> places;
  };
  bool look_for_file();
  void tell_prepared();
  void copy();

  Ranks& ranks_;
  Caster& caster_;
  const std::filesystem::path& output_;
  const int threads_;
  const std::function<void()> attend_;
  std::string seen_path_, seen_text_;  // a file of rank 0, and what is in it; empty when it was seen
  std::chrono::steady_clock::time_point look_until_;
  bool told_ = false, prepared_ = false, seen_ = false, sync_ = false, ended_ = false, finished_ = false;
  std::deque<Copy> copies_;
  std::vector<uint32_t> copied_;  // their files go when the grid is in place
  std::optional<FileRoom> file_;
};

}  // namespace teracell::mpi
