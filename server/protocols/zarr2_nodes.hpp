// What both protocols of Zarr v2 share (zarr2, xarray): the documents of groups and arrays, and the cubes of labels.
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "server/protocols/protocol.hpp"

namespace teracell::server {

nlohmann::ordered_json zarr2_group();
nlohmann::ordered_json zarr2_array(const nlohmann::ordered_json& shape, const nlohmann::ordered_json& chunks, const char* type,
                                   const nlohmann::ordered_json& fill);
// The array of a level's labels.
nlohmann::ordered_json zarr2_labels(const Metadata& meta, int level, const nlohmann::ordered_json& fill);
// Its attributes: the names of the dimensions, which xarray reads, and those of the materials. A document that has the attributes of
// many levels has these names once: there may be megabytes of them.
nlohmann::ordered_json zarr2_label_attributes(const Metadata& meta, bool with_names);

// The document that holds all the others.
inline constexpr const char* kZarr2Consolidated = ".zmetadata";
// One of the documents, or the consolidated one.
std::optional<Service::Recipe> find_zarr2_document(const Documents& documents, std::span<const std::string> path);
// The cube of labels with the key "z", "y", "x".
std::optional<Service::Recipe> find_zarr2_cube(const ServedGrid& grid, int level, std::span<const std::string> key);

}  // namespace teracell::server
