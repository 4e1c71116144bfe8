// What every rank does, rank 0 among them: makes pieces, and copies pieces to their places in the file of the grid.
#pragma once
#include <chrono>

#include "mesher/bodies/assembly.hpp"
#include "tools/mpi/caster.hpp"
#include "tools/mpi/ranks.hpp"

namespace teracell::mpi {

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
