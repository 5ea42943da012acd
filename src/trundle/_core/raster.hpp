// Conservative rasters of convex polygons: a cell is marked when a polygon reaches into it by more than `depth` in x and
// in y.
//
// For each row of cells the polygon is clipped to the row's strip; what is left is convex, so it touches exactly the
// columns between its smallest and largest x. This is exact: no cell is missed and none is added. All lengths in here
// are in cells, so that no row needs a division.
#pragma once

#include "arrays.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace trundle {

using Cells = nb::ndarray<std::int8_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

constexpr std::int8_t kOccupied = 100;
// What has no thickness counts where it touches: a negative depth of this many metres.
constexpr double kTouch = -1e-9;

struct Point2 {
  double x, y;
};

struct Point3 {
  double x, y, z;
};

// Where the line from a to b is at a height between theirs.
inline Point2 cut(const Point3 &a, const Point3 &b, double height) {
  const double share = (height - a.z) / (b.z - a.z);
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
}

// Which rows (or columns) of a grid count as reached; `depth` in cells.
struct Reach {
  double depth;
  bool centre;

  double from_low() const { return depth + (centre ? 0.5 : 0.0); }
  double strip_low() const { return centre ? 0.5 : depth; }
  double strip_high() const { return centre ? 0.5 : 1.0 - depth; }
  // First index that [low, high] reaches into and one past the last, both in [0, limit]; NaN gives an empty range.
  std::int64_t first(double low, std::int64_t limit) const { return whole(low + from_low(), limit); }
  std::int64_t end(double high, std::int64_t limit) const { return whole(std::ceil(high - from_low()), limit); }

 private:
  static std::int64_t whole(double value, std::int64_t limit) {
    if (!(value > 0.0)) return 0;
    return value > static_cast<double>(limit) ? limit : static_cast<std::int64_t>(value);
  }
};

// Marks spans of a grid whose cell (0, 0) has its lower-left corner at (0, 0).
class Raster {
 public:
  Raster(Cells &cells, double resolution, double depth, bool centre)
      : cells_(cells.data()), rows_(static_cast<std::int64_t>(cells.shape(0))),
        cols_(static_cast<std::int64_t>(cells.shape(1))), solid_{depth / resolution, centre},
        surface_{kTouch / resolution, false} {
    if (!(resolution > 0.0 && 2.0 * depth < resolution))
      throw std::invalid_argument("a raster needs a resolution above twice the depth");
  }

  std::int64_t rows() const { return rows_; }
  std::int64_t cols() const { return cols_; }
  const Reach &solid() const { return solid_; }
  const Reach &surface() const { return surface_; }
  std::int8_t &cell(std::int64_t row, std::int64_t col) { return cells_[row * cols_ + col]; }

  // Whether any of the grid, or of one cell around it, lies in a box.
  bool near(Point2 low, Point2 high) const {
    return low.x < static_cast<double>(cols_) + 1.0 && high.x > -1.0 && low.y < static_cast<double>(rows_) + 1.0 && high.y > -1.0;
  }

  // The corners of a convex polygon in order; one point or a segment will do. Returns false where a row that it reaches
  // into, or all of it, got no cell: it lies between two cells there.
  bool add_polygon(const Point2 *corners, std::size_t count, const Reach &reach) {
    bool whole = trace(corners, count, reach) || outside_;
    for (std::int64_t row = first_; row < end_; ++row) whole &= mark(row, left(row), right(row), reach);
    return whole;
  }

  // A convex polygon that is solid. Thinner than twice the depth it has no thickness, and counts where it touches.
  void add_solid(const Point2 *corners, std::size_t count) {
    add_polygon(corners, count, !solid_.centre && is_thin(corners, count) ? surface_ : solid_);
  }

  void add_disc(Point2 middle, double radius) {
    const Reach &reach = solid_.centre || radius > solid_.depth ? solid_ : surface_;
    const double margin = reach.centre ? reach.depth : 0.0;
    const std::int64_t end = reach.end(middle.y + radius, rows_);
    for (std::int64_t row = reach.first(middle.y - radius, rows_); row < end; ++row) {
      const double low = static_cast<double>(row) + reach.strip_low(), high = static_cast<double>(row) + reach.strip_high();
      const double off = std::max({low - middle.y, middle.y - high, 0.0});
      if (!(off < radius - margin)) continue;
      const double half = std::sqrt((radius - margin - off) * (radius - margin + off)) + margin;
      mark(row, middle.x - half, middle.x + half, reach);
    }
  }

  // Find the smallest and largest x of a convex polygon in each row that it reaches into; false where there is none.
  bool trace(const Point2 *corners, std::size_t count, const Reach &reach) {
    outside_ = true;
    if (count == 0) return false;
    Point2 low = corners[0], high = corners[0];
    double area = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const Point2 &a = corners[i], &b = corners[i + 1 == count ? 0 : i + 1];
      low = {std::min(low.x, a.x), std::min(low.y, a.y)};
      high = {std::max(high.x, a.x), std::max(high.y, a.y)};
      area += (a.x - corners[0].x) * (b.y - corners[0].y) - (b.x - corners[0].x) * (a.y - corners[0].y);
    }
    outside_ = !near(low, high);
    first_ = reach.first(low.y, rows_);
    end_ = outside_ ? first_ : reach.end(high.y, rows_);
    if (first_ >= end_) return false;
    const auto spanned = static_cast<std::size_t>(end_ - first_);
    if (left_.size() < spanned) {
      left_.resize(spanned);
      right_.resize(spanned);
    }
    std::fill_n(left_.begin(), spanned, std::numeric_limits<double>::infinity());
    std::fill_n(right_.begin(), spanned, -std::numeric_limits<double>::infinity());
    // Counter-clockwise, edges that rise are the right side. Seen from the edge, both sides are both.
    const double size = (high.x - low.x) + (high.y - low.y);
    const bool flat = std::abs(area) < 1e-9 * size * size;
    for (std::size_t i = 0; i < count; ++i) {
      const Point2 &a = corners[i], &b = corners[i + 1 == count ? 0 : i + 1];
      const bool rises = b.y >= a.y;
      const bool on_right = rises == (area > 0.0);
      add_edge(rises ? a : b, rises ? b : a, reach, flat || !on_right, flat || on_right);
    }
    return true;
  }

  std::int64_t first_row() const { return first_; }
  std::int64_t end_row() const { return end_; }
  double left(std::int64_t row) const { return left_[static_cast<std::size_t>(row - first_)]; }
  double right(std::int64_t row) const { return right_[static_cast<std::size_t>(row - first_)]; }

 private:
  bool is_thin(const Point2 *corners, std::size_t count) const {
    double area = 0.0, around = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const Point2 &a = corners[i], &b = corners[i + 1 == count ? 0 : i + 1];
      area += (a.x - corners[0].x) * (b.y - corners[0].y) - (b.x - corners[0].x) * (a.y - corners[0].y);
      around += std::abs(b.x - a.x) + std::abs(b.y - a.y);
    }
    // A convex shape of width w and diameter d has an area of at most w d and is longer around than 2 d.
    if (0.5 * std::abs(area) > solid_.depth * around) return false;
    for (std::size_t i = 0; i < count; ++i) {
      const Point2 &a = corners[i], &b = corners[i + 1 == count ? 0 : i + 1];
      const double along_x = b.x - a.x, along_y = b.y - a.y, length = std::hypot(along_x, along_y);
      double width = 0.0;
      for (std::size_t j = 0; j < count; ++j)
        width = std::max(width, std::abs(along_x * (corners[j].y - a.y) - along_y * (corners[j].x - a.x)));
      if (width <= 2.0 * solid_.depth * length) return true;
    }
    return false;
  }

  // An edge with a.y <= b.y, on the left side, the right side or both.
  void add_edge(const Point2 &a, const Point2 &b, const Reach &reach, bool on_left, bool on_right) {
    const double rise = b.y - a.y;
    const double strip_low = reach.strip_low(), strip_high = reach.strip_high();
    const auto clipped = [&](double value, std::int64_t low, std::int64_t high) {
      return value <= static_cast<double>(low) ? low : value >= static_cast<double>(high) ? high : static_cast<std::int64_t>(value);
    };
    // Rows whose strip the edge meets, one more on each side so that rounding loses none; the clipping decides.
    const std::int64_t from = clipped(std::floor(a.y) - 1.0, first_, end_), to = clipped(std::floor(b.y) + 2.0, first_, end_);
    // Of these, the rows whose strip it crosses from below to above.
    const std::int64_t inner = clipped(std::ceil(a.y - strip_low), from, to);
    const std::int64_t inner_end = std::max(inner, clipped(std::floor(b.y - strip_high) + 1.0, from, to));
    // A rise this small, in cells, is level: its slope would overflow.
    const bool level = rise < 1e-11;
    const double slope = level ? 0.0 : (b.x - a.x) / rise;
    const auto clip = [&](std::int64_t row) {
      const double low = std::max(a.y, static_cast<double>(row) + strip_low);
      const double high = std::min(b.y, static_cast<double>(row) + strip_high);
      if (low > high) return;
      const double x_low = a.x + (low - a.y) * slope, x_high = level ? b.x : a.x + (high - a.y) * slope;
      double &left = left_[static_cast<std::size_t>(row - first_)], &right = right_[static_cast<std::size_t>(row - first_)];
      // The ends of a side are corners of the other one too.
      left = std::min({left, x_low, x_high});
      right = std::max({right, x_low, x_high});
    };
    for (std::int64_t row = from; row < inner; ++row) clip(row);
    if (inner < inner_end) {
      const double start = a.x + (static_cast<double>(inner) + strip_low - a.y) * slope;
      const double across = slope * (strip_high - strip_low);
      const auto rows = static_cast<std::int32_t>(inner_end - inner);
      if (on_left) take_least(left_.data() + (inner - first_), rows, start + std::min(0.0, across), slope);
      if (on_right) take_most(right_.data() + (inner - first_), rows, start + std::max(0.0, across), slope);
    }
    for (std::int64_t row = inner_end; row < to; ++row) clip(row);
  }

  static void take_least(double *values, std::int32_t count, double start, double step) {
    for (std::int32_t i = 0; i < count; ++i) {
      const double x = start + static_cast<double>(i) * step;
      values[i] = x < values[i] ? x : values[i];
    }
  }
  static void take_most(double *values, std::int32_t count, double start, double step) {
    for (std::int32_t i = 0; i < count; ++i) {
      const double x = start + static_cast<double>(i) * step;
      values[i] = x > values[i] ? x : values[i];
    }
  }

  // Mark a span of a row; false where it lies between two cells.
  bool mark(std::int64_t row, double left, double right, const Reach &reach) {
    if (!(left <= right)) return true;
    const std::int64_t first = reach.first(left, cols_), end = reach.end(right, cols_);
    if (first >= end) return false;
    fill(cells_ + row * cols_ + first, static_cast<std::size_t>(end - first));
    return true;
  }

  // Most spans are a few cells: too short for a call.
  static void fill(std::int8_t *at, std::size_t count) {
    constexpr std::uint64_t kEight = 0x0101010101010101ULL * static_cast<std::uint64_t>(kOccupied);
    if (count > 64) {
      std::memset(at, kOccupied, count);
    } else if (count >= 8) {
      for (std::size_t i = 0; i + 8 < count; i += 8) std::memcpy(at + i, &kEight, 8);
      std::memcpy(at + count - 8, &kEight, 8);
    } else if (count >= 4) {
      std::memcpy(at, &kEight, 4);
      std::memcpy(at + count - 4, &kEight, 4);
    } else {
      for (std::size_t i = 0; i < count; ++i) at[i] = kOccupied;
    }
  }

  std::int8_t *cells_;
  std::int64_t rows_, cols_;
  Reach solid_, surface_;
  std::int64_t first_ = 0, end_ = 0;
  bool outside_ = false;  // Whether the last polygon lies off the grid.
  std::vector<double> left_, right_;
};

}  // namespace trundle
