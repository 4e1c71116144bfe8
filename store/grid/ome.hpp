// Metadata of OME-Zarr: where the cells of each level lie, and what the numbers in them stand for.
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "store/grid/metadata.hpp"

namespace teracell::inline store {

// The cells of a level that cover `box`, which counts cells of the level `levels` below.
Box box_above(const Box& box, int levels);

// An entry of "multiscales": the array named L has the cells of level L that cover `box`, a box of the level `from`.
nlohmann::ordered_json multiscale_json(const Metadata& meta, const std::string& name, int from, const Box& box);
// The same for all cells.
nlohmann::ordered_json multiscale_json(const Metadata& meta, const std::string& name);

// The "colors" and "properties" of an "image-label" whose values are ids of materials.
nlohmann::ordered_json image_label_json(const Metadata& meta);

}  // namespace teracell::store
