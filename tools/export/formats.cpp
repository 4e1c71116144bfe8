#include "tools/export/formats.hpp"

#include <algorithm>

// One line per format NAME: the file NAME.cpp, here or in a folder, defines NAME_format(); vti and vtr share vtk.cpp.
// clang-format off
#ifdef TERACELL_HDF5
#define TERACELL_HDF5_FORMATS(format) format(hdf5) format(xdmf)
#else
#define TERACELL_HDF5_FORMATS(format)
#endif
#define TERACELL_EXPORT_FORMATS(format) \
  TERACELL_HDF5_FORMATS(format) \
  format(leaves) \
  format(links) \
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
  format(vtu) \
  format(zarr)
// clang-format on

namespace teracell::exports {

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

}  // namespace teracell::exports
