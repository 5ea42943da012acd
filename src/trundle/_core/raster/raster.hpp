// Conservative rasters of convex polygons: a cell is marked when a polygon reaches into it by more than `depth` in x
// and in y.
//
// For each row of cells the polygon is clipped to the row's strip; what is left is convex, so it touches exactly the
// columns between its smallest and largest x. This is exact: no cell is missed and none is added. All lengths in here
// are in cells, so that no row needs a division.
#pragma once

#include "shared/arrays.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace trundle {

constexpr std::int8_t kOccupied = 100;
constexpr std::int64_t kTile = 8;       // Edge of a tile [cells].
constexpr std::int64_t kManyLarge = 1000;  // After as many large polygons others are expected to lie over them.
// A surface without thickness marks the cells that it touches: a negative depth, of this many metres.
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

// Which rows (or columns) of a grid count as reached; `depth` in cells, `slack` by how much the polygon may be too
// small.
struct Reach {
  double depth;
  bool centre;
  double slack = 0.0;

  double from_low() const { return depth - slack + (centre ? 0.5 : 0.0); }
  double strip_low() const { return (centre ? 0.5 : depth) - slack; }
  double strip_high() const { return (centre ? 0.5 : 1.0 - depth) + slack; }
  // First index that [low, high] reaches into and one past the last, both in [0, limit]; NaN gives an empty range.
  std::int64_t first(double low, std::int64_t limit) const { return whole(low + from_low(), limit); }
  std::int64_t end(double high, std::int64_t limit) const { return whole(std::ceil(high - from_low()), limit); }

 private:
  static std::int64_t whole(double value, std::int64_t limit) {  // Without branches: the two selections are min and max.
    const double least = value > 0.0 ? value : 0.0, most = static_cast<double>(limit);
    return static_cast<std::int64_t>(least < most ? least : most);
  }
};

struct Box2 {
  Point2 low, high;

  static Box2 around(const Point2 *corners, std::size_t count) {
    Box2 box{corners[0], corners[0]};
    for (std::size_t i = 1; i < count; ++i) {
      box.low = {std::min(box.low.x, corners[i].x), std::min(box.low.y, corners[i].y)};
      box.high = {std::max(box.high.x, corners[i].x), std::max(box.high.y, corners[i].y)};
    }
    return box;
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
    if (cols_ > std::numeric_limits<std::int32_t>::max()) throw std::invalid_argument("a raster has fewer than 2^31 columns");
    tile_cols_ = (cols_ + kTile - 1) / kTile;
  }

  std::int64_t rows() const { return rows_; }
  std::int64_t cols() const { return cols_; }
  const Reach &solid() const { return solid_; }
  const Reach &surface() const { return surface_; }
  std::int8_t &cell(std::int64_t row, std::int64_t col) { return cells_[row * cols_ + col]; }

  // Whether any of the grid, or of one cell around it, lies in a box.
  bool near(const Box2 &box) const {
    return box.low.x < static_cast<double>(cols_) + 1.0 && box.high.x > -1.0 &&
           box.low.y < static_cast<double>(rows_) + 1.0 && box.high.y > -1.0;
  }

  // The corners of a convex polygon in order; one point or a segment will do. Returns false where a row that it reaches
  // into, or all of it, got no cell: it lies between two cells there.
  bool add_polygon(const Point2 *corners, std::size_t count, const Reach &reach) {
    if (count == 0) return true;
    const Box2 box = Box2::around(corners, count);
    if (!near(box)) return true;
    const Point2 &low = box.low, &high = box.high;
    const std::int64_t first = reach.first(low.y, rows_), end = reach.end(high.y, rows_);
    if (first >= end) return false;
    const std::int64_t first_col = reach.first(low.x, cols_), end_col = reach.end(high.x, cols_);
    if (first_col >= end_col) return false;
    // Inside one row or one column there is nothing to clip.
    if (end - first == 1 && low.y >= static_cast<double>(first) + reach.strip_low() && high.y <= static_cast<double>(first) + reach.strip_high())
      return mark(first, low.x, high.x, reach);
    if (end_col - first_col == 1 && low.x >= static_cast<double>(first_col) + reach.strip_low() && high.x <= static_cast<double>(first_col) + reach.strip_high()) {
      for (std::int64_t row = first; row < end; ++row) cells_[row * cols_ + first_col] = kOccupied;
      return true;
    }
    if (is_full(first, end, first_col, end_col)) return true;
    trace(corners, count, box, reach);
    return mark_rows(reach);
  }

  // Whether all cells of a rectangle are known to be occupied: by the cells where they are few, by tiles where they are many,
  // once there were many such rectangles. Cells only ever become occupied, so each tile remembers how far it was found
  // full, and looking is soon for nothing.
  bool is_full(std::int64_t row, std::int64_t end_row, std::int64_t col, std::int64_t end_col) {
    if (end_col - col <= kTile && end_row - row <= kTile) {
      for (; row < end_row; ++row)
        for (std::int64_t c = col; c < end_col; ++c)
          if (cells_[row * cols_ + c] != kOccupied) return false;
      return true;
    }
    if (++large_ < kManyLarge) return false;
    if (seen_.empty()) seen_.assign(static_cast<std::size_t>((rows_ + kTile - 1) / kTile * tile_cols_), 0);
    for (std::int64_t tile_row = row / kTile; tile_row <= (end_row - 1) / kTile; ++tile_row)
      for (std::int64_t tile_col = col / kTile; tile_col <= (end_col - 1) / kTile; ++tile_col) {
        std::uint8_t &seen = seen_[static_cast<std::size_t>(tile_row * tile_cols_ + tile_col)];
        for (; seen < kTile * kTile; ++seen) {
          const std::int64_t r = tile_row * kTile + seen / kTile, c = tile_col * kTile + seen % kTile;
          if (r < rows_ && c < cols_ && cells_[r * cols_ + c] != kOccupied) return false;
        }
      }
    return true;
  }

  bool is_row_full(std::int64_t row, std::int64_t col, std::int64_t end_col) const {
    const std::int8_t *at = cells_ + row * cols_;
    while (col < end_col) {  // Many cells at once, without branches on each.
      std::int8_t other = 0;
      for (const std::int64_t stop = std::min(col + 64, end_col); col < stop; ++col) other |= at[col] ^ kOccupied;
      if (other) return false;
    }
    return true;
  }

  // A convex polygon that is solid. Thinner than twice the depth it has no thickness, and counts where it touches.
  void add_solid(const Point2 *corners, std::size_t count) {
    add_polygon(corners, count, !solid_.centre && is_thin(corners, count) ? surface_ : solid_);
  }

  // Mark a solid of which the polygon is the inner outline, the true one lying within `slack` cells around it, unless
  // it depends on the slack which cells that are; false, and nothing marked, where it does.
  bool add_if_sure(const Point2 *corners, std::size_t count, double slack) {
    const Box2 box = Box2::around(corners, count);
    Reach most = solid_;
    most.slack = slack;
    if (!near(box) || !trace(corners, count, box, most)) return true;
    if (!solid_.centre && is_thin(corners, count)) return false;
    find_columns(most);
    const auto rows = static_cast<std::size_t>(end_ - first_);
    const std::int64_t first = first_;
    most_columns_.assign(columns_.begin(), columns_.begin() + static_cast<std::ptrdiff_t>(2 * rows));
    if (!trace(corners, count, box, solid_) || first_ != first || static_cast<std::size_t>(end_ - first_) != rows) return false;
    find_columns(solid_);
    if (!std::equal(most_columns_.begin(), most_columns_.end(), columns_.begin())) return false;
    mark_columns();
    return true;
  }

  // Mark a solid as `add_if_sure` does, its slack counted as solid.
  void add_with_slack(const Point2 *corners, std::size_t count, double slack) {
    Reach reach = !solid_.centre && is_thin(corners, count) ? surface_ : solid_;
    reach.slack = slack;
    add_polygon(corners, count, reach);
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
  bool trace(const Point2 *corners, std::size_t count, const Box2 &box, const Reach &reach) {
    double area = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const Point2 &a = corners[i], &b = corners[i + 1 == count ? 0 : i + 1];
      area += (a.x - corners[0].x) * (b.y - corners[0].y) - (b.x - corners[0].x) * (a.y - corners[0].y);
    }
    first_ = reach.first(box.low.y, rows_);
    end_ = reach.end(box.high.y, rows_);
    if (first_ >= end_ || !near(box)) return false;
    const auto spanned = static_cast<std::size_t>(end_ - first_);
    if (left_.size() < spanned) {
      left_.resize(spanned);
      right_.resize(spanned);
    }
    std::fill_n(left_.begin(), spanned, std::numeric_limits<double>::infinity());
    std::fill_n(right_.begin(), spanned, -std::numeric_limits<double>::infinity());
    // Counter-clockwise, edges that rise are the right side. Seen from the edge, both sides are both.
    const double size = (box.high.x - box.low.x) + (box.high.y - box.low.y);
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
    const auto clipped = [](double value, std::int64_t low, std::int64_t high) {
      const double least = static_cast<double>(low), most = static_cast<double>(high);
      const double above = value > least ? value : least;
      return static_cast<std::int64_t>(above < most ? above : most);
    };
    // Rows whose strip the edge meets; the clipping decides where rounding would.
    const std::int64_t from = clipped(std::ceil(a.y - strip_high), first_, end_);
    const std::int64_t to = clipped(std::floor(b.y - strip_low) + 1.0, from, end_);
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

  // Mark the rows of the polygon that was traced.
  bool mark_rows(const Reach &reach) {
    find_columns(reach);
    return mark_columns();
  }

  // First and end column of each row of the polygon that was traced.
  void find_columns(const Reach &reach) {
    const auto count = static_cast<std::size_t>(end_ - first_);
    if (columns_.size() < 2 * count) columns_.resize(2 * count);
    // All columns first: without branches, the compiler does several rows at once.
    std::int32_t *columns = columns_.data();
    const double from_low = reach.from_low(), most = static_cast<double>(cols_);
    for (std::size_t i = 0; i < count; ++i) {
      const double low = left_[i] + from_low, high = std::ceil(right_[i] - from_low);
      const double first = low > 0.0 ? low : 0.0, end = high > 0.0 ? high : 0.0;
      columns[i] = static_cast<std::int32_t>(first < most ? first : most);
      columns[count + i] = static_cast<std::int32_t>(end < most ? end : most);
    }
  }

  bool mark_columns() {
    const auto count = static_cast<std::size_t>(end_ - first_);
    const std::int32_t *columns = columns_.data();
    bool whole = true;
    std::int8_t *row = cells_ + first_ * cols_;
    for (std::size_t i = 0; i < count; ++i, row += cols_) {
      const std::int32_t first = columns[i], end = columns[count + i];
      if (first < end) fill(row + first, static_cast<std::size_t>(end - first));
      else whole &= !(left_[i] <= right_[i]);
    }
    return whole;
  }

  // Most spans are a few cells: too short for a call, and for branches on their length.
  void fill(std::int8_t *at, std::size_t count) {
    constexpr std::uint64_t kEight = 0x0101010101010101ULL * static_cast<std::uint64_t>(kOccupied);
    if (count <= 16 && at + 16 <= cells_ + rows_ * cols_) {
      // The table gives a mask whose first `count` bytes are set, in the order of the memory.
      static constexpr std::uint8_t kOnes[32] = {255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255};
      std::uint64_t words[2], mask[2];
      std::memcpy(mask, kOnes + 16 - count, 16);
      std::memcpy(words, at, 16);
      words[0] = (words[0] & ~mask[0]) | (kEight & mask[0]);
      words[1] = (words[1] & ~mask[1]) | (kEight & mask[1]);
      std::memcpy(at, words, 16);
    } else {
      std::memset(at, kOccupied, count);
    }
  }

  std::int8_t *cells_;
  std::int64_t rows_, cols_;
  Reach solid_, surface_;
  std::int64_t first_ = 0, end_ = 0;
  std::int64_t tile_cols_ = 0;
  std::int64_t large_ = 0;
  std::vector<std::uint8_t> seen_;
  std::vector<double> left_, right_;
  std::vector<std::int32_t> columns_, most_columns_;
};

}  // namespace trundle
