// Rays through a grid of blocked cells, for planar lidars: Amanatides and Woo, A Fast Voxel Traversal Algorithm (1987).
#include "rays/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace trundle {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Grid {
  const std::uint8_t *blocked;
  std::ptrdiff_t rows, cols;
};

// Distance in cells from (x, y), in cell units, along the unit vector (dx, dy) to the first blocked cell, or infinity
// where there is none within `reach`. A ray that starts in a blocked cell reads 0.
double cast_ray(const Grid &grid, double x, double y, double dx, double dy, double reach) {
  // Skip to where the ray enters the grid.
  double enter = 0.0, leave = reach;
  const double low[2] = {-x, -y}, high[2] = {grid.cols - x, grid.rows - y}, along[2] = {dx, dy};
  for (int axis = 0; axis < 2; ++axis) {
    if (along[axis] == 0.0) {
      if (low[axis] > 0.0 || high[axis] < 0.0) return kInfinity;
      continue;
    }
    double first = low[axis] / along[axis], second = high[axis] / along[axis];
    if (first > second) std::swap(first, second);
    enter = std::max(enter, first);
    leave = std::min(leave, second);
  }
  if (enter > leave) return kInfinity;

  // The entry of a ray from far away is rounded, and may lie outside.
  std::ptrdiff_t col = static_cast<std::ptrdiff_t>(std::clamp(std::floor(x + enter * dx), 0.0, grid.cols - 1.0));
  std::ptrdiff_t row = static_cast<std::ptrdiff_t>(std::clamp(std::floor(y + enter * dy), 0.0, grid.rows - 1.0));
  const std::ptrdiff_t col_step = dx > 0.0 ? 1 : -1, row_step = dy > 0.0 ? 1 : -1;
  const double col_delta = dx != 0.0 ? 1.0 / std::abs(dx) : kInfinity;
  const double row_delta = dy != 0.0 ? 1.0 / std::abs(dy) : kInfinity;
  double next_col = dx != 0.0 ? (col + (dx > 0.0 ? 1 : 0) - x) / dx : kInfinity;
  double next_row = dy != 0.0 ? (row + (dy > 0.0 ? 1 : 0) - y) / dy : kInfinity;
  double distance = enter;
  while (distance <= reach) {
    if (grid.blocked[row * grid.cols + col]) return distance;
    if (next_col < next_row) {
      distance = next_col;
      next_col += col_delta;
      col += col_step;
      if (col < 0 || col >= grid.cols) return kInfinity;
    } else {
      distance = next_row;
      next_row += row_delta;
      row += row_step;
      if (row < 0 || row >= grid.rows) return kInfinity;
    }
  }
  return kInfinity;
}

}  // namespace

nb::ndarray<nb::numpy, double> cast_grid_rays(In<std::uint8_t, 2> blocked, double x, double y, In<double, 1> angles,
                                              double reach) {
  if (!std::isfinite(x) || !std::isfinite(y)) throw std::invalid_argument("the rays' origin must be finite");
  if (!(reach >= 0.0) || !std::isfinite(reach)) throw std::invalid_argument("reach must be a finite distance");
  const Grid grid{blocked.data(), static_cast<std::ptrdiff_t>(blocked.shape(0)),
                  static_cast<std::ptrdiff_t>(blocked.shape(1))};
  std::vector<double> out(angles.size(), kInfinity);
  {
    nb::gil_scoped_release release;
    if (grid.rows > 0 && grid.cols > 0) {
      for (std::size_t i = 0; i < out.size(); ++i) {
        const double angle = angles.data()[i];
        if (std::isfinite(angle)) out[i] = cast_ray(grid, x, y, std::cos(angle), std::sin(angle), reach);
      }
    }
  }
  const std::size_t count = out.size();
  return to_numpy(std::move(out), {count});
}

}  // namespace trundle
