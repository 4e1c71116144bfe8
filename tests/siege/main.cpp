// Serves forged files of at most 64 kB, one after another, and asks each for everything that the server's routes can be asked for,
// without a socket. For each request it measures the time of the processor and the memory that is allocated beside the cache.
//
//   forged_siege [--first N] [--files N] [--hand-made] [--cache BYTES] [--all]
//   forged_siege --write FOLDER EACH
//
// The second form writes each EACH-th of the hand-made files, and beside each that opens the addresses that it would be asked for, for tests/module.
// The files are the hand-made ones and then random ones, 2000 in all unless told otherwise. It prints the requests that take more
// than the bar, kMostSeconds and kMostBytes, and the dearest of all. Exit status 1 when a request is beyond the bar, unless the answer
// is an error that came within it.
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <new>

#include <fmt/format.h>

#include "server/api/routes.hpp"
#include "store/base/wanted.hpp"
#include "tests/siege/forged_files.hpp"
#include "tests/siege/targets.hpp"
#include "tests/support/stored.hpp"

namespace {

std::atomic<int64_t> held{0}, most_held{0};

void* counted(void* p) {
  if (p == nullptr) throw std::bad_alloc();
  const int64_t now = held += static_cast<int64_t>(malloc_usable_size(p));
  for (int64_t most = most_held; now > most && !most_held.compare_exchange_weak(most, now);) {
  }
  return p;
}
void let_go(void* p) noexcept {
  if (p != nullptr) held -= static_cast<int64_t>(malloc_usable_size(p));
  std::free(p);
}

}  // namespace

void* operator new(size_t size) { return counted(std::malloc(size)); }
void* operator new(size_t size, std::align_val_t align) { return counted(std::aligned_alloc(static_cast<size_t>(align), (size + 63) / 64 * 64)); }
void operator delete(void* p) noexcept { let_go(p); }
void operator delete(void* p, size_t) noexcept { let_go(p); }
void operator delete(void* p, std::align_val_t) noexcept { let_go(p); }
void operator delete(void* p, size_t, std::align_val_t) noexcept { let_go(p); }

namespace teracell::testing {
namespace {

constexpr double kMostSeconds = 2, kGiveUpSeconds = 6;
constexpr int64_t kMostBytes = int64_t{256} << 20;
constexpr int kEnough = 12;  // requests beyond the bar: the file is asked for no more

double processor_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Cost {
  double seconds = 0;
  int64_t bytes = 0;
  int status = 0;
  std::string what, message{};
};

template <class F>
Cost cost_of(std::string what, int64_t cached, F&& f) {
  const int64_t before = held - cached;
  most_held = held.load();
  const double start = processor_seconds();
  Cost c{0, 0, 0, std::move(what)};
  try {
    const Wanted wanted([&] {
      if (processor_seconds() - start > kGiveUpSeconds) throw server::HttpError(503, "too_dear", "too dear");
    });
    const server::Response r = f();
    c.status = r.status;
    if (r.status >= 400 && r.body) c.message = r.body->substr(0, 300);
  } catch (const Error& e) {
    c.status = -1, c.message = e.what();
  }
  c.seconds = processor_seconds() - start;
  c.bytes = most_held - before;
  return c;
}

class Siege {
 public:
  Siege(size_t cache, bool tell_all)
      : cache_(cache), tell_all_(tell_all), folder_(std::filesystem::temp_directory_path() / fmt::format("siege.{}", getpid())) {
    std::filesystem::create_directories(folder_);
  }
  ~Siege() { std::filesystem::remove_all(folder_); }

  void serve(const ForgedFile& file) {
    write_bytes(folder_ / "g.tcell", file.bytes);
    std::unique_ptr<server::Service> service;
    worst_ = {};
    beyond_here_ = 0;
    Cost opened = cost_of("open", 0, [&] {
      service = std::make_unique<server::Service>(server::ServiceOptions{.named = {folder_}, .cache_bytes = cache_});
      try {
        service->grids().find("g");
      } catch (const server::HttpError& e) {
        return server::error_response(e.status, e.code, e.what());
      }
      return server::Response{};
    });
    const bool open = opened.status == 200;
    tell(file, opened);
    if (open) {
      std::vector<std::string> targets;
      {
        const auto grid = service->grids().find("g");
        targets = targets_of(grid->meta(), grid->reader().levels());
      }
      for (const std::string& target : targets) {
        server::Request request{.target = target, .origin = "http://localhost"};
        for (const bool gzip : {false, true}) {
          if (beyond_here_ >= kEnough || (gzip && target.find(".png") != std::string::npos)) continue;
          request.accepts_gzip = gzip;
          const auto cached =
              static_cast<int64_t>(service->chunks().counts().bytes + service->answers().counts().bytes + service->index().counts().bytes);
          tell(file, cost_of(gzip ? target + " (gzip)" : target, cached, [&] { return handle(*service, request); }));
        }
      }
    }
    fmt::print("{:5} B  {:6.2f} s  {:6.1f} MB  {}: {}; {}\n", file.bytes.size(), worst_.seconds, static_cast<double>(worst_.bytes) / 1e6, file.name,
               open ? "open" : "refused", open ? worst_.what : opened.message);
    std::fflush(stdout);
  }

  int sum_up(size_t files) const {
    fmt::print("{} files, {} requests; statuses:", files, requests_);
    for (const auto& [status, count] : statuses_) fmt::print(" {} x {}", count, status);
    for (const Cost& c : {slowest_, largest_})
      fmt::print("\n{}: {:.2f} s, {:.1f} MB, status {} {}", &c == &slowest_ ? "" : "", c.seconds, static_cast<double>(c.bytes) / 1e6, c.status,
                 c.what);
    fmt::print("\nbeyond the bar: {}\n", beyond_);
    return beyond_ == 0 ? 0 : 1;
  }

 private:
  void tell(const ForgedFile& file, const Cost& c) {
    ++requests_;
    ++statuses_[c.status];
    const int64_t allowed = kMostBytes;  // what is kept in the cache was subtracted; what the request adds to it is bounded by it
    const bool beyond = c.seconds > kMostSeconds || c.bytes > allowed + static_cast<int64_t>(cache_);
    beyond_ += beyond, beyond_here_ += beyond;
    if (tell_all_ || (beyond && (c.seconds > worst_.seconds * 1.2 || c.bytes > worst_.bytes / 10 * 12)))
      fmt::print("  {} {:.2f} s {:.1f} MB status {} {} {}\n", beyond ? "BEYOND" : "", c.seconds, static_cast<double>(c.bytes) / 1e6, c.status, c.what,
                 c.message);
    const auto keep = [&](Cost& worst, bool more) {
      if (more) worst = c, worst.what = fmt::format("{} [{}]", c.what, file.name);
    };
    keep(slowest_, c.seconds > slowest_.seconds);
    keep(largest_, c.bytes > largest_.bytes);
    worst_.bytes = std::max(worst_.bytes, c.bytes);
    if (c.seconds > worst_.seconds) worst_.seconds = c.seconds, worst_.what = fmt::format("{} {}", c.status, c.what);
  }

  const size_t cache_;
  const bool tell_all_;
  const std::filesystem::path folder_;
  size_t requests_ = 0, beyond_ = 0;
  int beyond_here_ = 0;
  std::map<int, size_t> statuses_;
  Cost slowest_, largest_, worst_;
};

void write_files(const std::filesystem::path& folder, size_t each) {
  for (size_t number = 0; number < hand_made_files(); number += each) {
    const auto file = hand_made_file(number);
    if (!file) continue;
    const std::filesystem::path path = folder / fmt::format("{}.tcell", number);
    write_bytes(path, file->bytes);
    std::ofstream list(folder / fmt::format("{}.txt", number));
    list << hand_made_name(number) << "\n";
    try {
      const GridReader reader(path);
      for (const std::string& target : targets_of(reader.meta(), reader.levels()))
        if (target.starts_with("/api/")) list << target << "\n";
    } catch (const Error&) {
      continue;  // it has no addresses
    }
  }
}

int run(int argc, char** argv) {
  if (argc == 4 && argv[1] == std::string_view("--write")) return write_files(argv[2], std::max(1ul, std::strtoul(argv[3], nullptr, 10))), 0;
  size_t first = 0, files = 2000, cache = size_t{64} << 20;
  bool tell_all = false;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    const auto number = [&] { return ++i < argc ? std::strtoull(argv[i], nullptr, 10) : 0; };
    if (option == "--first") first = number();
    else if (option == "--files") files = number();
    else if (option == "--cache") cache = number();
    else if (option == "--hand-made") files = hand_made_files();
    else if (option == "--all") tell_all = true;
  }
  const rlimit limit{uint64_t{8} << 30, uint64_t{8} << 30};  // a request that takes more gets an error
  setrlimit(RLIMIT_AS, &limit);
  Siege siege(cache, tell_all);
  size_t served = 0;
  for (size_t number = first; served < files && number < first + 20 * files; ++number) {
    std::optional<ForgedFile> file;
    if (number < hand_made_files()) {
      file = hand_made_file(number);
      if (!file) fmt::print("hand-made file {} is too large\n", number);
    } else {
      file = random_file(number - hand_made_files());
    }
    if (!file && number >= hand_made_files()) continue;
    ++served;
    if (file) siege.serve(*file);
  }
  return siege.sum_up(served);
}

}  // namespace
}  // namespace teracell::testing

int main(int argc, char** argv) { return teracell::testing::run(argc, argv); }
