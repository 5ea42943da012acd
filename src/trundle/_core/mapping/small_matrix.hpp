// Symmetric positive definite matrices of three rows: solved and inverted by Cholesky's decomposition.
#pragma once

#include <array>
#include <cmath>

namespace trundle::mapping {

using Matrix3 = std::array<double, 9>;

// False where the matrix is not positive definite.
inline bool solve(const Matrix3 &a, const std::array<double, 3> &b, std::array<double, 3> &x) {
  if (!(a[0] > 0.0)) return false;
  const double s0 = std::sqrt(a[0]), l10 = a[3] / s0, l20 = a[6] / s0, d1 = a[4] - l10 * l10;
  if (!(d1 > 0.0)) return false;
  const double s1 = std::sqrt(d1), l21 = (a[7] - l20 * l10) / s1, d2 = a[8] - l20 * l20 - l21 * l21;
  if (!(d2 > 0.0)) return false;
  const double s2 = std::sqrt(d2);
  const double y0 = b[0] / s0, y1 = (b[1] - l10 * y0) / s1, y2 = (b[2] - l20 * y0 - l21 * y1) / s2;
  x[2] = y2 / s2;
  x[1] = (y1 - l21 * x[2]) / s1;
  x[0] = (y0 - l10 * x[1] - l20 * x[2]) / s0;
  return std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]);
}

inline bool invert(const Matrix3 &a, Matrix3 &inverse) {
  for (int column = 0; column < 3; ++column) {
    std::array<double, 3> unit{}, x{};
    unit[static_cast<std::size_t>(column)] = 1.0;
    if (!solve(a, unit, x)) return false;
    for (int row = 0; row < 3; ++row) inverse[static_cast<std::size_t>(3 * row + column)] = x[static_cast<std::size_t>(row)];
  }
  return true;
}

}  // namespace trundle::mapping
