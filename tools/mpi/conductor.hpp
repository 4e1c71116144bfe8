// What rank 0 does besides: hands out the pieces, decides where their bytes go, and finishes the file.
#pragma once
#include <optional>

#include "mesher/bodies/assembly.hpp"
#include "tools/cli/commands/mesh_options.hpp"
#include "tools/cli/progress.hpp"
#include "tools/mpi/member.hpp"

namespace teracell::mpi {

// A rank has failed; the message names it.
struct RankFailed : std::runtime_error {
  RankFailed(int exit_status, const std::string& message) : std::runtime_error(message), status(exit_status) {}
  int status;
};

class Conductor {
 public:
  // Keeps references. Asks all ranks whether they see the folder of the output.
  Conductor(Ranks& ranks, Caster& caster, const Member& self, const cli::MeshArguments& arguments);
  void take(const Message& message);  // throws RankFailed
  bool step();                        // whether there was anything to do
  // When the work has failed: removes what can't be used any more, and says how many pieces can be.
  uint32_t clean_up();
  bool complete() const { return complete_; }  // the grid is in place
  const mesher::MeshReport& report() const { return report_; }  // when the file is there

 private:
  void take_prepared(const Message& message);
  void begin();
  void answer(int rank);
  bool place();
  void finish();
  void show_progress();

  Ranks& ranks_;
  Caster& caster_;
  const Member& self_;
  const cli::MeshArguments& arguments_;
  std::optional<OutputFile> seen_;  // by all; as long as it is there, a second job for this output is refused
  cli::ProgressLine line_;
  std::optional<OutputFile> report_file_;
  std::optional<std::string> run_;
  bool in_memory_ = true;              // all facets, on every rank
  std::vector<int> owner_;             // of each piece that is there, or -1
  std::vector<int> asking_;            // before there is a queue
  std::vector<int> has_;               // pieces that were given to each rank and are not made
  std::optional<mesher::PieceQueue> queue_;
  std::optional<mesher::Assembly> assembly_;
  mesher::CastTotals totals_;
  bool complete_ = false;
  uint32_t made_ = 0, placed_ = 0, copied_ = 0;
  uint64_t memory_ = 0;
  std::optional<std::chrono::steady_clock::time_point> missed_;  // when the next piece was not to be seen
  int prepared_ = 0, synced_ = 0, threads_ = 0;
  mesher::MeshReport report_;
};

}  // namespace teracell::mpi
