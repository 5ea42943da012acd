// A convex footprint against blocked cells, discs and convex polygons, and rays against discs and polygons.
//
// Contact shallower than a nanometre is none, as in the simulators.
#pragma once

#include "batch/sine.hpp"
#include "rays/jumping_ray.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace trundle::batch {

inline constexpr double kTouch = 1e-9;  // [m]
inline constexpr double kFar = std::numeric_limits<double>::infinity();

// Chebyshev distances in cells to the nearest blocked cell, 0 in it, 255 at most.
using JumpField = CellBytes;

struct Point {
  double x, y;
};

struct Cell {
  std::ptrdiff_t row, col;
};

// From where to where a polygon reaches in each row of cells; memory that a thread keeps.
using Spans = std::vector<Point>;

// The first blocked cell, row by row, that a convex polygon in grid units overlaps; row −1 without one. The part of a
// convex polygon in the strip of a row is convex, so it meets exactly the cells that its extent along x there meets.
inline Cell first_overlap(const JumpField &field, const Point *polygon, std::size_t corners, double touch,
                          Spans &spans) {
  double low = kFar, high = -kFar;
  for (std::size_t i = 0; i < corners; ++i) {
    low = std::min(low, polygon[i].y);
    high = std::max(high, polygon[i].y);
  }
  const double rows = static_cast<double>(field.rows), cols = static_cast<double>(field.cols);
  const auto first_row = static_cast<std::ptrdiff_t>(std::clamp(floor_of(low + touch), 0.0, rows));
  const auto last_row = static_cast<std::ptrdiff_t>(std::clamp(-floor_of(touch - high), 0.0, rows)) - 1;
  if (last_row < first_row) return {-1, -1};
  spans.assign(static_cast<std::size_t>(last_row - first_row + 1), {kFar, -kFar});
  for (std::size_t i = 0, j = corners - 1; i < corners; j = i++) {
    Point a = polygon[j], b = polygon[i];
    if (a.y > b.y) std::swap(a, b);
    const double slope = b.y > a.y ? (b.x - a.x) / (b.y - a.y) : 0.0;
    const auto first = std::max(first_row, static_cast<std::ptrdiff_t>(floor_of(std::clamp(a.y, -1.0, rows))));
    const auto last = std::min(last_row, static_cast<std::ptrdiff_t>(floor_of(std::clamp(b.y, -1.0, rows))));
    for (std::ptrdiff_t row = first; row <= last; ++row) {
      const double below = static_cast<double>(row), above = below + 1.0;
      const double from = a.y < below ? a.x + (below - a.y) * slope : a.x;
      const double to = b.y > above ? a.x + (above - a.y) * slope : b.x;
      Point &span = spans[static_cast<std::size_t>(row - first_row)];
      span.x = std::min(span.x, std::min(from, to));
      span.y = std::max(span.y, std::max(from, to));
    }
  }
  for (std::ptrdiff_t row = first_row; row <= last_row; ++row) {
    const Point &span = spans[static_cast<std::size_t>(row - first_row)];
    if (!(span.x <= span.y)) continue;
    const auto first = static_cast<std::ptrdiff_t>(std::clamp(floor_of(span.x + touch), 0.0, cols));
    const auto end = static_cast<std::ptrdiff_t>(std::clamp(-floor_of(touch - span.y), 0.0, cols));
    for (std::ptrdiff_t col = first, free; col < end; col += free) {
      free = field.at(row, col);  // so many cells on is the next one that may be blocked
      if (free == 0) return {row, col};
    }
  }
  return {-1, -1};
}

// Whether a point lies in a convex polygon, counter-clockwise.
inline bool contains(const Point *polygon, std::size_t corners, double x, double y) {
  for (std::size_t i = 0, j = corners - 1; i < corners; j = i++) {
    const Point &a = polygon[j], &b = polygon[i];
    if (!((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x) > 0.0)) return false;
  }
  return true;
}

// Whether a disc overlaps a convex polygon.
inline bool overlaps_disc(const Point *polygon, std::size_t corners, double x, double y, double radius) {
  if (contains(polygon, corners, x, y)) return true;
  double nearest = kFar;
  for (std::size_t i = 0, j = corners - 1; i < corners; j = i++) {
    const Point &a = polygon[j], &b = polygon[i];
    const double ex = b.x - a.x, ey = b.y - a.y;
    const double share = std::clamp(((x - a.x) * ex + (y - a.y) * ey) / (ex * ex + ey * ey), 0.0, 1.0);
    const double dx = a.x + share * ex - x, dy = a.y + share * ey - y;
    nearest = std::min(nearest, dx * dx + dy * dy);
  }
  return radius - std::sqrt(nearest) > kTouch;
}

// Whether no edge of the first of two convex polygons, counter-clockwise, separates them.
inline bool is_joined(const Point *one, std::size_t corners, const Point *other, std::size_t others) {
  for (std::size_t i = 0, j = corners - 1; i < corners; j = i++) {
    const double ex = one[i].x - one[j].x, ey = one[i].y - one[j].y;
    double nearest = kFar;
    for (std::size_t k = 0; k < others; ++k) {
      nearest = std::min(nearest, ey * (other[k].x - one[j].x) - ex * (other[k].y - one[j].y));
    }
    if (-nearest <= kTouch * std::sqrt(ex * ex + ey * ey)) return false;
  }
  return true;
}

// Distance from (x, y) along the unit vector (dx, dy) to the rim of a disc, from inside too; infinity if it is missed.
inline double ray_to_disc(double x, double y, double dx, double dy, double cx, double cy, double radius) {
  const double ox = cx - x, oy = cy - y;
  const double side = dx * oy - dy * ox;
  const double root = radius * radius - side * side;
  if (root < 0.0) return kFar;
  const double middle = dx * ox + dy * oy, half = std::sqrt(root);
  if (middle - half >= 0.0) return middle - half;
  return middle + half >= 0.0 ? middle + half : kFar;
}

// The same to the outline of a polygon.
inline double ray_to_polygon(double x, double y, double dx, double dy, const Point *polygon, std::size_t corners) {
  double nearest = kFar;
  for (std::size_t i = 0, j = corners - 1; i < corners; j = i++) {
    const double ax = polygon[j].x - x, ay = polygon[j].y - y;
    const double ex = polygon[i].x - polygon[j].x, ey = polygon[i].y - polygon[j].y;
    const double across = dx * ey - dy * ex;
    if (across == 0.0) continue;
    const double distance = (ax * ey - ay * ex) / across, share = (ax * dy - ay * dx) / across;
    if (distance >= 0.0 && share >= 0.0 && share <= 1.0) nearest = std::min(nearest, distance);
  }
  return nearest;
}

}  // namespace trundle::batch
