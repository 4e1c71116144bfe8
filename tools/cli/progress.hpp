// Progress on stderr: phase, share, rate, time left, memory. On a terminal one line that renews itself; "plain" prints
// a line every few seconds; silent when stderr is no terminal.
#pragma once
#include <chrono>
#include <string>

namespace teracell {

class ProgressLine {
 public:
  // `mode` is auto, plain or none. `unit_total` cells are done when the share of `counted_phase` is 1: for the rate.
  ProgressLine(const std::string& mode, std::string counted_phase);
  ~ProgressLine();  // clears the line
  void set_cells(double total) { cells_ = total; }
  void operator()(const char* phase, double share);

 private:
  enum class Mode { kLine, kPlain, kNone };
  using Clock = std::chrono::steady_clock;
  Mode mode_;
  std::string counted_phase_, phase_;
  double cells_ = 0;
  Clock::time_point phase_start_, last_;
  bool shown_ = false;
};

}  // namespace teracell
