// What tools/bench/scale needs of teracell_mpi: what pieces of a grid that is too large for this machine take, and how long many processes would
// take for all of them.
//
//   scale_probe measure SCENE CELLS FOLDER STRETCHES PIECES   makes some pieces, in stretches spread over the grid; prints what they take
//   scale_probe simulate NAME=VALUE ... < what they take      hands out all pieces to simulated processes; prints when these have ended
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <deque>
#include <exception>
#include <iostream>
#include <queue>
#include <random>
#include <thread>

#include "mesher/bodies/assembly.hpp"
#include "mesher/parts/pieces.hpp"
#include "mesher/run/part_found.hpp"

namespace {

using namespace teracell;

// ---- Measuring. Times are CPU times of one thread, because others may work on this machine.

double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

template <class F>
double seconds_of(F&& f) {
  const double began = cpu_seconds();
  f();
  return cpu_seconds() - began;
}

// Until no thread of this process does anything.
void wait_for_counting() {
  for (double before = -1; cpu_seconds() - before > 1e-3;) {
    before = cpu_seconds();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

void measure(const std::filesystem::path& scene_path, int64_t cells, const std::filesystem::path& folder, uint32_t stretches, uint32_t of_stretch) {
  mesher::Scene scene = mesher::read_scene(scene_path);
  mesher::GridOptions grid;
  grid.longest_cells = cells;
  override_grid(scene, grid);
  mesher::MeshOptions options;
  options.threads = 1;
  const std::filesystem::path output = folder / "g.tcell";
  const mesher::Progress quiet = [](const char*, double, double) {};
  const std::atomic<bool> stop = false;
  std::optional<mesher::Pieces> pieces;
  const auto prepare_as = [&](bool first) { return seconds_of([&] { pieces.emplace(scene, output, options, first, quiet, stop); }); };
  const double prepare = prepare_as(false);
  pieces.reset();
  // By rank 0, and nobody waits for it. It is a difference of two measurements, so on a busy machine little counting could come out below 0.
  const double count = std::max(1e-6, prepare_as(true) + seconds_of(wait_for_counting) - prepare);
  const auto shape = LevelShape(pieces->meta(), 0);
  std::printf("pieces %u\nprepare %.6f\ncount %.6f\nrays %.0f\n", pieces->size(), prepare, count, double{1} * shape.nu * shape.nv);

  mesher::Assembly assembly(output, pieces->meta());
  const FileRoom file(output);
  mesher::CastTotals totals = no_totals(scene);
  const double settle = seconds_of([&] { pieces->settle({0, 0, pieces->size()}); });
  std::printf("settle %.6f\n", settle);
  for (uint32_t s = 0; s < stretches; ++s) {
    const auto first = static_cast<uint32_t>(uint64_t{pieces->size()} * (2 * s + 1) / (2 * stretches)),
               end = std::min(first + of_stretch, pieces->size());
    for (uint32_t piece = first; piece < end; ++piece) {
      const double cast = seconds_of([&] { pieces->make({piece, 0, pieces->size()}); });
      std::unique_ptr<PartReader> part;
      std::vector<mesher::Placed> places;
      const double place = seconds_of([&] {  // as conductor.cpp does
        part = pieces->open(piece);
        places = assembly.add(*part);
        totals.add(mesher::decode_found(part->found(), part->name()).totals);
      });
      const double copy = seconds_of([&] { copy_placed(*part, places, file, [] {}); });
      std::printf("piece %.6f %.6f %.6f %.6f %llu %llu\n", 1e-9 * static_cast<double>(pieces->cost(piece)), cast, place, copy,
                  static_cast<unsigned long long>(part->bytes()), static_cast<unsigned long long>(part->file_bytes()));
      std::fflush(stdout);
      std::filesystem::remove(pieces->path(piece));
    }
  }
  std::printf("report %.6f\n", seconds_of([&] {
                pieces->finish_counting();
                pieces->report(totals);
              }));
  std::printf("crossings %llu\n", static_cast<unsigned long long>(totals.crossings));
}

// ---- Simulating. Seconds from when the launcher starts.

struct Sample {
  double estimated, cast, place, copy, bytes, file_bytes;
};

struct Cluster {
  double workers = 0, pieces = 0, start = 0, prepare = 0, count = 0, settle = 0, finish = 0;
  double latency = 0;     // of a message, with what both ends sleep
  double open = 0;        // for rank 0 to open a file that another machine wrote, and to read its end
  double removals = 0;    // files per second
  double bandwidth = 0;   // of the file system, bytes per second
};

// A worker is a process with one core. It casts, and between two pieces it copies what was placed. Rank 0 is one of them; what it does for
// all others keeps its core from casting.
class Simulation {
 public:
  Simulation(const Cluster& cluster, std::vector<Sample> samples)
      : c_(cluster), samples_(std::move(samples)), workers_(static_cast<size_t>(c_.workers)), owner_(static_cast<size_t>(c_.pieces), -1) {
    std::vector<uint32_t> pieces;
    std::mt19937_64 random(1);
    for (uint32_t piece = 0; piece < owner_.size(); ++piece) {
      pieces.push_back(piece);
      sample_of_.push_back(random() % samples_.size());
    }
    mesher::last_by_cost(pieces, workers_.size(), [&](uint32_t piece) { return static_cast<uint64_t>(1e9 * sample(piece).estimated); });
    queue_.emplace(std::move(pieces), 1);  // all facets are in memory
    of_rank_0_ = c_.count;
  }

  void run() {
    const double ready = c_.start + c_.prepare + c_.latency;
    for (int w = 0; w < static_cast<int>(workers_.size()); ++w)
      for (int i = 0; i < 2; ++i) at(ready + c_.latency, [this, w] { ask(w); });
    while (!events_.empty()) {
      const Event event = events_.top();
      events_.pop();
      now_ = event.when;
      event.what();
    }
    const double synced = std::max(now_, written_) + 2 * c_.latency, finished = synced + c_.finish + 2 * c_.latency;
    const double end = finished + c_.pieces / c_.removals;
    double least = last_cast_, idle = 0;
    for (const Worker& w : workers_) least = std::min(least, w.ended), idle += last_cast_ - w.ended;
    std::printf(
        "casting %.3f\nready %.3f\nfirst_idle %.3f\nlast_cast %.3f\nplaced %.3f\ncopied %.3f\nsynced %.3f\nend %.3f\nefficiency %.4f\nhomes %llu\n",
        casting_, ready, least, last_cast_, placed_at_, now_, synced, end, casting_ / (c_.workers * end), static_cast<unsigned long long>(homes_));
  }

 private:
  struct Event {
    double when;
    uint64_t number;  // events of a moment come in the order in which they were made
    std::function<void()> what;
    bool operator<(const Event& other) const { return when != other.when ? when > other.when : number > other.number; }
  };
  struct Worker {
    bool busy = false;
    int has = 0;  // pieces that are not made
    std::deque<mesher::PieceQueue::Order> orders;
    std::deque<uint32_t> to_copy;
    std::pair<uint32_t, uint32_t> home{1, 0};
    double ended = 0;
  };
  void at(double when, std::function<void()> what) { events_.push({when, number_++, std::move(what)}); }
  const Sample& sample(uint32_t piece) const { return samples_[sample_of_[piece]]; }

  void ask(int w) {  // as in conductor.cpp
    if (workers_[w].has > 0 && queue_->left() < 2 * workers_.size()) return;
    if (const auto order = queue_->next(0)) {
      ++workers_[w].has;
      at(now_ + c_.latency, [this, w, order] {
        workers_[w].orders.push_back(*order);
        go_on(w);
      });
    }
  }
  void write(double bytes) { written_ = std::max(written_, now_) + bytes / c_.bandwidth; }

  void go_on(int w) {
    Worker& worker = workers_[w];
    if (worker.busy) return;
    if (!worker.to_copy.empty()) {
      const uint32_t piece = worker.to_copy.front();
      worker.to_copy.pop_front();
      return work(w, sample(piece).copy, [this, piece] { write(sample(piece).bytes); });
    }
    if (worker.orders.empty()) return;
    const mesher::PieceQueue::Order order = worker.orders.front();
    worker.orders.pop_front();
    double seconds = sample(order.piece).cast;
    casting_ += seconds;
    if (const std::pair home{order.first, order.end}; worker.home != home) worker.home = home, seconds += c_.settle, ++homes_;
    work(w, seconds, [this, w, piece = order.piece] {
      last_cast_ = workers_[w].ended = now_;
      write(sample(piece).file_bytes);
      at(now_ + c_.latency, [this, w, piece] {
        owner_[piece] = w;
        --workers_[w].has;
        place();
        ask(w);
      });
    });
  }

  void work(int w, double seconds, std::function<void()> then) {
    workers_[w].busy = true;
    if (w == 0) seconds += std::exchange(of_rank_0_, 0);
    at(now_ + seconds, [this, w, then = std::move(then)] {
      workers_[w].busy = false;
      then();
      go_on(w);
    });
  }

  // Rank 0 places pieces in order, one after another.
  void place() {
    if (placing_ || placed_ == owner_.size() || owner_[placed_] < 0) return;
    placing_ = true;
    of_rank_0_ += sample(placed_).place;
    at(now_ + sample(placed_).place + c_.open, [this] {
      placing_ = false;
      placed_at_ = now_;
      at(now_ + c_.latency, [this, w = owner_[placed_], piece = placed_] {
        workers_[w].to_copy.push_back(piece);
        go_on(w);
      });
      ++placed_;
      place();
    });
  }

  const Cluster c_;
  const std::vector<Sample> samples_;
  std::vector<size_t> sample_of_;  // by piece
  std::vector<Worker> workers_;
  std::vector<int> owner_;
  std::optional<mesher::PieceQueue> queue_;
  std::priority_queue<Event> events_;
  uint64_t number_ = 0, homes_ = 0;
  uint32_t placed_ = 0;
  bool placing_ = false;
  double now_ = 0, casting_ = 0, last_cast_ = 0, written_ = 0, of_rank_0_ = 0, placed_at_ = 0;
};

void simulate(int count, char** arguments) {
  Cluster c;
  const std::pair<std::string, double*> names[] = {{"workers", &c.workers},   {"pieces", &c.pieces},      {"start", &c.start},
                                                   {"prepare", &c.prepare},   {"settle", &c.settle},      {"count", &c.count},
                                                   {"finish", &c.finish},     {"latency", &c.latency},    {"open", &c.open},
                                                   {"removals", &c.removals}, {"bandwidth", &c.bandwidth}};
  for (const std::string& argument : std::vector<std::string>(arguments, arguments + count))
    for (const auto& [name, value] : names)
      if (argument.starts_with(name + "=")) *value = std::stod(argument.substr(name.size() + 1));
  std::vector<Sample> samples;
  for (Sample s; std::cin >> s.estimated >> s.cast >> s.place >> s.copy >> s.bytes >> s.file_bytes;) samples.push_back(s);
  for (const auto& [name, value] : names)
    if (*value <= 0) throw std::runtime_error("simulate: expected " + name + "=VALUE, above 0");
  if (samples.empty()) throw std::runtime_error("simulate: expected pieces on stdin, found none");
  Simulation(c, std::move(samples)).run();
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "measure" && argc == 7)
    measure(argv[2], std::atoll(argv[3]), argv[4], static_cast<uint32_t>(std::atoi(argv[5])), static_cast<uint32_t>(std::atoi(argv[6])));
  else if (what == "simulate") simulate(argc - 2, argv + 2);
  else throw std::runtime_error("expected measure SCENE CELLS FOLDER STRETCHES PIECES, or simulate NAME=VALUE ...");
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "scale_probe: %s\n", e.what());
  return 1;
}
