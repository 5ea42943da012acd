// A ray that jumps through a grid: a Chebyshev distance d of a cell says that the square of 2 d - 1 cells around it is
// free, so the ray goes on where it leaves that square. Sphere tracing (Hart 1996) with squares on cells.
//
// It meets the same cell as `walk_ray`, and the same distance to the last bit once that is summed up as the walk does:
// from one line to the next. Where a jump ends so near to a corner of cells that the walk's rounded sums may choose the
// other cell, the ray is `unsure`, and has to be walked.
#pragma once

#include "rays/cell_walk.hpp"

namespace trundle {

struct Landing {
  enum Kind : std::uint8_t { kNothing, kHit, kUnsure } kind = kNothing;
  double first = 0.0, spacing = 0.0;  // of the lines that the ray crosses, ...
  std::ptrdiff_t more = 0;            // ... and how many spacings behind the first one lies the hit

  // The distance of the hit, rounded as a walk rounds it.
  double distance() const {
    double sum = first;
    for (std::ptrdiff_t i = 0; i < more; ++i) sum += spacing;
    return sum;
  }
};

// How far the sums of a walk through a grid may be off [cells]: each of at most `most` of them by half a unit in the last
// place, the spacing likewise, and the same for the numbers here; four times that.
inline double rounding_of_walk(const CellBytes &field, double reach) {
  const double size = static_cast<double>(field.rows + field.cols), most = std::min(reach, size) + 4.0;
  return 1e-15 * (most * most + size);
}

// Where the ray from (x, y) along the unit vector (dx, dy) ends in a field of Chebyshev distances, 0 for blocked cells.
inline Landing land_ray(const CellBytes &field, double x, double y, double dx, double dy, double reach, double rounding) {
  Landing landing;
  if (!(x > 0.0 && y > 0.0 && x < static_cast<double>(field.cols) && y < static_cast<double>(field.rows))) {
    landing.kind = Landing::kUnsure;
    return landing;
  }
  const std::ptrdiff_t start_col = static_cast<std::ptrdiff_t>(x), start_row = static_cast<std::ptrdiff_t>(y);
  const double per_dx = 1.0 / dx, per_dy = 1.0 / dy;  // infinite where the ray never crosses a line
  std::ptrdiff_t col = start_col, row = start_row;
  std::ptrdiff_t free = field.cells[row * field.cols + col];
  if (free == 0) {
    landing.kind = Landing::kHit;
    return landing;
  }
  while (true) {
    const double at_col = dx != 0.0 ? (static_cast<double>(dx > 0.0 ? col + free : col - free + 1) - x) * per_dx : kNoHit;
    const double at_row = dy != 0.0 ? (static_cast<double>(dy > 0.0 ? row + free : row - free + 1) - y) * per_dy : kNoHit;
    const bool by_col = at_col < at_row;
    const double distance = by_col ? at_col : at_row;
    if (distance > reach + rounding) return landing;
    const double beside = by_col ? y + distance * dy : x + distance * dx;
    const double floor = std::floor(beside);
    if (!(beside - floor > rounding && beside - floor < 1.0 - rounding)) {
      landing.kind = Landing::kUnsure;
      return landing;
    }
    col = by_col ? (dx > 0.0 ? col + free : col - free) : static_cast<std::ptrdiff_t>(floor);
    row = by_col ? static_cast<std::ptrdiff_t>(floor) : (dy > 0.0 ? row + free : row - free);
    if (col < 0 || col >= field.cols || row < 0 || row >= field.rows) return landing;
    free = field.cells[row * field.cols + col];
    if (free == 0) {
      const Crossings lines = by_col ? Crossings(x, start_col, dx) : Crossings(y, start_row, dy);
      landing.kind = Landing::kHit;
      landing.first = lines.first, landing.spacing = lines.spacing;
      landing.more = (by_col ? std::abs(col - start_col) : std::abs(row - start_row)) - 1;
      return landing;
    }
  }
}

}  // namespace trundle
