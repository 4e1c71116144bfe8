// What stands for a set of labels in arrays and pictures: ids of materials.
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "store/grid/label.hpp"
#include "store/grid/metadata.hpp"

namespace teracell::inline store {

// The number that stands for a set of labels in an array or a picture.
using SetValue = std::function<uint32_t(const std::vector<Label>&)>;
// The material of highest precedence.
SetValue strongest_material(const Metadata& meta);
// The ids of all materials of the set, ascending.
std::vector<uint32_t> materials_of(const Metadata& meta, const std::vector<Label>& set);

// Arrays of material ids have one byte per cell, or, if there are more than 256 materials, two bytes, little endian.
inline bool wide_labels(const Metadata& meta) { return meta.materials.size() > 256; }
// Appends ids in this form to bytes of any type.
template <class Out>
void put_labels(Out& out, std::span<const uint16_t> ids, bool wide) {
  for (const uint16_t id : ids) {
    out.push_back(static_cast<typename Out::value_type>(id));
    if (wide) out.push_back(static_cast<typename Out::value_type>(id >> 8));
  }
}

}  // namespace teracell::store
