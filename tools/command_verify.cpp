// teracell verify: every byte and every invariant.
#include <fmt/format.h>

#include "store/reader.hpp"
#include "tools/command.hpp"
#include "tools/progress.hpp"

namespace teracell {
namespace {

struct Options {
  std::string grid, progress = "auto";
  int threads = default_threads();
};

void run(const Options& o) {
  const GridReader reader(o.grid);
  {
    ProgressLine line(o.progress, "");
    reader.verify(o.threads, [&](double share) { line("verify", share); });
  }
  uint64_t chunks = 0;
  for (const LevelInfo& l : reader.meta().levels) chunks += l.chunks;
  say(fmt::format("{}: sound. {} bytes, {} chunks on {} levels: every checksum holds, every level is the union of the one below, every byte is accounted for.",
                  o.grid, reader.file_bytes(), chunks, reader.meta().levels.size()));
}

}  // namespace

Run setup_verify(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  app.add_option("grid", o->grid, "a .tcell file")->required();
  app.add_option("--threads", o->threads, "how many (default: one a core)")->check(CLI::Range(1, 1024));
  app.add_option("--progress", o->progress, "on stderr: auto (if it is a terminal), plain, none")->check(CLI::IsMember({"auto", "plain", "none"}));
  return [o] { run(*o); };
}

}  // namespace teracell
