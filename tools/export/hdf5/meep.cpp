// Meep's epsilon_input_file: a dataset `eps`, [x][y][z], which Meep stretches over its cell and interpolates. With shares, a cut cell has the
// mean of what its materials have, which takes most of the stairs out of the field.
#include <fmt/format.h>

#include "store/base/error.hpp"
#include "tools/export/hdf5/h5_cells.hpp"
#include "tools/export/hdf5/profiles.hpp"
#include "tools/export/media.hpp"
#include "tools/export/shares.hpp"

namespace teracell::exports {

void write_meep(const Export& e) {
  expect_uniform(e, "meep");
  for (const char* option : {"--sigma", "--mu"})
    if (e.has(option)) throw UsageError(fmt::format("{}: Meep reads --epsilon alone from a file", option));
  std::vector<double> epsilon;
  for (const Medium& m : media_of(e, true)) epsilon.push_back(m.epsilon);
  const std::optional<FractionReader> shares = shares_of(e);
  H5File file(e.output);
  if (shares) write_means(file, e, "eps", kZFastest, epsilon, *shares);
  else write_cells(file, e, "eps", kZFastest, epsilon);
  file.commit();
}

}  // namespace teracell::exports
