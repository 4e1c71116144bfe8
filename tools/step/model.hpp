// A STEP file as OpenCASCADE reads it: the tree of its products and occurrences, and each distinct solid once. Lengths are in millimetres,
// into which the kernel converts every unit.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <TopoDS_Shape.hxx>
#include <unordered_map>
#include <vector>

namespace teracell::step {

// p' = M p + t, row by row.
using Matrix = std::array<double, 12>;

// A solid, or what else has faces: a shell outside of solids, or all faces outside of shells.
struct Shape {
  TopoDS_Shape shape;  // at its product's place
  size_t faces = 0;
  std::optional<double> sender_volume;                      // the validation property of its product
  std::unordered_map<const void*, std::string> face_color;  // of faces (their TShape) with another colour than their part: "#rrggbb"
};

struct Node {
  std::string name;                      // where its use has none
  std::string product, color, material;  // of its shape
  std::optional<uint32_t> shape;
  struct Use {
    uint32_t node;
    Matrix matrix;
    std::string name;
  };
  std::vector<Use> uses;
};

struct Model {
  std::vector<Shape> shapes;
  std::vector<Node> nodes;
  std::vector<Node::Use> roots;
};

// Throws std::runtime_error with a sentence that says what is wrong. OpenCASCADE's own exceptions pass through.
Model read_model(const std::string& path);

}  // namespace teracell::step
