#include "store/grid/ome.hpp"

#include <nlohmann/json.hpp>

#include "store/grid/space.hpp"
#include "store/text/color.hpp"

namespace teracell::inline store {
namespace {

using nlohmann::ordered_json;

int64_t longest_side(const Box& box) { return std::max({box.hi[0] - box.lo[0], box.hi[1] - box.lo[1], box.hi[2] - box.lo[2]}); }

// Viewers that don't clip coarse levels, such as Neuroglancer, show up to one coarse cell beyond the grid's end. So documents list
// levels only up to the first that is a single block. Coarser levels can still be asked for.
int last_listed(int from, const Box& box) {
  constexpr int64_t kBlock = 64;
  int level = from;
  while (longest_side(box_above(box, level - from)) > kBlock) ++level;
  return level;
}

}  // namespace

Box box_above(const Box& box, int levels) {
  Box out;
  for (int d = 0; d < 3; ++d) out.lo[d] = box.lo[d] >> levels, out.hi[d] = ceil_shift(box.hi[d], levels);
  return out;
}

ordered_json multiscale_json(const Metadata& meta, const std::string& name, int from, const Box& box) {
  const Space space(meta);
  ordered_json axes = ordered_json::array(), datasets = ordered_json::array();
  for (const int axis : {2, 1, 0}) {
    axes.push_back({{"name", axis_name(axis)}, {"type", "space"}});
    if (!space.index) axes.back()["unit"] = space.unit;
  }
  for (int level = from; level <= last_listed(from, box); ++level) {
    const Box cells = box_above(box, level - from);
    ordered_json scale = ordered_json::array(), translation = ordered_json::array();
    for (const int axis : {2, 1, 0}) {
      scale.push_back(space.step(axis, level));
      translation.push_back(space.first(axis, level) + static_cast<double>(cells.lo[axis]) * space.step(axis, level));
    }
    const ordered_json to_space = {{{"type", "scale"}, {"scale", scale}}, {{"type", "translation"}, {"translation", translation}}};
    datasets.push_back({{"path", std::to_string(level)}, {"coordinateTransformations", to_space}});
  }
  return {{"name", name}, {"axes", axes}, {"datasets", datasets}};
}

ordered_json multiscale_json(const Metadata& meta, const std::string& name) { return multiscale_json(meta, name, 0, meta.grid.box(0)); }

ordered_json image_label_json(const Metadata& meta) {
  ordered_json colors = ordered_json::array(), properties = ordered_json::array();
  for (size_t id = 0; id < meta.materials.size(); ++id) {
    const MaterialInfo& material = meta.materials[id];
    properties.push_back({{"label-value", id}, {"name", material.name}});
    if (const auto color = parse_color(material.color)) colors.push_back({{"label-value", id}, {"rgba", *color}});
  }
  return {{"colors", colors}, {"properties", properties}};
}

}  // namespace teracell::store
