#include "tools/export/formats.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "store/error.hpp"
#include "tools/export/assignments.hpp"

// One line per format NAME: the file NAME.cpp, here or in a folder, defines NAME_format(); vti and vtr share vtk.cpp.
// clang-format off
#define TERACELL_EXPORT_FORMATS(format) \
  format(hdf5) \
  format(mhd) \
  format(npy) \
  format(nrrd) \
  format(openems) \
  format(openfoam) \
  format(palabos) \
  format(ply) \
  format(raw) \
  format(stl) \
  format(vti) \
  format(vtr) \
  format(xdmf) \
  format(zarr)
// clang-format on

namespace teracell {

SetValue Export::number() const {
  if (map.empty()) return strongest_material(reader.meta());
  return [material = strongest_material(reader.meta()), numbers = map](const std::vector<Label>& set) { return numbers[material(set)]; };
}

uint32_t Export::most() const { return map.empty() ? static_cast<uint32_t>(reader.meta().materials.size()) - 1 : std::ranges::max(map); }

std::vector<bool> Export::materials(const std::string& option) const {
  const std::vector<MaterialInfo>& all = reader.meta().materials;
  std::vector<bool> out(all.size(), false);
  for (std::string_view rest = options.at(option); !rest.empty();) {
    const std::string_view name = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(rest.size(), name.size() + 1));
    out[material_named(all, std::string(name), option)] = true;
  }
  return out;
}

int64_t Export::integer(const std::string& option, int64_t least, int64_t most) const {
  const std::string& text = options.at(option);
  int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < least || value > most)
    throw UsageError(fmt::format("{}: expected {} to {}, found '{}'", option, least, most, text));
  return value;
}

#define DECLARED(name) ExportFormat name##_format();
#define LISTED(name) name##_format(),

TERACELL_EXPORT_FORMATS(DECLARED)

const std::vector<ExportFormat>& export_formats() {
  static const std::vector<ExportFormat> formats = {TERACELL_EXPORT_FORMATS(LISTED)};
  return formats;
}

#undef DECLARED
#undef LISTED

const ExportFormat* export_format_named(const std::string& name) {
  const auto it = std::ranges::find(export_formats(), name, &ExportFormat::name);
  return it == export_formats().end() ? nullptr : &*it;
}

const ExportFormat* export_format_of(const std::filesystem::path& output) {
  const std::string extension = output.extension();
  for (const ExportFormat& format : export_formats())
    if (std::ranges::count(format.extensions, extension) > 0) return &format;
  return nullptr;
}

}  // namespace teracell
