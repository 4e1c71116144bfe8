// parse_scene on any text: an Error or a scene, never anything else; and a scene survives its normal form, but for the folder of a
// mesh with an absolute path, which others may not see.
#include <cstdlib>
#include <string>

#include <nlohmann/json.hpp>

#include "mesher/scene/scene.hpp"
#include "store/base/error.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace teracell;
  using namespace teracell::mesher;
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (text.find("planes") != std::string::npos && text.find("file") != std::string::npos) return 0;  // reads no files
  Scene scene;
  try {
    scene = parse_scene(text, "/nonexistent");
  } catch (const Error&) {
    return 0;
  }
  const std::string normal = normalised(scene);
  for (SceneBody& body : scene.bodies) body.mesh = std::filesystem::path("/nonexistent") / body.mesh_text;
  if (!(parse_scene(normal, "/nonexistent") == scene)) std::abort();
  try {
    resolve_grid(scene, {-1, 0, 2}, {1, 3, 2});
    override_grid(scene, {17});
    resolve_grid(scene, {-1, 0, 2}, {1, 3, 2});
  } catch (const Error&) {
  }
  return 0;
}
