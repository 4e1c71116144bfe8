// teracell_mpi: what `teracell mesh` does, by all processes that mpirun starts. The file has the same bytes.
#include <fmt/format.h>
#include <thread>

#include "store/base/error.hpp"
#include "store/base/system/system.hpp"
#include "tools/cli/commands/mesh_options.hpp"
#include "tools/cli/commands/mesh_summary.hpp"
#include "tools/cli/program.hpp"
#include "tools/mpi/conductor.hpp"

namespace {

using namespace teracell;
using namespace teracell::mpi;
using std::chrono::milliseconds;

// Of the cores that this rank may use, its share when other ranks may use the same ones.
int default_threads(const Ranks& ranks) {
  const std::string set = system::core_set();
  if (set.empty()) return std::max(1, system::cores() / ranks.on_this_machine());
  return std::max(1, system::cores() / ranks.with_same({reinterpret_cast<const uint8_t*>(set.data()), set.size()}));
}

// Ranks would each take some of what can be read only once.
void expect_files(const mesher::Scene& scene) {
  for (const mesher::SceneBody& body : scene.bodies)
    if (std::error_code ignored; std::filesystem::exists(body.mesh, ignored) && !std::filesystem::is_regular_file(body.mesh, ignored))
      throw InputError(fmt::format("{}: expected a file, which every rank can read, found something else", body.mesh.string()));
}

// A rank whose launcher is gone would work on beside the next job for the same output.
void expect_launcher(const Ranks& ranks) {
  if (!ranks.is_orphan()) return;
  cli::warn(fmt::format("teracell_mpi: {}: what has started this process is gone, and with it the job", ranks.name()));
  std::_Exit(1);
}

// Rank 0 tells the user, and ends the job. On another rank it returns if rank 0 has the grid in place already.
void end_job(Ranks& ranks, const cli::Failure& failure) {
  if (ranks.rank() != 0) {
    Bytes body;
    put_varint(body, static_cast<uint64_t>(failure.status));
    put_sized(body, failure.message);
    ranks.send(0, Tag::kFailed, std::move(body));
    for (int i = 0; i < 1000; ++i) {
      expect_launcher(ranks);
      if (const auto message = ranks.receive(); message && message->tag == Tag::kEnd) return;
      std::this_thread::sleep_for(milliseconds(10));
    }
  }
  cli::warn("teracell_mpi: " + failure.message);
  ranks.abort(failure.status);
}

cli::Failure failure_of(const Ranks& ranks, const CLI::App& command) {
  try {
    throw;
  } catch (const RankFailed& e) {
    return {e.status, e.what()};
  } catch (...) {
    const cli::Failure failure = cli::current_failure(command);
    return {failure.status, fmt::format("{}: {}", ranks.name(), failure.message)};
  }
}

void mesh_together(Ranks& ranks, const CLI::App& command, const cli::MeshArguments& arguments, int threads) {
  const std::atomic<bool>& interrupted = cli::watch_interrupts();
  const bool first = ranks.rank() == 0;
  const mesher::Scene scene = scene_from(arguments);
  if (first) check_outputs(arguments, scene);
  if (ranks.size() > 1) expect_files(scene);
  mesher::MeshOptions options = mesh_options(arguments, ranks.on_this_machine());
  if (options.threads == 0) options.threads = threads;
  const std::filesystem::path output = arguments.output;

  Caster caster(scene, output, options, static_cast<uint32_t>(ranks.rank()), static_cast<uint32_t>(ranks.size()));
  std::optional<Conductor> conductor;
  std::function<void()> attend;
  Member member(ranks, caster, output, options.threads, [&] { attend(); });
  attend = [&] {
    expect_launcher(ranks);
    if (interrupted && (!conductor || !conductor->complete()))
      throw Interrupted(fmt::format("{}: interrupted: nothing was written", arguments.output));
    while (const auto message = ranks.receive()) {
      member.take(*message);
      if (conductor) conductor->take(*message);
    }
  };
  try {
    if (first) conductor.emplace(ranks, caster, member, arguments);
    constexpr milliseconds kShortest{1}, kLongest{5};
    for (milliseconds pause = kShortest; !member.ended();) {
      attend();
      bool busy = member.step();
      if (conductor) busy |= conductor->step();
      pause = busy ? kShortest : std::min(pause * 2, kLongest);
      if (!busy) std::this_thread::sleep_for(pause);
    }
  } catch (...) {
    cli::Failure failure = failure_of(ranks, command);
    if (first && conductor) {
      if (const uint32_t pieces = conductor->clean_up(); pieces > 0)
        failure.message += fmt::format(" ({} of the grid {} kept: go on with --resume, or remove {}.piece-*)",
                                       pieces == 1 ? "1 piece" : fmt::format("{} pieces", pieces), pieces == 1 ? "is" : "are", arguments.output);
      conductor.reset();
    }
    caster.stop(milliseconds(1000));
    end_job(ranks, failure);  // before the caster is waited for
    member.take({0, Tag::kEnd, {}});
  }
  const mesher::MeshReport report = first ? conductor->report() : mesher::MeshReport();
  conductor.reset();  // clears the line of progress
  if (!first) return;
  warn_of_caps(arguments, report);
  cli::say_grid(arguments.output, report);
}

}  // namespace

int main(int argc, char** argv) {
  cli::begin_program();
  Ranks ranks(argc, argv);
  const int threads = default_threads(ranks);  // before any rank may fail, because all of them are asked
  CLI::App app("Trillion-cell Cartesian grids from CAD surfaces, by the processes that mpirun starts.", "teracell_mpi");
  app.set_version_flag("--version", TERACELL_VERSION);
  app.require_subcommand(1);
  CLI::App& mesh = *app.add_subcommand("mesh", "mesh a scene or bare surfaces into a .tcell file: the same bytes as those of `teracell mesh`");
  cli::MeshArguments arguments;
  add_mesh_options(mesh, arguments, true);
  mesh.footer(
      "Example:\n  mpirun -n 64 teracell_mpi mesh scene.json --step 0.05 -o scene.tcell\n"
      "All ranks must see the folder of the output. Threads and memory are those of one rank.");
  std::vector<std::string> words(argv + 1, argv + argc);
  // Nothing begins unless it can on all ranks: a launcher may give each its own arguments.
  constexpr int kRefused = 0, kTold = 1, kGoOn = 2;
  int outcome = kGoOn;
  std::string refusal;
  try {
    ranks.expect_own_launcher();
    const bool meshes = !words.empty() && words[0] == "mesh";
    cli::refuse_unknown_options(meshes ? mesh : app, words);
    app.parse(std::vector(words.rbegin(), words.rend()));  // CLI11 takes them from the back
  } catch (const CLI::ParseError& e) {
    outcome = e.get_exit_code() == 0 ? kTold : kRefused;
    if (outcome == kRefused) refusal = fmt::format("{}. See: teracell_mpi mesh --help", cli::explain(e, app.get_subcommands().empty() ? app : mesh));
    else if (ranks.rank() == 0) app.exit(e);
  } catch (const UsageError& e) {
    outcome = kRefused;
    refusal = e.what();
  }
  const int refuser = ranks.least(outcome == kRefused ? ranks.rank() : ranks.size());
  if (refuser == ranks.rank()) cli::warn(fmt::format("teracell_mpi: {}{}", refuser == 0 ? "" : ranks.name() + ": ", refusal));
  if (refuser < ranks.size()) return 2;
  if (ranks.least(outcome) == kTold) return 0;
  try {
    mesh_together(ranks, mesh, arguments, threads);
  } catch (...) {
    end_job(ranks, failure_of(ranks, mesh));
  }
  while (!ranks.sent_all()) std::this_thread::sleep_for(milliseconds(1));
  return 0;
}
