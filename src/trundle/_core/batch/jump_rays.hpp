// Rays that jump: the Chebyshev distance of a free cell to the nearest blocked one is the size of the free square around
// it, and a ray goes on at that square's border.
//
// Exact: where the ray crosses a line of the grid is computed from the line alone, so a jump and a walk from cell to cell
// (Amanatides and Woo 1987) come to the same cell with the same distance, bit for bit. At a corner a ray goes to the
// next row first.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace trundle::batch {

// Chebyshev distances in cells to the nearest blocked cell, 0 in it, 255 at most.
struct JumpField {
  const std::uint8_t *cells;
  std::ptrdiff_t rows, cols;

  bool contains(std::ptrdiff_t row, std::ptrdiff_t col) const {
    return row >= 0 && row < rows && col >= 0 && col < cols;
  }
  std::uint8_t at(std::ptrdiff_t row, std::ptrdiff_t col) const { return cells[row * cols + col]; }
};

// One coordinate of a ray: which lines of the grid it crosses, and when.
struct RayAxis {
  double start, along, inverse;
  std::ptrdiff_t step, ahead;

  RayAxis(double from, double direction)
      : start(from),
        along(direction),
        inverse(direction == 0.0 ? 1e300 : 1.0 / direction),
        step(direction < 0.0 ? -1 : 1),
        ahead(direction < 0.0 ? 0 : 1) {}

  // When it leaves a cell that it is in, and when it came into it.
  double leaves(std::ptrdiff_t cell) const { return (static_cast<double>(cell + ahead) - start) * inverse; }
  double enters(std::ptrdiff_t cell) const { return (static_cast<double>(cell + 1 - ahead) - start) * inverse; }

  // The cell at a distance, between two of them. `Ties`: whether a line at just that distance is crossed.
  template <bool Ties>
  std::ptrdiff_t cell_at(double distance, std::ptrdiff_t from, std::ptrdiff_t last) const {
    const double guess = std::floor(start + distance * along);
    const std::ptrdiff_t low = std::min(from, last), high = std::max(from, last);
    std::ptrdiff_t cell = guess <= static_cast<double>(low)    ? low
                          : guess >= static_cast<double>(high) ? high
                                                               : static_cast<std::ptrdiff_t>(guess);
    while (cell != last && (Ties ? leaves(cell) <= distance : leaves(cell) < distance)) cell += step;
    while (cell != from && !(Ties ? enters(cell) <= distance : enters(cell) < distance)) cell -= step;
    return cell;
  }
};

// Distance in cells from (x, y), in cell units, along the unit vector (dx, dy) to the first blocked cell; infinity where
// there is none within `reach`. A ray that starts in a blocked cell reads 0.
inline double cast_jumping_ray(const JumpField &field, double x, double y, double dx, double dy, double reach) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const RayAxis across(x, dx), up(y, dy);
  double distance = 0.0;
  std::ptrdiff_t col, row;
  const double width = static_cast<double>(field.cols), height = static_cast<double>(field.rows);
  if (x >= 0.0 && x < width && y >= 0.0 && y < height) {
    col = static_cast<std::ptrdiff_t>(x);
    row = static_cast<std::ptrdiff_t>(y);
  } else {
    double leave = reach;
    const double starts[2] = {x, y}, ends[2] = {width, height}, along[2] = {dx, dy};
    for (int axis = 0; axis < 2; ++axis) {
      if (along[axis] == 0.0) {
        if (starts[axis] < 0.0 || starts[axis] > ends[axis]) return kInfinity;
        continue;
      }
      const double first = -starts[axis] / along[axis], second = (ends[axis] - starts[axis]) / along[axis];
      distance = std::max(distance, std::min(first, second));
      leave = std::min(leave, std::max(first, second));
    }
    if (distance > leave) return kInfinity;
    // The entry of a ray from far away is rounded, and may lie outside.
    col = static_cast<std::ptrdiff_t>(std::clamp(std::floor(x + distance * dx), 0.0, width - 1.0));
    row = static_cast<std::ptrdiff_t>(std::clamp(std::floor(y + distance * dy), 0.0, height - 1.0));
  }
  while (distance <= reach) {
    const std::ptrdiff_t free = field.at(row, col);
    if (free == 0) return distance;
    const std::ptrdiff_t last_col = col + across.step * (free - 1), last_row = row + up.step * (free - 1);
    const double by_col = across.leaves(last_col), by_row = up.leaves(last_row);
    if (by_col < by_row) {
      row = up.cell_at<true>(by_col, row, last_row);
      col = last_col + across.step;
      distance = by_col;
    } else {
      col = across.cell_at<false>(by_row, col, last_col);
      row = last_row + up.step;
      distance = by_row;
    }
    if (!field.contains(row, col)) return kInfinity;
  }
  return kInfinity;
}

}  // namespace trundle::batch
