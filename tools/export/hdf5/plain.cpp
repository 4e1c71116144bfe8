// The layout for programs that have none of their own: cells [z][y][x], planes, materials.
#include <numeric>

#include <fmt/format.h>

#include "tools/export/arrays/dense.hpp"
#include "tools/export/hdf5/h5_cells.hpp"
#include "tools/export/hdf5/profiles.hpp"
#include "tools/export/place.hpp"
#include "tools/export/shares.hpp"

namespace teracell::exports {

void put_plain(H5File& file, const Export& e) {
  const Metadata& meta = e.reader.meta();
  file.attribute(file.id(), "units", meta.units);
  file.attribute(file.id(), "level", int32_t{e.level});
  file.attribute(file.id(), "region",
                 std::span<const int64_t>(std::array{e.box.lo[0], e.box.lo[1], e.box.lo[2], e.box.hi[0], e.box.hi[1], e.box.hi[2]}));
  file.attribute(file.id(), "content_hash", e.reader.hash());
  for (int d = 0; d < 3; ++d)
    file.doubles(file.id(), ("planes_" + axis_name(d)).c_str(), size_of(e.box)[d] + 1, [&](int64_t i) { return plane_of(e, d, i); });

  std::vector<uint32_t> numbers(meta.materials.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  if (!e.map.empty()) numbers = e.map;
  std::vector<const char*> names, colors;
  for (const MaterialInfo& m : meta.materials) names.push_back(m.name.c_str()), colors.push_back(m.color.c_str());
  const H5Handle materials = file.group("materials");
  file.dataset(materials, "number", std::span<const uint32_t>(numbers));
  file.dataset(materials, "name", names);
  file.dataset(materials, "color", colors);

  const std::optional<FractionReader> shares = shares_of(e);
  const size_t steps = 1 + (shares ? meta.materials.size() : 0);
  const Export cells = step_of(e, 0, steps);
  with_number(bytes_per_cell(e.most()),
              [&]<class T>(T) { write_cells(file, cells, "material", kXFastest, std::vector<T>(numbers.begin(), numbers.end())); });
  if (!shares) return;
  const H5Handle group = file.group("fractions");
  for (size_t id = 0; id + 1 < steps; ++id) {
    const H5Handle dataset =
        write_shares(file, step_of(e, id + 1, steps), fmt::format("fractions/{}", id).c_str(), kXFastest, static_cast<uint32_t>(id), *shares);
    file.attribute(dataset, "material", meta.materials[id].name);
  }
}

void write_plain(const Export& e) {
  H5File file(e.output);
  put_plain(file, e);
  file.commit();
}

}  // namespace teracell::exports
