// Refusals that the kernels of this folder share.
#pragma once

#include <cmath>
#include <stdexcept>

#include "shared/arrays.hpp"

namespace trundle::localization {

inline void refuse_unless(bool good, const char *message) {
  if (!good) throw std::invalid_argument(message);
}

inline void refuse_infinite(const double *numbers, std::size_t count, const char *message) {
  for (std::size_t i = 0; i < count; ++i) refuse_unless(std::isfinite(numbers[i]), message);
}

// Coordinates beyond this are no place on a map, and would not fit whole numbers of cells.
constexpr double kFar = 1e7;

inline void refuse_far(const double *numbers, std::size_t count, const char *message) {
  for (std::size_t i = 0; i < count; ++i) refuse_unless(std::abs(numbers[i]) <= kFar, message);
}

inline void check_resolution(double resolution) {
  refuse_unless(resolution >= 1e-4 && resolution <= 1e4, "the resolution must be from 0.1 mm to 10 km");
}

inline void check_points(const In<double, 2> &points) {
  refuse_unless(points.shape(1) == 2, "points need shape (N, 2)");
  refuse_far(points.data(), points.size(), "points must be finite and within 10,000 km");
}

inline void check_poses(const In<double, 2> &poses) {
  refuse_unless(poses.shape(1) == 3, "poses need shape (N, 3)");
  refuse_far(poses.data(), poses.size(), "poses must be finite and within 10,000 km");
}

}  // namespace trundle::localization
