// The file of CSXCAD's DiscMaterial, version 2: cells [z][y][x] as places in lists of properties, and the planes.
#include <cmath>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "tools/export/hdf5/h5_cells.hpp"
#include "tools/export/hdf5/profiles.hpp"
#include "tools/export/media.hpp"
#include "tools/export/place.hpp"

namespace teracell::exports {

void write_disc_material(const Export& e) {
  const std::vector<Medium> media = media_of(e, false);
  const Index3 n = size_of(e.box);
  if (static_cast<double>(n[0]) * static_cast<double>(n[1]) * static_cast<double>(n[2]) > 0xffffffff)
    throw UsageError(fmt::format("CSXCAD has at most 4294967295 cells in a DiscMaterial, found {}: take --region or --level", cell_count_text(n)));
  std::vector<uint8_t> places(media.size(), 0);  // the first one is the background
  std::vector<float> epsilon, kappa, mu, sigma;
  for (size_t id = 0; id < media.size(); ++id) {
    if (id > 0 && !media[id].given) continue;
    if (epsilon.size() == 256) throw UsageError("--epsilon: CSXCAD has at most 256 materials in a DiscMaterial");
    if (std::isinf(media[id].sigma))
      throw UsageError(
          fmt::format("--sigma: a DiscMaterial has no perfect conductors, found inf for '{}': give a large number, or take --format openems",
                      e.reader.meta().materials[id].name));
    places[id] = static_cast<uint8_t>(epsilon.size());
    epsilon.push_back(static_cast<float>(media[id].epsilon));
    kappa.push_back(static_cast<float>(media[id].sigma));
    mu.push_back(static_cast<float>(media[id].mu));
    sigma.push_back(0);
  }
  H5File file(e.output);
  file.attribute(file.id(), "Version", 2.0);
  const H5Handle mesh = file.group("mesh");
  for (int d = 0; d < 3; ++d) file.doubles(mesh, axis_name(d).c_str(), n[d] + 1, [&](int64_t i) { return plane_of(e, d, i); });
  const H5Handle cells = write_cells(file, e, "DiscData", kXFastest, places);
  file.attribute(cells, "DB_Size", static_cast<int32_t>(epsilon.size()));
  for (const auto& [name, list] : {std::pair("epsR", &epsilon), {"kappa", &kappa}, {"mueR", &mu}, {"sigma", &sigma}})
    file.attribute(cells, name, std::span<const float>(*list));
  file.commit();
}

}  // namespace teracell::exports
