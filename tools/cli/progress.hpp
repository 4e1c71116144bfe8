// Progress on stderr: phase, share, rate, time left, memory. "auto" renews one line on a terminal and is silent elsewhere; "plain"
// prints a line every two seconds.
#pragma once
#include <chrono>
#include <string>

namespace teracell::cli {

class ProgressLine {
 public:
  // `mode` is auto, plain or none. The rate is shown during `counted_phase`, in which all cells of set_cells() are done.
  ProgressLine(const std::string& mode, std::string counted_phase);
  ~ProgressLine();  // clears the line
  void set_cells(double total) { cells_ = total; }
  void operator()(const char* phase, double share);  // throws what Wanted throws
  void operator()(const char* phase, double share, double cells) { cells_ = cells, (*this)(phase, share); }

 private:
  enum class Mode { kLine, kPlain, kNone };
  using Clock = std::chrono::steady_clock;
  Mode mode_;
  std::string counted_phase_, phase_;
  double cells_ = 0;
  Clock::time_point phase_start_, last_;
  bool shown_ = false;
};

}  // namespace teracell::cli
