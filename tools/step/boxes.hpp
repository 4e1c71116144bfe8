// The box of instances of shapes, of the exact geometry and not of facets.
#pragma once
#include <array>
#include <map>
#include <vector>

#include "tools/step/model.hpp"

namespace teracell::step {

struct Instance {
  uint32_t shape;
  Matrix matrix;
};

struct Box {
  std::array<double, 3> lo, hi;
};

// Remembers what it found of shapes.
class Boxes {
 public:
  explicit Boxes(const Model& model) : model_(model) {}
  // REQUIRES: there are instances, and their shapes are in the model.
  Box around(const std::vector<Instance>& instances);

 private:
  struct Faces {
    std::vector<TopoDS_Shape> list;
    std::vector<Box> loose;  // of each one, and
    Box all;                 // of all
  };
  const Faces& faces_of(uint32_t shape);
  Box tight(const Instance& instance);
  const Model& model_;
  std::map<uint32_t, Faces> faces_;
  std::map<std::pair<uint32_t, std::array<double, 9>>, Box> tight_;  // by shape and rotation
};

}  // namespace teracell::step
