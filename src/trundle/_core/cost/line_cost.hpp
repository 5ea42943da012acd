// The cost of a straight line over a grid whose cells have a weight each.
//
// Points are (x, y) in grid units: cell (row, col) is the square [col, col + 1] × [row, row + 1]. A line costs ∫ weight
// ds, clipped exactly at the cells' borders. A line along a border takes the higher weight of the two cells; one
// through the corner of four cells needs all of them free.
#pragma once

#include "shared/arrays.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace trundle::lines {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kOnBorder = 1e-9;

struct Point {
  double x, y;
};

struct WeightedGrid {
  const std::uint8_t *costs;
  const double *weights;  // by cost, 256 entries, 0 where a cell is blocked
  std::int64_t rows, cols;

  // 0 where the cell is blocked or outside.
  double weight(std::int64_t row, std::int64_t col) const {
    if (row < 0 || row >= rows || col < 0 || col >= cols) return 0.0;
    return weights[costs[row * cols + col]];
  }
};

inline double distance(const Point &a, const Point &b) {
  return std::sqrt((b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y));
}

// A line parallel to an axis on the border of two rows (or columns) of cells.
inline bool runs_on_border(double a, double b) {
  return std::abs(a - b) < kOnBorder && std::abs(a - std::round(a)) < kOnBorder;
}

inline double along_border(const WeightedGrid &grid, const Point &a, const Point &b, bool horizontal) {
  const auto line = static_cast<std::int64_t>(std::llround(horizontal ? a.y : a.x));
  const double from = horizontal ? std::min(a.x, b.x) : std::min(a.y, b.y);
  const double to = horizontal ? std::max(a.x, b.x) : std::max(a.y, b.y);
  double total = 0.0;
  for (auto k = static_cast<std::int64_t>(std::floor(from)); static_cast<double>(k) < to; ++k) {
    const double first = horizontal ? grid.weight(line - 1, k) : grid.weight(k, line - 1);
    const double second = horizontal ? grid.weight(line, k) : grid.weight(k, line);
    if (first == 0.0 || second == 0.0) return kInfinity;
    const double length = std::min(to, static_cast<double>(k + 1)) - std::max(from, static_cast<double>(k));
    total += length * std::max(first, second);
  }
  return total;
}

// Cost of the line from a to b; infinity where it is blocked, or as soon as it must come to more than `limit` (with
// `cheapest` as the smallest weight).
inline double line_cost(const WeightedGrid &grid, const Point &a, const Point &b, double limit, double cheapest) {
  if (runs_on_border(a.y, b.y)) return along_border(grid, a, b, true);
  if (runs_on_border(a.x, b.x)) return along_border(grid, a, b, false);
  const double dx = b.x - a.x, dy = b.y - a.y, length = std::sqrt(dx * dx + dy * dy);
  const std::int64_t step_col = dx > 0 ? 1 : -1, step_row = dy > 0 ? 1 : -1;
  // A point on a border belongs to the cell that the line goes into.
  auto first_cell = [](double value, std::int64_t step) {
    const double nearest = std::round(value);
    if (std::abs(value - nearest) < kOnBorder) return static_cast<std::int64_t>(nearest) - (step > 0 ? 0 : 1);
    return static_cast<std::int64_t>(std::floor(value));
  };
  std::int64_t col = first_cell(a.x, step_col), row = first_cell(a.y, step_row);
  const double per_col = dx != 0.0 ? std::abs(1.0 / dx) : 0.0;
  const double per_row = dy != 0.0 ? std::abs(1.0 / dy) : 0.0;
  const double start_col = dx != 0.0 ? (static_cast<double>(col + (step_col > 0 ? 1 : 0)) - a.x) / dx : kInfinity;
  const double start_row = dy != 0.0 ? (static_cast<double>(row + (step_row > 0 ? 1 : 0)) - a.y) / dy : kInfinity;
  const double near = kOnBorder / std::max(length, kOnBorder);
  std::int64_t cols_done = 0, rows_done = 0;
  double at = 0.0, total = 0.0;
  while (true) {
    const double weight = grid.weight(row, col);
    if (weight == 0.0) return kInfinity;
    const double next_col = start_col + static_cast<double>(cols_done) * per_col;
    const double next_row = start_row + static_cast<double>(rows_done) * per_row;
    const double next = std::min(next_col, next_row);
    if (next >= 1.0 - near) return total + (1.0 - at) * length * weight;
    total += (next - at) * length * weight;
    at = next;
    if (total + (1.0 - at) * length * cheapest > limit) return kInfinity;
    if (std::abs(next_col - next_row) <= near) {
      if (grid.weight(row + step_row, col) == 0.0 || grid.weight(row, col + step_col) == 0.0) return kInfinity;
      col += step_col;
      row += step_row;
      ++cols_done;
      ++rows_done;
    } else if (next_col < next_row) {
      col += step_col;
      ++cols_done;
    } else {
      row += step_row;
      ++rows_done;
    }
  }
}

inline double cheapest_weight(const double *weights) {
  double cheapest = kInfinity;
  for (int cost = 0; cost < 256; ++cost) {
    if (weights[cost] > 0.0) cheapest = std::min(cheapest, weights[cost]);
  }
  return cheapest;
}

inline std::vector<Point> read_points(const In<double, 2> &array) {
  if (array.shape(1) != 2) throw nb::value_error("points need shape (N, 2)");
  std::vector<Point> points(array.shape(0));
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = {array.data()[2 * i], array.data()[2 * i + 1]};
    if (!(std::abs(points[i].x) < 1e9 && std::abs(points[i].y) < 1e9)) throw nb::value_error("points must be finite");
  }
  return points;
}

inline WeightedGrid make_grid(const In<std::uint8_t, 2> &costs, const In<double, 1> &weights) {
  if (weights.size() != 256) throw nb::value_error("the weights need one entry for each of the 256 costs");
  return {costs.data(), weights.data(), static_cast<std::int64_t>(costs.shape(0)),
          static_cast<std::int64_t>(costs.shape(1))};
}

}  // namespace trundle::lines
