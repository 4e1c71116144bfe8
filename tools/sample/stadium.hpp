// Built-in scenes: something to mesh before one has a model at hand.
#pragma once
#include <filesystem>

namespace teracell::sample {

// A stadium with an explosive charge, after the example of T. Ma, T. Ma, L. Hao: "Large-Scale Finite Difference Grid
// Generation and Visualization Method Based on Ray Casting Algorithm", MSAM 2020. Closed binary STL surfaces in metres,
// and scene.json (air, explosive, grandstand, structure; 1 m cells). The same bytes on every machine. All of it or,
// with an IoError, nothing.
void write_stadium(const std::filesystem::path& folder);

}  // namespace teracell::sample
