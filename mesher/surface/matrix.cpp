#include "mesher/surface/matrix.hpp"

#include <algorithm>
#include <cmath>

namespace teracell::mesher {

Vec3 transform(const Matrix& m, const Vec3& p) {
  Vec3 out;
  for (size_t row = 0; row < 3; ++row) out[row] = ((m[4 * row] * p[0] + m[4 * row + 1] * p[1]) + m[4 * row + 2] * p[2]) + m[4 * row + 3];
  return out;
}

Matrix product(const Matrix& outer, const Matrix& inner) {
  Matrix out;
  for (size_t row = 0; row < 3; ++row)
    for (size_t column = 0; column < 4; ++column) {
      const double* a = &outer[4 * row];
      const double sum = (a[0] * inner[column] + a[1] * inner[4 + column]) + a[2] * inner[8 + column];
      out[4 * row + column] = column < 3 ? sum : sum + a[3];
    }
  return out;
}

double determinant(const Matrix& m) {
  const double x = m[5] * m[10] - m[6] * m[9], y = m[4] * m[10] - m[6] * m[8], z = m[4] * m[9] - m[5] * m[8];
  return (m[0] * x - m[1] * y) + m[2] * z;
}

double longest_column(const Matrix& m) {
  double longest = 0;
  for (size_t c = 0; c < 3; ++c) longest = std::max(longest, std::sqrt((m[c] * m[c] + m[4 + c] * m[4 + c]) + m[8 + c] * m[8 + c]));
  return longest;
}

bool mirrors(const Matrix& m) { return determinant(m) < 0; }

Matrix placement(const Vec3& t, const std::array<double, 4>& quaternion, const Vec3& s) {
  auto [x, y, z, w] = quaternion;
  const double length = std::sqrt(((x * x + y * y) + z * z) + w * w);
  x /= length, y /= length, z /= length, w /= length;
  const auto entry = [](double a, double b) { return 2 * (a + b); };
  return {(1 - entry(y * y, z * z)) * s[0], entry(x * y, -(z * w)) * s[1],    entry(x * z, y * w) * s[2],       t[0],
          entry(x * y, z * w) * s[0],       (1 - entry(x * x, z * z)) * s[1], entry(y * z, -(x * w)) * s[2],    t[1],
          entry(x * z, -(y * w)) * s[0],    entry(y * z, x * w) * s[1],       (1 - entry(x * x, y * y)) * s[2], t[2]};
}

}  // namespace teracell::mesher
