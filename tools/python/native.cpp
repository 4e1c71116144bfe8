// What teracell/__init__.py stands on: the C API for arrays of NumPy, and the mesher.
#include <cxxabi.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "mesher/cad/idle_kernels.hpp"
#include "mesher/engines/engines.hpp"
#include "mesher/pipeline.hpp"
#include "mesher/report/report_json.hpp"
#include "mesher/run/dry_run.hpp"
#include "mesher/scene/from_parts.hpp"
#include "mesher/surface/read_facets.hpp"
#include "mesher/survey/survey.hpp"
#include "mesher/survey/survey_json.hpp"
#include "store/base/error.hpp"
#include "store/format/report_json.hpp"
#include "store/teracell.h"

namespace py = pybind11;
using Index = std::array<int64_t, 3>;  // x, y, z

namespace {

struct Exceptions {
  py::object error, usage, io, format;
};
Exceptions& exceptions() {
  static auto* all = new Exceptions;  // never freed: the interpreter may be gone by then
  return *all;
}

// Names of files in a message may be no UTF-8: they become what os.fsdecode() makes of them.
py::object text_of(const std::string& message) {
  return py::reinterpret_steal<py::object>(PyUnicode_DecodeUTF8(message.data(), static_cast<Py_ssize_t>(message.size()), "surrogateescape"));
}

void set_error(const py::object& type, const std::string& message, int number = 0) {
  const py::object text = text_of(message);
  if (number == 0) return PyErr_SetObject(type.ptr(), text.ptr());
  const py::object found = type(number, text);  // of the class that stands for the number
  PyErr_SetObject(py::type::handle_of(found).ptr(), found.ptr());
}

[[noreturn]] void raise(const py::object& type, const std::string& message, int number = 0) {
  set_error(type, message, number);
  throw py::error_already_set();
}

// While it lives, this thread does not hold Python's lock (the GIL). A daemon thread that asks for the lock when the interpreter has
// begun to end never gets it: up to Python 3.13, Python ends such a thread by pthread_exit(), which unwinds it and aborts the process in
// the first destructor or catch (...) that is in the way. So here it sleeps until the process ends, which is what Python itself does
// from 3.14 on (PyThread_hang_thread, gh-87135).
class Unlocked {
 public:
  Unlocked() = default;
  ~Unlocked() { lock(); }
  Unlocked(const Unlocked&) = delete;
  // Calls f() with the lock.
  template <class F>
  auto locked(F&& f) {
    struct Unlock {
      Unlocked& whose;
      ~Unlock() { whose.state_ = PyEval_SaveThread(); }
    };
    lock();
    const Unlock after{*this};
    return f();
  }

 private:
  void lock() noexcept {
    try {
      PyEval_RestoreThread(state_);
    } catch (abi::__forced_unwind&) {
      for (;;) ::pause();
    }
  }
  PyThreadState* state_ = PyEval_SaveThread();
};

// Lets Python act on signals now and then while its lock is released. It does so in the main thread alone: others need not ask.
class Signals {
 public:
  Signals() : main_(py::module_::import("threading").attr("main_thread")().attr("ident").cast<unsigned long>() == PyThread_get_thread_ident()) {}
  bool wanted() const { return main_; }
  // Whether a handler has raised an exception.
  bool raised(Unlocked& unlocked) {
    const auto now = std::chrono::steady_clock::now();
    if (!main_ || now < next_) return false;
    next_ = now + std::chrono::milliseconds(50);
    return unlocked.locked([] { return PyErr_CheckSignals() != 0; });
  }

 private:
  const bool main_;
  std::chrono::steady_clock::time_point next_{};
};

// Calls f() without Python's lock, and turns its status into an exception.
template <class F>
void call(F&& f) {
  struct Asked {
    Signals signals;
    Unlocked unlocked;
  };
  int status, number = 0;
  std::string message;
  {
    Asked asked;
    const auto raised = [](void* user) {
      auto& [signals, unlocked] = *static_cast<Asked*>(user);
      return signals.raised(unlocked) ? 1 : 0;
    };
    const tc_watcher before = tc_watch(asked.signals.wanted() ? tc_watcher{raised, &asked} : tc_watcher{nullptr, nullptr});
    status = f();
    tc_watch(before);
    if (status != TC_OK) message = tc_error(), number = tc_errno();
  }
  if (PyErr_Occurred()) throw py::error_already_set();
  if (status == TC_OK) return;
  if (status == TC_USAGE) raise(exceptions().usage, message);
  if (status == TC_IO) raise(exceptions().io, message, number);
  if (status == TC_FORMAT) raise(exceptions().format, message);
  if (status == TC_MEMORY) throw std::bad_alloc();
  raise(exceptions().error, message);
}

class Native {
 public:
  Native(const std::string& path, const std::string& cache_dir, uint64_t cache_dir_bytes, const std::string& endpoint, bool allow_http) {
    const tc_source source{cache_dir.c_str(), cache_dir_bytes, endpoint.c_str(), allow_http};
    call([&] { return tc_open_source(path.c_str(), &source, sizeof source, &grid_); });
  }
  ~Native() { tc_close(grid_); }
  Native(const Native&) = delete;

  int levels() const { return tc_levels(grid_); }
  int ray_axis() const { return tc_ray_axis(grid_); }
  std::string units() const { return tc_units(grid_); }
  std::string hash() const { return tc_hash(grid_); }
  std::string info() const {
    const char* json = nullptr;
    call([&] { return tc_info(grid_, &json); });
    return json;
  }
  Index shape(int level) const {
    Index n{};
    call([&] { return tc_shape(grid_, level, n.data()); });
    return n;
  }
  py::list materials() const {
    std::vector<tc_material> all(static_cast<size_t>(tc_material_count(grid_)));
    call([&] { return tc_materials(grid_, 0, tc_material_count(grid_), all.data(), sizeof(tc_material)); });
    py::list out;
    for (const tc_material& m : all) out.append(py::make_tuple(m.name, py::make_tuple(m.color[0], m.color[1], m.color[2], m.color[3]), m.rank));
    return out;
  }
  py::list patches() const {
    std::vector<tc_patch> all(static_cast<size_t>(tc_patch_count(grid_)));
    call([&] { return tc_patches(grid_, 0, tc_patch_count(grid_), all.data(), sizeof(tc_patch)); });
    py::list out;
    for (const tc_patch& p : all) out.append(py::make_tuple(p.name, p.body, p.area));
    return out;
  }
  py::array_t<double> planes(int level, int axis) const { return positions(level, axis, 1, tc_planes); }
  py::array_t<double> samples(int level, int axis) const { return positions(level, axis, 0, tc_samples); }

  // `out` has axes z, y, x and any strides.
  void read(int level, const Index& first, const Index& step, py::array out, uint32_t outside, std::optional<py::array_t<uint32_t>> map,
            int threads) const {
    const auto bytes = out.itemsize();
    Index count{}, stride{};
    for (int d = 0; d < 3; ++d) {
      count[d] = out.shape(2 - d);
      if (out.strides(2 - d) % bytes != 0 && count[d] > 1)
        raise(exceptions().usage, "out: expected an array whose strides are multiples of its items");
      stride[d] = out.strides(2 - d) / bytes;
    }
    void* const data = out.mutable_data();
    const uint32_t* values = map ? map->data() : nullptr;
    const int64_t size = map ? map->size() : 0;
    call([&] {
      return tc_read_lattice(grid_, level, first.data(), count.data(), step.data(), static_cast<int>(bytes), data, stride.data(), outside, values,
                             size, threads);
    });
  }

  // Rows of x, y, z, length, material.
  py::array_t<int64_t> runs(int level, const Index& lo, const Index& hi) const {
    std::vector<int64_t> rows;
    call([&] {
      return tc_runs(
          grid_, level, lo.data(), hi.data(),
          [](void* user, const tc_run* run) {
            try {
              auto& to = *static_cast<std::vector<int64_t>*>(user);
              to.insert(to.end(), {run->start[0], run->start[1], run->start[2], run->length, int64_t{run->material}});
              return 0;
            } catch (...) {
              return 1;
            }
          },
          &rows);
    });
    return table(rows, 5);
  }

  // Rows of from, to, material.
  py::array_t<int64_t> column(int axis, int64_t a, int64_t b) const {
    std::vector<tc_column_run> runs(16);
    int64_t count = 0;
    for (;;) {
      call([&] { return tc_column(grid_, axis, a, b, 0, INT64_MAX, runs.data(), sizeof runs[0], static_cast<int64_t>(runs.size()), &count); });
      if (count <= static_cast<int64_t>(runs.size())) break;
      runs.resize(static_cast<size_t>(count));
    }
    std::vector<int64_t> rows;
    for (int64_t i = 0; i < count; ++i) rows.insert(rows.end(), {runs[i].from, runs[i].to, int64_t{runs[i].material}});
    return table(rows, 3);
  }

  // For each material: cells, volume, lo, hi.
  py::list stats(const Index& lo, const Index& hi) const {
    const int64_t count = tc_material_count(grid_);
    std::vector<tc_cells> found(static_cast<size_t>(count));
    call([&] { return tc_stats(grid_, lo.data(), hi.data(), found.data(), sizeof(tc_cells), count); });
    py::list out;
    for (const tc_cells& c : found) {
      const py::int_ cells = (py::int_(c.cells_high) << py::int_(64)) + py::int_(c.cells);
      out.append(py::make_tuple(cells, c.volume, Index{c.lo[0], c.lo[1], c.lo[2]}, Index{c.hi[0], c.hi[1], c.hi[2]}));
    }
    return out;
  }

  std::optional<uint32_t> uniform(int level, const Index& lo, const Index& hi) const {
    int one = 0;
    uint32_t material = 0;
    call([&] { return tc_uniform(grid_, level, lo.data(), hi.data(), &one, &material); });
    return one ? std::optional(material) : std::nullopt;
  }

  // Writes to an array [z][y][x] of doubles, of any strides.
  void fractions(uint32_t material, const Index& lo, py::array_t<double>& out, double outside, int threads) const {
    Index hi, stride;
    for (size_t d = 0; d < 3; ++d) {
      const auto axis = static_cast<py::ssize_t>(2 - d);
      hi[d] = lo[d] + out.shape(axis);
      stride[d] = out.strides(axis) / static_cast<py::ssize_t>(sizeof(double));
    }
    double* const data = out.mutable_data();
    call([&] { return tc_fractions(grid_, material, lo.data(), hi.data(), data, stride.data(), outside, threads); });
  }

  // The cells (x, y, z), ends, begins and patches of the links along an axis.
  py::tuple links(int axis, const Index& lo, const Index& hi) const {
    struct Found {
      std::vector<int64_t> cells, patches;
      std::vector<uint32_t> ends, begins;
    } found;
    const auto take = [](void* user, const tc_link* link) {
      Found& f = *static_cast<Found*>(user);
      f.cells.insert(f.cells.end(), {link->cell[0], link->cell[1], link->cell[2]});
      f.ends.push_back(link->end), f.begins.push_back(link->begin), f.patches.push_back(link->patch);
      return 0;
    };
    call([&] { return tc_links(grid_, axis, lo.data(), hi.data(), take, &found); });
    const auto array = [](const auto& values) { return py::array(static_cast<py::ssize_t>(values.size()), values.data()); };
    return py::make_tuple(array(found.cells).reshape({py::ssize_t{-1}, py::ssize_t{3}}), array(found.ends), array(found.begins),
                          array(found.patches));
  }

  // The leaves of a box, 32 bytes each: level (int32), cell x, y, z (int64), material (uint32), without gaps.
  py::bytearray leaves(const Index& lo, const Index& hi, int coarsest, int layers, const std::string& want, int threads) const {
    std::string found;
    const auto take = [](void* user, const tc_leaf* leaf) {
      std::string& out = *static_cast<std::string*>(user);
      const auto put = [&](const auto& value) { out.append(reinterpret_cast<const char*>(&value), sizeof value); };
      put(leaf->level), put(leaf->cell), put(leaf->material);
      return 0;
    };
    call([&] { return tc_leaves(grid_, lo.data(), hi.data(), coarsest, layers, want.c_str(), threads, take, &found); });
    return {found.data(), found.size()};
  }

 private:
  template <class F>
  py::array_t<double> positions(int level, int axis, int64_t more, F&& f) const {
    if (axis < 0 || axis > 2) raise(exceptions().usage, "axis: expected 0, 1 or 2");
    const int64_t n = shape(level)[static_cast<size_t>(axis)] + more;
    py::array_t<double> out(n);
    double* const data = out.mutable_data();
    call([&] { return f(grid_, level, axis, int64_t{0}, n, data); });
    return out;
  }
  static py::array_t<int64_t> table(const std::vector<int64_t>& rows, int64_t columns) {
    py::array_t<int64_t> out({static_cast<int64_t>(rows.size()) / columns, columns});
    std::ranges::copy(rows, out.mutable_data());
    return out;
  }

  tc_grid* grid_ = nullptr;
};

class NativePartition {
 public:
  explicit NativePartition(const std::string& path) {
    call([&] { return tc_partition_open(path.c_str(), &partition_); });
  }
  ~NativePartition() { tc_partition_close(partition_); }
  NativePartition(const NativePartition&) = delete;

  // ranks, cells, align, halo, total, method, hash of the grid
  py::tuple plan() const {
    tc_plan p;
    call([&] { return tc_partition_plan(partition_, &p, sizeof p); });
    return py::make_tuple(p.ranks, index(p.cells), p.align, p.halo, p.total, p.method, p.grid_hash);
  }
  // lo, hi, those with the halo, weight, neighbours
  py::tuple part(int64_t rank) const {
    tc_part p;
    call([&] { return tc_partition_part(partition_, rank, &p, sizeof p); });
    return py::make_tuple(index(p.lo), index(p.hi), index(p.halo_lo), index(p.halo_hi), p.weight,
                          std::vector<int64_t>(p.neighbours, p.neighbours + p.count));
  }

 private:
  static Index index(const int64_t* n) { return {n[0], n[1], n[2]}; }
  tc_partition* partition_ = nullptr;
};

std::string join(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

// What mesh() of the library takes, and its report as JSON.
std::string mesh(const std::string& scene_text, const std::string& folder, const std::vector<std::string>& surfaces, const std::string& output,
                 const py::dict& options, const py::object& progress) {
  using namespace teracell;
  mesher::MeshOptions o;
  mesher::GridOptions grid;
  const auto given = [&](const char* name) { return options.contains(name) && !options[name].is_none(); };
  if (given("cells")) {
    if (py::isinstance<py::int_>(options["cells"])) grid.longest_cells = options["cells"].cast<int64_t>();
    else grid.cells = options["cells"].cast<std::array<int64_t, 3>>();
  }
  if (given("step")) grid.step = options["step"].cast<double>();
  if (given("pad")) grid.pad = options["pad"].cast<int64_t>();
  if (given("axis")) o.axis = options["axis"].cast<int>();
  if (given("engine")) o.engine = options["engine"].cast<std::string>();
  if (given("threads")) o.threads = options["threads"].cast<int>();
  o.memory = static_cast<uint64_t>(::sysconf(_SC_PHYS_PAGES)) * static_cast<uint64_t>(::sysconf(_SC_PAGESIZE)) / 4;
  if (given("memory")) o.memory = options["memory"].cast<uint64_t>();
  if (given("tmp")) o.tmp = options["tmp"].cast<std::string>();
  o.cad.kernels = std::make_shared<mesher::IdleKernels>();
  if (given("cad_memory")) o.cad.memory = options["cad_memory"].cast<uint64_t>();
  if (given("cad_seconds")) o.cad.seconds = options["cad_seconds"].cast<double>();
  if (given("thin")) o.thin = options["thin"].cast<bool>();
  if (given("links")) o.links = options["links"].cast<bool>();
  if (given("fractions")) {
    o.fractions = options["fractions"].cast<Subdivision>();
    if (const std::string beyond = beyond_bounds(*o.fractions); !beyond.empty()) throw UsageError("fractions: " + beyond);
  }
  const std::string units = given("units") ? options["units"].cast<std::string>() : "";
  if (!units.empty() && !mesher::is_unit(units)) throw UsageError("units: expected m, cm, mm, um, nm, in or ft, found '" + units + "'");
  const bool by_part = given("by_part") && options["by_part"].cast<bool>();
  if (given("resume")) o.resume = options["resume"].cast<bool>();

  std::optional<mesher::Deflection> deflection;
  if (given("deflection")) {
    const std::string text = py::str(options["deflection"]);
    deflection = mesher::parse_deflection(text);
    if (!deflection) throw UsageError("deflection: expected a length above 0, or cells such as '0.1c', found " + text);
  }
  std::optional<double> angle;
  if (given("angle")) angle = options["angle"].cast<double>();
  if (angle && !mesher::is_chord_angle(*angle)) throw UsageError("angle: expected degrees from 0.1 to 90, found " + std::to_string(*angle));
  const bool face_patches = given("face_patches") && options["face_patches"].cast<bool>();
  const std::vector<std::string> engines = mesher::engine_names();
  if (std::ranges::count(engines, o.engine) == 0) throw UsageError("engine: expected one of " + join(engines) + ", found '" + o.engine + "'");
  if (o.threads < 0 || o.threads > 1024) throw UsageError("threads: expected 0 (one per core) to 1024, found " + std::to_string(o.threads));
  if (o.memory == 0) throw UsageError("memory: expected a number of bytes, found 0");
  std::atomic<bool> stop = false;
  std::exception_ptr raised;
  Signals signals;
  const bool silent = progress.is_none();
  Unlocked unlocked;
  try {
    const std::vector<std::filesystem::path> files(surfaces.begin(), surfaces.end());
    mesher::Scene scene = files.empty() ? mesher::parse_scene(scene_text, folder)
                          : by_part     ? mesher::scene_by_part(files, mesher::modest_budget(), o.cad)
                                        : mesher::bare_scene(files);
    if (!files.empty()) scene.units = units.empty() ? mesher::first_stated_unit(files) : units;
    override_grid(scene, grid);
    for (mesher::SceneBody& body : scene.bodies) {
      if (deflection) body.deflection = *deflection;
      if (angle) body.angle = *angle;
      if (face_patches) body.face_patches = true;
    }
    const mesher::MeshReport report = mesh(
        scene, output, o,
        [&](const char* phase, double share, double) {
          if (stop) return;
          try {
            const bool interrupted = signals.raised(unlocked);
            if (!interrupted && silent) return;
            unlocked.locked([&] {
              if (interrupted) throw py::error_already_set();
              progress(phase, share);
            });
          } catch (...) {
            raised = std::current_exception();
            stop = true;
          }
        },
        stop);
    if (raised) std::rethrow_exception(raised);  // by the last call: the file is complete
    return report_json(report.report, scene, report.run, report.warnings());
  } catch (const Interrupted&) {
    if (raised) std::rethrow_exception(raised);
    throw;
  }
}

// The planes of a scene's axes, where they break rules (JSON), and what there is to say of them. Without a text `place` is the scene's file, else the
// folder of its paths.
std::tuple<std::vector<std::vector<double>>, std::string, std::vector<std::string>> planes(const std::string& scene_text, const std::string& place) {
  using namespace teracell;
  const Unlocked unlocked;
  const std::atomic<bool> stop = false;
  mesher::MeshOptions o;
  o.memory = mesher::modest_budget().bytes;
  const mesher::DryRun run = dry_run(
      scene_text.empty() ? mesher::read_scene(place) : mesher::parse_scene(scene_text, place), o, [](const char*, double, double) {}, stop);
  std::vector<std::vector<double>> axes;
  for (const Axis& axis : run.plan.meta.grid.axis) {
    auto& planes = axes.emplace_back();
    for (int64_t i = 0; i <= axis.cells(); ++i) planes.push_back(axis.plane(i));
  }
  const PlanesReport report = run.plan.planes.value_or(PlanesReport{});
  std::string breaches;
  JsonWriter out(breaches);
  write_breaches(out, report);
  return {axes, breaches, report.warnings};
}

}  // namespace

PYBIND11_MODULE(_native, m) {
  auto& e = exceptions();
  const py::module_ errors = py::module_::import("teracell._errors");
  e.error = errors.attr("Error"), e.usage = errors.attr("UsageError"), e.io = errors.attr("IoError"), e.format = errors.attr("FormatError");
  py::register_exception_translator([](std::exception_ptr p) {
    const auto set = [](const py::object& type, const std::exception& found, int number = 0) { set_error(type, found.what(), number); };
    try {
      if (p) std::rethrow_exception(p);
    } catch (const teracell::UsageError& found) {
      set(exceptions().usage, found);
    } catch (const teracell::IoError& found) {
      set(exceptions().io, found, found.number);
    } catch (const teracell::FormatError& found) {
      set(exceptions().format, found);
    } catch (const teracell::InputError& found) {
      set(exceptions().format, found);
    } catch (const teracell::Error& found) {
      set(exceptions().error, found);
    }
  });
  m.attr("version") = tc_version();
  m.def("mesh", &mesh);
  m.def("planes", &planes);
  m.def("survey", [](const std::string& file) {
    const Unlocked unlocked;
    return teracell::mesher::survey_json({teracell::mesher::survey(file, teracell::mesher::modest_budget())}, {file});
  });
  py::class_<NativePartition>(m, "Partition")
      .def(py::init<const std::string&>())
      .def("plan", &NativePartition::plan)
      .def("part", &NativePartition::part);
  py::class_<Native>(m, "Grid")
      .def(py::init<const std::string&, const std::string&, uint64_t, const std::string&, bool>())
      .def("levels", &Native::levels)
      .def("ray_axis", &Native::ray_axis)
      .def("units", &Native::units)
      .def("hash", &Native::hash)
      .def("info", &Native::info)
      .def("shape", &Native::shape)
      .def("materials", &Native::materials)
      .def("planes", &Native::planes)
      .def("samples", &Native::samples)
      .def("read", &Native::read)
      .def("runs", &Native::runs)
      .def("column", &Native::column)
      .def("stats", &Native::stats)
      .def("uniform", &Native::uniform)
      .def("fractions", &Native::fractions, py::arg("material"), py::arg("lo"), py::arg("out").noconvert(), py::arg("outside"), py::arg("threads"))
      .def("links", &Native::links)
      .def("leaves", &Native::leaves)
      .def("patches", &Native::patches);
}
