// A ray from cell to cell of a grid: Amanatides and Woo, A Fast Voxel Traversal Algorithm (1987).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

namespace trundle {

constexpr double kNoHit = std::numeric_limits<double>::infinity();

struct CellBytes {
  const std::uint8_t *cells;
  std::ptrdiff_t rows, cols;

  bool contains(std::ptrdiff_t row, std::ptrdiff_t col) const {
    return row >= 0 && row < rows && col >= 0 && col < cols;
  }
  std::uint8_t at(std::ptrdiff_t row, std::ptrdiff_t col) const { return cells[row * cols + col]; }
};

// How a ray crosses the lines between columns, or between rows, from (place) in cell units in cell `cell` along
// `direction`: the distance of the first line, and from each line to the next.
struct Crossings {
  std::ptrdiff_t step;
  double first, spacing;

  Crossings(double place, std::ptrdiff_t cell, double direction)
      : step(direction > 0.0 ? 1 : -1),
        first(direction != 0.0 ? (cell + (direction > 0.0 ? 1 : 0) - place) / direction : kNoHit),
        spacing(direction != 0.0 ? 1.0 / std::abs(direction) : kNoHit) {}
};

inline std::ptrdiff_t cell_at(double place, std::ptrdiff_t count) {
  return static_cast<std::ptrdiff_t>(std::clamp(std::floor(place), 0.0, count - 1.0));
}

// Distance in cells from (x, y), in cell units, along the unit vector (dx, dy) to the first cell that `is_blocked`, or
// infinity where there is none within `reach`. A ray that starts in such a cell reads 0.
template <typename IsBlocked>
double walk_ray(const CellBytes &grid, double x, double y, double dx, double dy, double reach, IsBlocked is_blocked) {
  // Skip to where the ray enters the grid.
  double enter = 0.0, leave = reach;
  const double low[2] = {-x, -y}, high[2] = {grid.cols - x, grid.rows - y}, along[2] = {dx, dy};
  for (int axis = 0; axis < 2; ++axis) {
    if (along[axis] == 0.0) {
      if (low[axis] > 0.0 || high[axis] < 0.0) return kNoHit;
      continue;
    }
    double first = low[axis] / along[axis], second = high[axis] / along[axis];
    if (first > second) std::swap(first, second);
    enter = std::max(enter, first);
    leave = std::min(leave, second);
  }
  if (enter > leave) return kNoHit;

  // The entry of a ray from far away is rounded, and may lie outside.
  std::ptrdiff_t col = cell_at(x + enter * dx, grid.cols), row = cell_at(y + enter * dy, grid.rows);
  const Crossings by_col(x, col, dx), by_row(y, row, dy);
  double next_col = by_col.first, next_row = by_row.first, distance = enter;
  while (distance <= reach) {
    if (is_blocked(grid.cells[row * grid.cols + col])) return distance;
    if (next_col < next_row) {
      distance = next_col;
      next_col += by_col.spacing;
      col += by_col.step;
      if (col < 0 || col >= grid.cols) return kNoHit;
    } else {
      distance = next_row;
      next_row += by_row.spacing;
      row += by_row.step;
      if (row < 0 || row >= grid.rows) return kNoHit;
    }
  }
  return kNoHit;
}

}  // namespace trundle
