// What programs expect of an HDF5 file. Each profile has a file of its own here, and one line in hdf5.cpp.
#pragma once
#include "tools/export/format.hpp"
#include "tools/export/hdf5/h5_file.hpp"

namespace teracell::exports {

// Cells, planes and materials as teracell has them: tools/export/EXPORTS.md describes the layout.
void put_plain(H5File& file, const Export& e);

void write_plain(const Export& e);
void write_meep(const Export& e);
void write_gprmax(const Export& e);
void write_disc_material(const Export& e);

// The name of a second file beside the output. Throws UsageError when it is that of the output, or when the grid would be overwritten.
std::filesystem::path beside(const Export& e, const std::filesystem::path& name);
// Throws UsageError unless all axes are uniform.
void expect_uniform(const Export& e, const char* profile);

}  // namespace teracell::exports
