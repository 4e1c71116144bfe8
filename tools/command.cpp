#include "tools/command.hpp"

#include <charconv>
#include <csignal>
#include <thread>

#include <fmt/format.h>

#include "mesher/scene_names.hpp"
#include "store/error.hpp"

namespace teracell {
namespace {

std::atomic<bool> interrupted{false};  // set by the signal handler, which can reach nothing else

}  // namespace

const std::atomic<bool>& watch_interrupts() {
  struct sigaction action {};
  action.sa_handler = [](int) { interrupted = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGHUP, &action, nullptr);
  return interrupted;
}

void stop_if(const std::atomic<bool>& stop, const std::string& output) {
  if (stop) throw Interrupted(fmt::format("{}: interrupted: nothing was written", output));
}

std::vector<int64_t> parse_integers(const std::string& text, size_t count, const std::string& option) {
  std::vector<int64_t> out;
  const char *at = text.data(), *end = at + text.size();
  bool good = true;
  while (good) {
    int64_t value;
    const auto [rest, error] = std::from_chars(at, end, value);
    good = error == std::errc() && (rest == end || *rest == ',');
    if (good) out.push_back(value);
    if (!good || rest == end) break;
    at = rest + 1;
  }
  if (!good || out.size() != count)
    throw UsageError(fmt::format("{}: expected {}, found '{}'", option, count == 1 ? "a whole number" : fmt::format("{} whole numbers separated by commas", count), text));
  return out;
}

int parse_axis(const std::string& text) {
  if (text != "x" && text != "y" && text != "z") throw UsageError(fmt::format("--axis: expected x, y or z, found '{}'", text));
  return text[0] - 'x';
}

Box parse_region(const std::string& text, const Grid& grid, int level) {
  const auto n = parse_integers(text, 6, "--region");
  const Box box{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
  const Index3 cells = grid.cells(level);
  for (int d = 0; d < 3; ++d)
    if (box.lo[d] < 0 || box.hi[d] > cells[d] || box.lo[d] >= box.hi[d])
      throw UsageError(fmt::format("--region: along {} it must lie in 0 to {} (half open) on level {} and not be empty, found {} to {}", axis_name(d),
                                   cells[d], level, box.lo[d], box.hi[d]));
  return box;
}

void refuse_overwriting(const std::string& input, const std::string& output) {
  if (output.empty()) return;
  std::error_code none;  // a file that is not there is no other file
  for (const std::string& name : {output, output + ".partial"})
    if (name == input || std::filesystem::equivalent(name, input, none))
      throw UsageError(fmt::format("{}: an input would be overwritten: give the output another name", output));
}

void say(const std::string& line) { fmt::print("{}\n", printable(line)); }

// Not fmt::print: it throws when nobody listens, and work must not fail for that.
void warn(const std::string& line) { std::fputs((printable(line) + "\n").c_str(), stderr); }

int default_threads() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

}  // namespace teracell
