// teracell export: a box of cells as a dense array, slab by slab.
#include <fmt/format.h>

#include "store/error.hpp"
#include "store/npy.hpp"
#include "store/query.hpp"
#include "tools/cli/command.hpp"

namespace teracell {
namespace {

constexpr int64_t kSlabBytes = 64 << 20;

struct Options {
  std::string grid, output, format, region;
  int level = 0;
};

// Layers of z that fit the slab; where not even one fits, rows of a layer; or part of a row.
template <class T>
void write_cells(const GridReader& reader, const Options& o, const Box& box, const std::atomic<bool>& stop, OutputFile& file) {
  const int64_t nx = box.hi[0] - box.lo[0], ny = box.hi[1] - box.lo[1];
  const auto fit = [](int64_t count, int64_t size) { return std::clamp<int64_t>(kSlabBytes / size, 1, count); };
  const int64_t columns = fit(nx, sizeof(T)), row = nx * static_cast<int64_t>(sizeof(T)), rows = fit(ny, row);
  const int64_t layers = rows < ny ? 1 : fit(box.hi[2] - box.lo[2], ny * row);
  const SetValue material = strongest_material(reader.meta());
  std::vector<T> slab;
  for (int64_t z = box.lo[2]; z < box.hi[2]; z += layers)
    for (int64_t y = box.lo[1]; y < box.hi[1]; y += rows)
      for (int64_t x = box.lo[0]; x < box.hi[0]; x += columns) {
        stop_if(stop, o.output);
        const Box part{{x, y, z}, {std::min(box.hi[0], x + columns), std::min(box.hi[1], y + rows), std::min(box.hi[2], z + layers)}};
        const int64_t width = part.hi[0] - x, height = part.hi[1] - y;
        slab.resize(static_cast<size_t>(width * height * (part.hi[2] - z)));
        read_box<T>(reader, o.level, part, material, 0, slab.data(), {1, width, width * height});
        file.append({reinterpret_cast<const uint8_t*>(slab.data()), slab.size() * sizeof(T)});  // little endian, like every machine this runs on
      }
}

void run(const Options& o) {
  std::string format = o.format;
  if (format.empty()) {
    const std::string extension = std::filesystem::path(o.output).extension();
    if (extension != ".npy" && extension != ".raw")
      throw UsageError(fmt::format("--output: expected a name that ends in .npy or .raw, or --format, found '{}'", o.output));
    format = extension.substr(1);
  }
  refuse_overwriting({o.grid}, o.output);
  const GridReader reader(o.grid);
  const Metadata& meta = reader.meta();
  check_level(meta.grid, o.level);
  const Box box = o.region.empty() ? meta.grid.box(o.level) : parse_region(o.region, meta.grid, o.level);
  const bool wide = wide_labels(meta);
  const std::atomic<bool>& stop = watch_interrupts();  // before there is a file to leave behind
  OutputFile file(o.output);
  if (format == "npy") file.append(npy_header(wide ? "<u2" : "|u1", {box.hi[2] - box.lo[2], box.hi[1] - box.lo[1], box.hi[0] - box.lo[0]}));
  if (wide) write_cells<uint16_t>(reader, o, box, stop, file);
  else write_cells<uint8_t>(reader, o, box, stop, file);
  file.commit();
}

}  // namespace

Run setup_export(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  app.add_option("grid", o->grid, "a .tcell file")->required();
  app.add_option("-o,--output", o->output, "the file to write")->required();
  app.add_option("--format", o->format, "npy or raw (default: by the name's ending)")->check(one_of({"npy", "raw"}));
  app.add_option("--region", o->region, "X0,Y0,Z0,X1,Y1,Z1: half open, in cells of the level (default: all)");
  app.add_option("--level", o->level, "of the pyramid (default 0)");
  app.footer("Material ids in C order [z][y][x], uint8, or uint16 past 256 materials. Example:\n"
             "  teracell export g.tcell --region 0,0,0,256,256,256 -o box.npy");
  return [o] { run(*o); };
}

}  // namespace teracell
