// What the CAD kernel says of a file.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace teracell::mesher {

// Of a solid or a shell, in the units that the file was read in.
struct CadShape {
  uint64_t faces = 0, faces_without_facets = 0;
  bool closed = false;                                 // its facets are
  double facet_volume = 0, facet_area = 0;
  std::optional<double> kernel_volume, sender_volume;  // of the exact shape; what the file says of it
  void scale(double volume, double area) {
    facet_volume *= volume, facet_area *= area;
    for (std::optional<double>* v : {&kernel_volume, &sender_volume})
      if (*v) **v *= volume;
  }
};
struct CadFacts {
  std::string kernel;     // "OpenCASCADE 7.6.3"
  std::string key, hash;  // of file, kernel and options, by which the facets are kept; of the facets
  double deflection, angle;
  std::vector<CadShape> shapes;
};
// Parts that a body takes of one shape and scale.
struct CadPart {
  std::string path;  // of the first
  uint64_t instances = 1;
  CadShape shape;
};

}  // namespace teracell::mesher
