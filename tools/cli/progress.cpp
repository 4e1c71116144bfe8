#include "tools/cli/progress.hpp"

#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "server/operations/metrics.hpp"
#include "store/base/system/system.hpp"
#include "store/base/wanted.hpp"
#include "store/grid/number_text.hpp"
#include "tools/cli/command.hpp"

namespace teracell::cli {
namespace {

std::string duration(double seconds) {
  if (seconds < 60) return fmt::format("{:.0f} s", seconds);
  if (seconds < 3600) return fmt::format("{} min {:02} s", static_cast<int>(seconds / 60), static_cast<int>(seconds) % 60);
  return fmt::format("{} h {:02} min", static_cast<int>(seconds / 3600), static_cast<int>(seconds / 60) % 60);
}

}  // namespace

ProgressLine::ProgressLine(const std::string& mode, std::string counted_phase) : counted_phase_(std::move(counted_phase)) {
  mode_ = mode == "plain" ? Mode::kPlain : mode == "auto" && isatty(STDERR_FILENO) ? Mode::kLine : Mode::kNone;
}

ProgressLine::~ProgressLine() {
  if (shown_ && mode_ == Mode::kLine) std::fputs("\r\033[K", stderr);
}

void ProgressLine::operator()(const char* phase, double share) {
  Wanted::stop_if_not();
  if (mode_ == Mode::kNone) return;
  const Clock::time_point now = Clock::now();
  const bool begins = phase_ != phase;
  if (begins) phase_ = phase, phase_start_ = now;
  const auto pause = mode_ == Mode::kLine ? std::chrono::milliseconds(100) : std::chrono::milliseconds(2000);
  if (!begins && now - last_ < pause) return;
  last_ = now;
  const double seconds = std::chrono::duration<double>(now - phase_start_).count();
  std::string line = fmt::format("{:<6} {:5.1f} %", phase, 100 * share);
  if (share > 0 && seconds > 0.5) {
    if (cells_ > 0 && phase_ == counted_phase_) line += fmt::format(", {} cells/s", number_text(cells_ * share / seconds, 3));
    line += fmt::format(", {} left", duration(seconds * (1 - share) / share));
  }
  line += ", " + bytes_text(static_cast<double>(system::resident_bytes()));
  // Not fmt::print(), which throws when stderr is closed: work must not fail for that.
  std::fputs((mode_ == Mode::kLine ? "\r\033[K" + line : line + "\n").c_str(), stderr);
  std::fflush(stderr);
  shown_ = true;
}

}  // namespace teracell::cli
