// A field between the centres of its cells: bilinear values and slopes.
#pragma once

#include <cmath>
#include <cstddef>

namespace trundle::localization {

struct Slope {
  double value, x, y;
};

struct FieldView {
  const float *values;
  std::ptrdiff_t rows, cols;
  double per_metre;  // cells
  double limit;      // value where nothing is known
  bool known(double x, double y) const {
    const double u = x * per_metre - 0.5, v = y * per_metre - 0.5;
    return u >= 0.0 && v >= 0.0 && u < static_cast<double>(cols - 1) && v < static_cast<double>(rows - 1);
  }

  Slope at(double x, double y) const {
    const double u = x * per_metre - 0.5, v = y * per_metre - 0.5;
    if (!(u >= 0.0 && v >= 0.0 && u < static_cast<double>(cols - 1) && v < static_cast<double>(rows - 1))) {
      return {limit, 0.0, 0.0};
    }
    const std::ptrdiff_t col = static_cast<std::ptrdiff_t>(u), row = static_cast<std::ptrdiff_t>(v);
    const double s = u - static_cast<double>(col), t = v - static_cast<double>(row);
    const float *below = values + row * cols + col, *above = below + cols;
    const double a = below[0], b = below[1], c = above[0], d = above[1];
    const double low = a + s * (b - a), high = c + s * (d - c);
    return {low + t * (high - low), ((1.0 - t) * (b - a) + t * (d - c)) * per_metre, (high - low) * per_metre};
  }
};

}  // namespace trundle::localization
