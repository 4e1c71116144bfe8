#include "tools/export/media.hpp"

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "tools/export/assignments.hpp"

namespace teracell::exports {
namespace {

// Calls take(material id, value) for each assignment of an option that may be missing.
template <class Take>
void for_each_number(const Export& e, const std::string& option, const Take& take) {
  if (!e.has(option)) return;
  for_each_assignment(e.reader.meta().materials, e.options.at(option), option, [&](size_t id, const std::string& name, const std::string& text) {
    take(id, text == "inf" ? std::numeric_limits<double>::infinity() : parse_number(text, fmt::format("{}: {}", option, name)));
  });
}

}  // namespace

std::vector<ExportOption> media_options() {
  return {{"--epsilon", "NAME=NUMBER,...", "the relative permittivity of each material"},
          {"--sigma", "NAME=NUMBER,...", "conductivities in S/m, inf for perfect conductors (default 0)"},
          {"--mu", "NAME=NUMBER,...", "relative permeabilities (default 1)"}};
}

std::vector<Medium> media_of(const Export& e, bool all) {
  const std::vector<MaterialInfo>& materials = e.reader.meta().materials;
  std::vector<Medium> media(materials.size());
  const auto expect = [&](bool good, const char* option, size_t id, const char* expected, double found) {
    if (!good) throw UsageError(fmt::format("{}: {}: expected {}, found {}", option, materials[id].name, expected, found));
  };
  const auto expect_given = [&](size_t id, const char* option) {
    if (!media[id].given) throw UsageError(fmt::format("{0}: expected --epsilon for '{1}' too, found {0} alone", option, materials[id].name));
  };
  for_each_number(e, "--epsilon", [&](size_t id, double value) {
    expect(value > 0 && std::isfinite(value), "--epsilon", id, "a number above 0", value);
    media[id].given = true;
    media[id].epsilon = value;
  });
  std::vector<bool> named;
  for (const Medium& m : media) named.push_back(m.given);
  if (!all) named[0] = true;
  expect_named(e.reader, e.level, e.box, named, "--epsilon");
  for_each_number(e, "--sigma", [&](size_t id, double value) {
    expect_given(id, "--sigma");
    expect(value >= 0, "--sigma", id, "0, a larger number or inf", value);
    media[id].sigma = value;
  });
  for_each_number(e, "--mu", [&](size_t id, double value) {
    expect_given(id, "--mu");
    expect(value > 0 && std::isfinite(value), "--mu", id, "a number above 0", value);
    media[id].mu = value;
  });
  return media;
}

}  // namespace teracell::exports
