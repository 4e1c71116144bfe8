// A command of the program: one file each, one line in the registry of teracell.cpp. setup() declares the options and
// returns what runs once they are parsed; run throws, main() turns that into an exit status.
#pragma once
#include <array>
#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "store/grid.hpp"

namespace teracell {

using Run = std::function<void()>;

Run setup_mesh(CLI::App& app);
Run setup_info(CLI::App& app);
Run setup_slice(CLI::App& app);
Run setup_column(CLI::App& app);
Run setup_stats(CLI::App& app);
Run setup_export(CLI::App& app);
Run setup_verify(CLI::App& app);
Run setup_sample(CLI::App& app);
Run setup_serve(CLI::App& app);

// ---- what the commands share ------------------------------------------------------------------------------------

// Numbers separated by commas. Throws UsageError naming `option` unless there are `count` whole numbers.
std::vector<int64_t> parse_integers(const std::string& text, size_t count, const std::string& option);
uint64_t parse_size(const std::string& text, const std::string& option);  // bytes; K, M, G, T are powers of 1024
int parse_axis(const std::string& text);  // "x", "y", "z"
void check_level(const Grid& grid, int level);
// Throws UsageError unless 0 <= lo < hi <= the level's cells on the axis.
void check_region(const Grid& grid, int level, int axis, int64_t lo, int64_t hi);
Box parse_region(const std::string& text, const Grid& grid, int level);
void add_threads(CLI::App& app, int& threads);  // 0 until given, for one a core
int threads_or_all(int threads);
void add_progress(CLI::App& app, std::string& mode);
CLI::Validator one_of(std::vector<std::string> words);
// A line on stdout or, a warning, on stderr. It may hold names from anybody's file: nothing in them steers the terminal.
void say(const std::string& line);
void warn(const std::string& line);
std::string bytes_text(double bytes);                       // "1.2 kB"
// Throws UsageError if writing `output`, by way of its temporary, would overwrite one of `inputs`; empty names are none.
void refuse_overwriting(const std::vector<std::string>& inputs, const std::string& output);
// From here on SIGINT and SIGTERM set the flag instead of killing the program, so that its partial file is removed.
const std::atomic<bool>& watch_interrupts();
void stop_if(const std::atomic<bool>& stop, const std::string& output);  // throws Interrupted

}  // namespace teracell
