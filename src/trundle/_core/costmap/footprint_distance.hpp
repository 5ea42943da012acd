// The distance from a convex footprint to the blocked cells of a costmap.
//
// Everything is in grid units: cell (row, col) is the square [col, col + 1] × [row, row + 1].
#pragma once

#include "costmap/oriented_footprint.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace trundle::footprint {

inline double square(double value) { return value * value; }

// Squared distance from a point to a segment.
inline double to_segment(double x, double y, const Point &a, const Point &b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double t = std::clamp(((x - a.x) * dx + (y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return square(a.x + t * dx - x) + square(a.y + t * dy - y);
}

// Squared distance between a convex polygon and a cell that do not overlap: it is taken at a corner of one of them.
inline double to_cell(const std::vector<Point> &polygon, double col, double row) {
  double best = kInfinity;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Point &p = polygon[i];
    const double dx = std::max({col - p.x, p.x - (col + 1.0), 0.0});
    const double dy = std::max({row - p.y, p.y - (row + 1.0), 0.0});
    best = std::min(best, dx * dx + dy * dy);
    for (int corner = 0; corner < 4; ++corner) {
      best = std::min(best, to_segment(col + (corner & 1), row + (corner >> 1), polygon[j], p));
    }
  }
  return best;
}

// Distance to the nearest blocked cell or to the map's edge, at most `cap`, of a polygon that touches nothing.
inline double nearest(const Costs &costs, const std::vector<Point> &polygon, const Box &box, double cap) {
  double best = std::min({cap, box.min_x, box.min_y, static_cast<double>(costs.cols) - box.max_x,
                          static_cast<double>(costs.rows) - box.max_y});
  best = std::max(best, 0.0);
  double searched = 0.0;
  for (double window = std::min(best, 4.0); searched < best; window = std::min(best, 2.0 * window)) {
    const auto first_row = static_cast<std::ptrdiff_t>(std::floor(std::max(0.0, box.min_y - window)));
    const auto first_col = static_cast<std::ptrdiff_t>(std::floor(std::max(0.0, box.min_x - window)));
    const auto last_row = std::min(costs.rows, static_cast<std::ptrdiff_t>(std::ceil(box.max_y + window))) - 1;
    const auto last_col = std::min(costs.cols, static_cast<std::ptrdiff_t>(std::ceil(box.max_x + window))) - 1;
    double best_squared = best * best;
    for (std::ptrdiff_t r = first_row; r <= last_row; ++r) {
      const double dy = std::max({static_cast<double>(r) - box.max_y, box.min_y - static_cast<double>(r + 1), 0.0});
      if (dy * dy >= best_squared) continue;
      const std::uint8_t *cells = costs.data + r * costs.cols;
      for (auto c = next_blocked(cells, first_col, last_col); c <= last_col; c = next_blocked(cells, c + 1, last_col)) {
        const double dx = std::max({static_cast<double>(c) - box.max_x, box.min_x - static_cast<double>(c + 1), 0.0});
        if (dx * dx + dy * dy >= best_squared) continue;
        // A cell with blocked cells on all four sides is behind one of them.
        if (r > 0 && r + 1 < costs.rows && c > 0 && c + 1 < costs.cols && costs.blocked(r - 1, c) &&
            costs.blocked(r + 1, c) && costs.blocked(r, c - 1) && costs.blocked(r, c + 1)) {
          continue;
        }
        best_squared = std::min(best_squared, to_cell(polygon, static_cast<double>(c), static_cast<double>(r)));
      }
    }
    best = std::min(best, std::sqrt(best_squared));
    searched = window;
  }
  return best;
}

}  // namespace trundle::footprint
