// What gprMax's #geometry_objects_read takes: a dataset `data`, int16 [x][y][z], whose numbers are lines of a text file of materials
// beside it. Where it is -1, gprMax keeps what the model has there.
#include <cmath>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "tools/export/hdf5/h5_cells.hpp"
#include "tools/export/hdf5/profiles.hpp"
#include "tools/export/media.hpp"
#include "tools/export/solvers.hpp"

namespace teracell::exports {
namespace {

// With a point, as gprMax writes its numbers.
std::string real(double x) {
  std::string text = fmt::format("{}", x);
  if (text.find_first_not_of("-0123456789") == text.npos) text += ".0";
  return text;
}

}  // namespace

void write_gprmax(const Export& e) {
  expect_uniform(e, "gprmax");
  const Metadata& meta = e.reader.meta();
  const double metre = metres(meta.units, "gprMax");
  const std::vector<Medium> media = media_of(e, false);
  std::vector<int16_t> numbers(media.size(), -1);
  std::string lines;
  std::set<std::string> names;
  for (size_t id = 0; id < media.size(); ++id) {
    if (!media[id].given) continue;
    const Medium& m = media[id];
    if (m.epsilon < 1 || m.mu < 1)
      throw UsageError(
          fmt::format("--epsilon, --mu: gprMax has numbers from 1 on, found {} for '{}'", std::min(m.epsilon, m.mu), meta.materials[id].name));
    if (names.size() > 32767) throw UsageError("--epsilon: gprMax has at most 32768 materials in a file");
    numbers[id] = static_cast<int16_t>(names.size());
    // Never "1 0 1 0": gprMax drops lines that are those of its own materials.
    lines += fmt::format("#material: {} {} {} 0 {}\n", real(m.epsilon), real(m.sigma), real(m.mu), word(meta.materials[id].name, names));
  }
  std::filesystem::path stem = e.output;
  stem.replace_extension();
  OutputFile materials(beside(e, stem.string() + "_materials.txt"));
  materials.append({reinterpret_cast<const uint8_t*>(lines.data()), lines.size()});

  H5File file(e.output);
  std::array<double, 3> step;
  for (size_t d = 0; d < 3; ++d) step[d] = std::ldexp(meta.grid.axis[d].step(), e.level) * metre;
  file.attribute(file.id(), "dx_dy_dz", std::span<const double>(step));
  write_cells(file, e, "data", kZFastest, numbers);
  materials.sync();
  file.finish();
  std::error_code ignored;
  std::filesystem::remove(e.output, ignored);  // an older one has numbers of other lines
  materials.commit();
  file.commit();
}

}  // namespace teracell::exports
