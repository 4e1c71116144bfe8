#include "tools/cli/command.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <charconv>
#include <csignal>
#include <thread>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/base/output_file.hpp"
#include "store/text/text.hpp"
#include "store/text/words.hpp"

namespace teracell::cli {
namespace {

std::atomic<bool> signalled{false};  // global because a signal handler can reach nothing else

}  // namespace

const std::atomic<bool>& watch_interrupts() {
  struct sigaction action {};
  action.sa_handler = [](int) { signalled = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGHUP, &action, nullptr);
  return signalled;
}

Wanted until_interrupted(const std::string& output, const std::string& outcome) {
  watch_interrupts();
  return Wanted(
      [=] {
        if (signalled) throw Interrupted(fmt::format("{}: interrupted: {}", output, outcome));
      },
      Wanted::Asked::kByWorkers);
}

std::vector<int64_t> parse_integers(const std::string& text, size_t count, const std::string& option) {
  if (auto out = numbers_in<int64_t>(text, count)) return *std::move(out);
  throw UsageError(fmt::format("{}: expected {}, found '{}'", option,
                               count == 1 ? "a whole number" : fmt::format("{} whole numbers separated by commas", count), text));
}

int64_t parse_integer(const std::string& text, int64_t least, int64_t most, const std::string& option) {
  const int64_t value = parse_integers(text, 1, option)[0];
  if (value < least || value > most) throw UsageError(fmt::format("{}: expected {} to {}, found {}", option, least, most, value));
  return value;
}

uint64_t parse_size(const std::string& text, const std::string& option) {
  uint64_t value = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const std::string_view unit(rest, text.data() + text.size() - rest);
  const size_t power = unit.empty() ? 0 : std::string_view("KMGT").find(unit[0]) + 1;
  const bool good_unit = unit.empty() || (power != 0 && (unit.size() == 1 || unit.substr(1) == "B" || unit.substr(1) == "iB"));
  if (error != std::errc() || rest == text.data() || !good_unit || value > (~uint64_t{0} >> (10 * power)))
    throw UsageError(fmt::format("{}: expected a size like 512M or 8G, found '{}'", option, text));
  return value << (10 * power);
}

int parse_axis(const std::string& text) {
  if (const auto axis = axis_named(text)) return *axis;
  throw UsageError(fmt::format("--axis: expected x, y or z, found '{}'", text));
}

void check_level(const Grid& grid, int level) {
  if (level < 0 || level >= grid.levels()) throw UsageError(fmt::format("--level: expected 0 to {}, found {}", grid.levels() - 1, level));
}

void check_region(const Grid& grid, int level, int axis, int64_t lo, int64_t hi) {
  const int64_t cells = grid.cells(level)[axis];
  if (lo < 0 || hi > cells || lo >= hi)
    throw UsageError(fmt::format("--region: expected a part of 0 to {} (half open, not empty) along {} on level {}, found {} to {}", cells,
                                 axis_name(axis), level, lo, hi));
}

int64_t cell_of(double coordinate, const Metadata& meta, int axis, const char* option) {
  const Axis& a = meta.grid.axis[axis];
  if (!(coordinate >= a.min() && coordinate <= a.max()))
    throw UsageError(fmt::format("{}: expected {} to {} {} along {}, found {}", option, a.min(), a.max(), meta.units, axis_name(axis), coordinate));
  return a.cell_at(coordinate);
}

Box parse_region(const std::string& text, const Grid& grid, int level) {
  const auto n = parse_integers(text, 6, "--region");
  for (int d = 0; d < 3; ++d) check_region(grid, level, d, n[d], n[d + 3]);
  return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
}

void refuse_overwriting(const std::vector<std::string>& inputs, const std::string& output) {
  if (output.empty()) return;
  for (const std::string& name : {output, output + ".partial"}) {
    struct stat a, b;  // std::filesystem::equivalent() would look at the output again for each of 100,000 inputs
    const bool exists = stat(name.c_str(), &a) == 0;
    for (const std::string& input : inputs)
      if (name == input || (exists && stat(input.c_str(), &b) == 0 && a.st_dev == b.st_dev && a.st_ino == b.st_ino))
        throw UsageError(fmt::format("{}: an input would be overwritten: give the output another name", output));
  }
}

void check_output(const std::vector<std::string>& inputs, const std::string& output) {
  refuse_overwriting(inputs, output);
  if (!output.empty() && left_behind(output))
    warn(fmt::format("warning: {}.partial will be thrown away when the file is begun: a killed run has left it", output));
}

void say(const std::string& line) { fmt::print("{}\n", printable(line)); }

// Not fmt::print(), which throws when stderr is closed: work must not fail for that.
void warn(const std::string& line) { std::fputs((printable(line) + "\n").c_str(), stderr); }

std::string bytes_text(double bytes) {
  const char* unit[] = {"B", "kB", "MB", "GB", "TB", "PB", "EB"};
  int i = 0;
  for (; bytes >= 1000 && i < 6; ++i) bytes /= 1000;
  return fmt::format("{:.{}f} {}", bytes, i == 0 ? 0 : 1, unit[i]);
}

CLI::Validator one_of(std::vector<std::string> words) {
  return CLI::Validator(
      [words = std::move(words)](std::string& found) {
        return std::ranges::count(words, found) > 0 ? "" : fmt::format("expected {}, found '{}'", fmt::join(words, ", "), found);
      },
      "");
}

CLI::Validator in_range(double lo, double hi) {
  return CLI::Validator(
      [=](std::string& found) {
        double value;
        return CLI::detail::lexical_cast(found, value) && value >= lo && value <= hi
                   ? ""
                   : fmt::format("expected {:.15g} to {:.15g}, found '{}'", lo, hi, found);
      },
      "");
}

void add_grid(CLI::App& app, GridArgument& grid, const char* file) {
  app.add_option("grid", grid.name, fmt::format("{}, or the address of a grid: https://HOST/PATH or s3://BUCKET/KEY", file))->required();
  add_source_options(app, grid.source);
}

void add_source_options(CLI::App& app, SourceOptions& source) {
  app.add_option("--cache-dir", source.cache_dir, "a folder that keeps what is read from addresses, for the next time");
  app.add_option_function<std::string>(
         "--cache-dir-size", [&source](const std::string& text) { source.cache_dir_bytes = parse_size(text, "--cache-dir-size"); },
         "how much that folder keeps (default 1G)")
      ->type_name("SIZE");
  app.add_option("--endpoint", source.endpoint, "the address of the store of s3:// addresses (default: that of Amazon)");
  app.add_flag("--allow-http", source.allow_http, "read from http:// addresses of other machines, which are not protected on their way");
  app.add_option("--address-timeout", source.timeout, "seconds without progress after which a request to an address is tried again (default 15)")
      ->check(in_range(0.1, 3600));
}

GridReader open_grid(const GridArgument& grid, std::shared_ptr<ChunkKeeper> keeper) {
  return GridReader(open_source(grid.name, grid.source), std::move(keeper));
}

void add_threads(CLI::App& app, int& threads) {
  app.add_option("--threads", threads, "how many threads, 1 to 1024 (default: one per core)")
      ->check(CLI::Validator(
          [](std::string& found) {
            const auto n = parse_integers(found, 1, "--threads")[0];
            return n >= 1 && n <= 1024 ? "" : fmt::format("expected 1 to 1024, found {}", n);
          },
          ""));
}

void add_cad_limits(CLI::App& app, CadArguments& cad) {
  app.add_option("--cad-memory", cad.memory, "how much memory the CAD kernel may take for a STEP file, such as 16G (default 8G)");
  app.add_option("--cad-seconds", cad.seconds, "how long the CAD kernel may read a STEP file, and then make its facets (default 1800)")
      ->check(in_range(0.1, 1e9));
}

mesher::CadOptions CadArguments::options() const {
  mesher::CadOptions out;
  out.seconds = seconds;
  out.kernels = kernels;
  if (!memory.empty()) out.memory = parse_size(memory, "--cad-memory");
  return out;
}

int threads_or_all(int threads) { return threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

void add_word(CLI::App& app, const std::string& name, const std::string& argument, const std::string& help,
              const std::function<void(std::string)>& take) {
  if (argument.empty())
    app.add_flag_callback(
        name, [take] { take(""); }, help);
  else app.add_option_function<std::string>(name, take, help)->type_name(argument);
}

void add_progress(CLI::App& app, std::string& mode) {
  app.add_option("--progress", mode, "progress on stderr: auto (if stderr is a terminal), plain or none")->check(one_of({"auto", "plain", "none"}));
}

}  // namespace teracell::cli
