// What the commands share. Each command has a file of its own and one line in commands.cpp. Its setup declares the options, and
// returns what is to run once they are parsed. What that throws, main() turns into an exit status and a paragraph on stderr.
#pragma once
#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "mesher/cad/idle_kernels.hpp"
#include "mesher/surface/read_options.hpp"
#include "store/base/wanted.hpp"
#include "store/read/reader.hpp"
#include "store/remote/sources.hpp"

namespace teracell::cli {

using Run = std::function<void()>;

// Numbers separated by commas. Throws UsageError naming `option` unless there are `count` whole numbers.
std::vector<int64_t> parse_integers(const std::string& text, size_t count, const std::string& option);
// A whole number from `least` to `most`. Throws UsageError naming `option`.
int64_t parse_integer(const std::string& text, int64_t least, int64_t most, const std::string& option);
uint64_t parse_size(const std::string& text, const std::string& option);  // bytes; K, M, G, T are powers of 1024
int parse_axis(const std::string& text);  // "x", "y", "z"
void check_level(const Grid& grid, int level);
// Throws UsageError unless 0 <= lo < hi <= the level's cells on the axis.
void check_region(const Grid& grid, int level, int axis, int64_t lo, int64_t hi);
// The cell of level 0 that a coordinate lies in. Throws UsageError naming `option` unless that is in the grid.
int64_t cell_of(double coordinate, const Metadata& meta, int axis, const char* option);
Box parse_region(const std::string& text, const Grid& grid, int level);
// A grid that a command reads: a file or an address.
struct GridArgument {
  std::string name;
  SourceOptions source;
};
void add_grid(CLI::App& app, GridArgument& grid, const char* file = "a .tcell file");
void add_source_options(CLI::App& app, SourceOptions& source);  // --cache-dir and so on, which add_grid() adds, too
GridReader open_grid(const GridArgument& grid, std::shared_ptr<ChunkKeeper> keeper = nullptr);
void add_threads(CLI::App& app, int& threads);  // stays 0, which means one per core, unless it is given
int threads_or_all(int threads);
// What the CAD kernel may take that reads STEP files.
struct CadArguments {
  std::string memory;
  double seconds = mesher::CadOptions{}.seconds;
  std::shared_ptr<mesher::IdleKernels> kernels = std::make_shared<mesher::IdleKernels>();
  mesher::CadOptions options() const;
};
void add_cad_limits(CLI::App& app, CadArguments& cad);
void add_progress(CLI::App& app, std::string& mode);
// An option with a value, or a switch if `argument` is empty: take() gets the value.
void add_word(CLI::App& app, const std::string& name, const std::string& argument, const std::string& help,
              const std::function<void(std::string)>& take);
CLI::Validator one_of(std::vector<std::string> words);
CLI::Validator in_range(double lo, double hi);
// Prints a line on stdout, or a warning on stderr. The line may hold names from anybody's file, which must not steer the terminal.
void say(const std::string& line);
void warn(const std::string& line);
std::string bytes_text(double bytes);  // "1.2 kB"
// Throws UsageError if writing `output`, by way of its temporary file, would overwrite one of `inputs`. Empty names are skipped.
void refuse_overwriting(const std::vector<std::string>& inputs, const std::string& output);
// The same, and warns of what a killed run has left in place of `output`: it goes when the output is begun.
void check_output(const std::vector<std::string>& inputs, const std::string& output);
// From here on SIGINT, SIGTERM and SIGHUP set the flag instead of killing the program, so that it can remove its partial file.
const std::atomic<bool>& watch_interrupts();
// A signal ends what is done while it lives, on this thread and by workers for it, with Interrupted: `output` and what became of it.
[[nodiscard]] Wanted until_interrupted(const std::string& output, const std::string& outcome = "nothing was written");

}  // namespace teracell::cli
