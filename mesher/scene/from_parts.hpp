// Scenes with a body for each part of assemblies and surfaces.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mesher/scene/scene.hpp"
#include "mesher/surface/read_options.hpp"
#include "store/base/spill.hpp"

namespace teracell::mesher {

// A body and a material for each part, both named by its path; a file whose only part has no name is a body named after the file. Throws
// UsageError for more parts than materials can be, and what read_facets() throws.
Scene scene_by_part(const std::vector<std::filesystem::path>& files, const Budget& budget, const CadOptions& cad = {});

// A scene as text for people to edit, with a body for each part.
struct SceneText {
  std::string text;  // JSON
  size_t bodies = 0, materials = 0;
  std::vector<std::string> guessed;  // names of materials that the files don't state
};
// `folder` is where the scene will lie: files are named relative to it. Cells along the longest axis, or a step.
SceneText scene_text(const std::vector<std::filesystem::path>& files, const std::filesystem::path& folder, std::optional<int64_t> cells,
                     std::optional<double> step, const std::string& units, const Budget& budget, const CadOptions& cad = {});

}  // namespace teracell::mesher
