// teracell verify: every byte and every invariant.
#include <fmt/format.h>

#include "store/text/text.hpp"
#include "store/whole/verify.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/progress.hpp"

namespace teracell::cli {
namespace {

struct VerifyArguments {
  GridArgument grid;
  std::string progress = "auto";
  int threads = 0;
  bool cells = false;
};

void run_of_part(const VerifyArguments& o) {
  const PartReader part(o.grid.name);
  const uint64_t chunks = verify(part);
  say(fmt::format("{}: sound. Part {} of 0 to {} of a grid, {}, {}: every checksum holds.", o.grid.name, part.head().number, part.head().of - 1,
                  bytes_text(part.file_bytes()), plural(chunks, "chunk")));
}

void run(const VerifyArguments& o) {
  if (!is_address(o.grid.name) && is_part(o.grid.name)) return run_of_part(o);
  const GridReader reader = open_grid(o.grid);
  std::string labels;
  {
    ProgressLine line(o.progress, "");
    labels = verify(reader, threads_or_all(o.threads), [&](double share) { line("verify", share); });
  }
  uint64_t chunks = 0;
  for (const LevelInfo& l : reader.meta().levels()) chunks += l.chunks;
  say(fmt::format("{}: sound. {}, {} on {}: every checksum holds, every level is the union of the one below, every byte is accounted for.",
                  reader.name(), bytes_text(reader.file_bytes()), plural(chunks, "chunk"), plural(reader.meta().levels().size(), "stored level")));
  if (o.cells) say(fmt::format("cells: {}, in any file with the same axes and the same cells", labels));
}

}  // namespace

Run setup_verify(CLI::App& app) {
  const auto o = std::make_shared<VerifyArguments>();
  add_grid(app, o->grid, "a .tcell file or a part of one");
  add_threads(app, o->threads);
  add_progress(app, o->progress);
  app.add_flag("--cells", o->cells, "also print the hash of the cells, which depends neither on the axis of the rays nor on how they are compressed");
  app.footer("Example:\n  teracell verify g.tcell");
  return [o] { run(*o); };
}

}  // namespace teracell::cli
