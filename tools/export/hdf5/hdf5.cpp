// HDF5 files. What lies in them, and by what name, depends on the program that reads them: a profile.
#include <fmt/format.h>

#include "store/base/error.hpp"
#include "tools/export/arrays/two_files.hpp"
#include "tools/export/hdf5/profiles.hpp"
#include "tools/export/media.hpp"
#include "tools/export/shares.hpp"

namespace teracell::exports {
namespace {

struct Profile {
  const char* name;
  bool media;   // whether it takes the options of media instead of a map
  bool shares;  // whether it can hold shares of materials
  void (*write)(const Export&);
};
constexpr Profile kProfiles[] = {{"plain", false, true, write_plain},
                                 {"meep", true, true, write_meep},
                                 {"gprmax", true, false, write_gprmax},
                                 {"openems", true, false, write_disc_material}};

std::string names_of_profiles() {
  std::string out;
  for (const Profile& p : kProfiles) out += fmt::format("{}{}", out.empty() ? "" : &p + 1 == std::end(kProfiles) ? " or " : ", ", p.name);
  return out;
}

void write_hdf5(const Export& e) {
  const std::string name = e.has("--profile") ? e.options.at("--profile") : "plain";
  for (const Profile& p : kProfiles) {
    if (name != p.name) continue;
    if (p.media && !e.map.empty()) throw UsageError(fmt::format("--map: the profile {} has no numbers for materials: give --epsilon", name));
    for (const ExportOption& option : media_options())
      if (!p.media && e.has(option.name)) throw UsageError(fmt::format("{}: the profile {} has no such option", option.name, name));
    if (!p.shares && e.has(shares_option().name))
      throw UsageError(fmt::format("{}: the profile {} has one material for each cell", shares_option().name, name));
    return p.write(e);
  }
  throw UsageError(fmt::format("--profile: expected {}, found '{}'", names_of_profiles(), name));
}

}  // namespace

std::filesystem::path beside(const Export& e, const std::filesystem::path& name) {
  if (name == e.output) throw UsageError(fmt::format("--output: {} is the name of a second file of this format: take another one", name.string()));
  return expect_other_file(e, name);
}

void expect_uniform(const Export& e, const char* profile) {
  for (int d = 0; d < 3; ++d)
    if (e.reader.meta().grid.axis[d].is_graded())
      throw UsageError(
          fmt::format("--profile: {} has uniform axes, found a graded axis {}: mesh with uniform axes, or take plain", profile, axis_name(d)));
}

ExportFormat hdf5_format() {
  ExportFormat out = {"hdf5", {".h5", ".hdf5"}, "an HDF5 file, for any program or for one solver", write_hdf5};
  out.options = media_options();
  out.options.push_back(shares_option());
  out.options.insert(out.options.begin(), {"--profile", "NAME", names_of_profiles() + " (default plain)"});
  return out;
}

}  // namespace teracell::exports
