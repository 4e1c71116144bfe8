// Placements: affine maps of vertices, as scenes and assemblies have them.
#pragma once
#include <array>

#include "store/grid/grid.hpp"

namespace teracell::mesher {

// p' = M p + t. Each row m0 m1 m2 t is evaluated as ((m0 x + m1 y) + m2 z) + t, with one rounding per operation. Stored row by row.
using Matrix = std::array<double, 12>;
inline constexpr Matrix kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
Vec3 transform(const Matrix& m, const Vec3& p);

// First `inner`, then `outer`. Each entry is ((a0 b0 + a1 b1) + a2 b2), and its translation last.
Matrix product(const Matrix& outer, const Matrix& inner);
// Whether the determinant of the linear part is negative: then the map turns facets inside out.
bool mirrors(const Matrix& m);
double determinant(const Matrix& m);     // of the linear part
double longest_column(const Matrix& m);  // of the linear part: its length

// The rotation that a quaternion (x, y, z, w) stands for after division by its length, times `scale` along each axis before it, then the
// translation. REQUIRES: the quaternion is not 0.
Matrix placement(const Vec3& translation, const std::array<double, 4>& quaternion, const Vec3& scale);

}  // namespace teracell::mesher
