// A convex footprint at a pose against the blocked cells of a costmap, exactly.
//
// Everything is in grid units: cell (row, col) is the square [col, col + 1] × [row, row + 1].
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

namespace trundle::footprint {

inline constexpr std::uint8_t kLethal = 254;
inline constexpr double kTouch = 1e-9;  // metres; contact shallower than this is none
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Point {
  double x, y;
};

struct Costs {
  const std::uint8_t *data;
  std::ptrdiff_t rows, cols;
  bool blocked(std::ptrdiff_t r, std::ptrdiff_t c) const { return data[r * cols + c] >= kLethal; }
};

// Where the grid lies in the map frame.
struct Frame {
  double x, y, yaw, cos, sin, resolution;
};

struct Box {
  double min_x, min_y, max_x, max_y;
};

// The outline at a pose of the map frame, in grid units.
inline void transform_outline(const Frame &frame, const double *outline, std::size_t corners, const double *pose,
                  std::vector<Point> &out) {
  const double dx = pose[0] - frame.x, dy = pose[1] - frame.y;
  const double px = frame.cos * dx + frame.sin * dy, py = frame.cos * dy - frame.sin * dx;
  const double cos = std::cos(pose[2] - frame.yaw), sin = std::sin(pose[2] - frame.yaw);
  out.resize(corners);
  for (std::size_t i = 0; i < corners; ++i) {
    const double x = outline[2 * i], y = outline[2 * i + 1];
    out[i] = {(px + cos * x - sin * y) / frame.resolution, (py + sin * x + cos * y) / frame.resolution};
  }
}

inline Box bounds(const std::vector<Point> &polygon) {
  Box box{kInfinity, kInfinity, -kInfinity, -kInfinity};
  for (const Point &p : polygon) {
    box.min_x = std::min(box.min_x, p.x);
    box.max_x = std::max(box.max_x, p.x);
    box.min_y = std::min(box.min_y, p.y);
    box.max_y = std::max(box.max_y, p.y);
  }
  return box;
}

// Corners that are not numbers make an empty box, which is not inside.
inline bool is_inside(const Costs &costs, const Box &box, double touch) {
  return box.min_x <= box.max_x && box.min_y <= box.max_y && box.min_x >= -touch &&
         box.min_y >= -touch && box.max_x <= static_cast<double>(costs.cols) + touch &&
         box.max_y <= static_cast<double>(costs.rows) + touch;
}

// From where to where a polygon reaches in each row of cells.
struct Spans {
  std::vector<double> left, right;

  void clear(std::size_t rows) {
    left.assign(rows, kInfinity);
    right.assign(rows, -kInfinity);
  }

  void add(std::ptrdiff_t row, double x, double other) {
    left[row] = std::min(left[row], std::min(x, other));
    right[row] = std::max(right[row], std::max(x, other));
  }
};

// The part of a convex polygon in the strip of one row of cells is convex, so it meets exactly the cells that its
// x extent there meets.
inline bool touches_cells(const Costs &costs, const std::vector<Point> &polygon, const Box &box, double touch,
                          Spans &spans) {
  const auto first_row = std::max<std::ptrdiff_t>(0, static_cast<std::ptrdiff_t>(std::floor(box.min_y + touch)));
  const auto last_row =
      std::min<std::ptrdiff_t>(costs.rows, static_cast<std::ptrdiff_t>(std::ceil(box.max_y - touch))) - 1;
  if (last_row < first_row) return false;
  spans.clear(static_cast<std::size_t>(last_row - first_row + 1));
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    Point a = polygon[j], b = polygon[i];
    if (a.y > b.y) std::swap(a, b);
    const double slope = b.y > a.y ? (b.x - a.x) / (b.y - a.y) : 0.0;
    const auto first = std::max(first_row, static_cast<std::ptrdiff_t>(std::floor(a.y)));
    const auto last = std::min(last_row, static_cast<std::ptrdiff_t>(std::floor(b.y)));
    for (std::ptrdiff_t row = first; row <= last; ++row) {
      const double low = static_cast<double>(row), high = low + 1.0;
      spans.add(row - first_row, a.y < low ? a.x + (low - a.y) * slope : a.x,
                b.y > high ? a.x + (high - a.y) * slope : b.x);
    }
  }
  for (std::ptrdiff_t row = first_row; row <= last_row; ++row) {
    const double left = spans.left[row - first_row], right = spans.right[row - first_row];
    const auto first = std::max<std::ptrdiff_t>(0, static_cast<std::ptrdiff_t>(std::floor(left + touch)));
    const auto last = std::min<std::ptrdiff_t>(costs.cols, static_cast<std::ptrdiff_t>(std::ceil(right - touch))) - 1;
    const std::uint8_t *cells = costs.data + row * costs.cols;
    std::uint8_t highest = 0;
    for (std::ptrdiff_t col = first; col <= last; ++col) highest = std::max(highest, cells[col]);
    if (highest >= kLethal) return true;
  }
  return false;
}

// The first blocked column from `col` up to `last` of a row, or more than `last`; it looks at eight cells at a time.
inline std::ptrdiff_t next_blocked(const std::uint8_t *cells, std::ptrdiff_t col, std::ptrdiff_t last) {
  constexpr std::uint64_t kOnes = 0x0101010101010101, kTops = 0x8080808080808080;
  for (; col + 7 <= last; col += 8) {
    std::uint64_t eight;
    std::memcpy(&eight, cells + col, 8);
    // 254 and 255 are the bytes that are all ones but for the last bit; those turn to 0 here.
    const std::uint64_t zeros = ~eight & ~kOnes;
    if (((zeros - kOnes) & ~zeros & kTops) != 0) break;
  }
  while (col <= last && cells[col] < kLethal) ++col;
  return col;
}

// Whether the footprint at a pose touches something; it is placed in `polygon` and `box` for that.
inline bool collides(const Costs &costs, const Frame &frame, const double *outline, std::size_t corners,
                     const double *pose, std::vector<Point> &polygon, Box &box, Spans &spans) {
  if (!(std::isfinite(pose[0]) && std::isfinite(pose[1]) && std::isfinite(pose[2]))) return true;
  transform_outline(frame, outline, corners, pose, polygon);
  box = bounds(polygon);
  const double touch = kTouch / frame.resolution;
  return !is_inside(costs, box, touch) || touches_cells(costs, polygon, box, touch, spans);
}

}  // namespace trundle::footprint
