// Cells as a dataset of HDF5: in chunks of up to 256 KiB, each compressed by shuffle and deflate.
#pragma once
#include "store/channels/fraction_reader.hpp"
#include "tools/export/arrays/dense.hpp"
#include "tools/export/hdf5/h5_file.hpp"

namespace teracell::exports {

// Writes values[id] for the cells of each material, and calls e.progress with the share that is done, from 0 to 1. T is a type of h5_type().
template <class T>
H5Handle write_cells(H5File& file, const Export& e, const char* name, const AxisOrder& order, const std::vector<T>& values);

// The same of the share of a material in each cell, as a float.
H5Handle write_shares(H5File& file, const Export& e, const char* name, const AxisOrder& order, uint32_t material, const FractionReader& shares);

// The same of the mean of `values` in each cell (FractionReader::read_means), as a double.
H5Handle write_means(H5File& file, const Export& e, const char* name, const AxisOrder& order, const std::vector<double>& values,
                     const FractionReader& shares);

}  // namespace teracell::exports
