#include "tools/export/media.hpp"

#include <limits>

#include <fmt/format.h>

#include "store/error.hpp"
#include "tools/export/assignments.hpp"

namespace teracell {
namespace {

// Calls take(material id, value) for each assignment of an option that may be missing.
template <class Take>
void for_each_assignment(const Export& e, const std::string& option, const Take& take) {
  if (!e.has(option)) return;
  for (const auto& [name, text] : parse_assignments(e.options.at(option), option))
    take(material_named(e.reader.meta().materials, name, option),
         text == "inf" ? std::numeric_limits<double>::infinity() : parse_number(text, fmt::format("{}: {}", option, name)));
}

}  // namespace

std::vector<ExportOption> media_options() {
  return {{"--epsilon", "NAME=NUMBER,...", "the relative permittivity of each material"},
          {"--sigma", "NAME=NUMBER,...", "conductivities in S/m, inf for perfect conductors (default 0)"},
          {"--mu", "NAME=NUMBER,...", "relative permeabilities (default 1)"}};
}

std::vector<Medium> media_of(const Export& e, bool all) {
  std::vector<Medium> media(e.reader.meta().materials.size());
  std::vector<bool> named(media.size(), false);
  named[0] = !all;
  for_each_assignment(e, "--epsilon", [&](size_t id, double value) {
    if (!(value > 0) || value == std::numeric_limits<double>::infinity())
      throw UsageError(fmt::format("--epsilon: {}: expected a number above 0, found {}", e.reader.meta().materials[id].name, value));
    media[id].given = named[id] = true;
    media[id].epsilon = value;
  });
  expect_named(e.reader, e.level, e.box, named, "--epsilon");
  const auto expect_given = [&](size_t id, const char* option) {
    if (!media[id].given)
      throw UsageError(fmt::format("{0}: expected --epsilon for '{1}' too, found {0} alone", option, e.reader.meta().materials[id].name));
  };
  for_each_assignment(e, "--sigma", [&](size_t id, double value) {
    expect_given(id, "--sigma");
    if (!(value >= 0))
      throw UsageError(fmt::format("--sigma: {}: expected 0, a larger number or inf, found {}", e.reader.meta().materials[id].name, value));
    media[id].sigma = value;
  });
  for_each_assignment(e, "--mu", [&](size_t id, double value) {
    expect_given(id, "--mu");
    if (!(value > 0) || value == std::numeric_limits<double>::infinity())
      throw UsageError(fmt::format("--mu: {}: expected a number above 0, found {}", e.reader.meta().materials[id].name, value));
    media[id].mu = value;
  });
  return media;
}

}  // namespace teracell
