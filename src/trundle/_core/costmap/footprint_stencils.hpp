// The cells that a footprint may cover anywhere in a quarter of a cell and at any yaw of a narrow range: where none of
// them is blocked, the footprint is free without an exact test.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "costmap/lazy_bits.hpp"
#include "curves/curves.hpp"

namespace trundle {

class FootprintStencils {
 public:
  // `outline` [m], `corners` points; stencils are kept as long as it and the size of a cell stay what they are.
  void begin(const double *outline, std::size_t corners, double resolution) {
    if (resolution == resolution_ && std::equal(outline, outline + 2 * corners, outline_.begin(), outline_.end())) return;
    outline_.assign(outline, outline + 2 * corners);
    resolution_ = resolution;
    double radius = 0.0;
    for (std::size_t i = 0; i < corners; ++i) {
      radius = std::max(radius, std::hypot(outline[2 * i], outline[2 * i + 1]) / resolution);
    }
    reach_ = 0.25 + radius * kPi / kYaws + 1e-6;
    // A span of 64 cells is all that fits in a word; larger robots are looked at exactly.
    usable_ = 2.0 * (radius + reach_) + 3.0 <= 64.0;
    stencils_.assign(usable_ ? kYaws * kParts * kParts : 0, {});
    spans_.clear();
  }

  // Whether it is certain that the footprint is free at a pose inside the map; (col, row) in cells.
  bool is_free(double col, double row, double yaw, std::int64_t rows, std::int64_t cols, LazyBits &bits) {
    if (!usable_) return false;
    const double left = std::floor(col), bottom = std::floor(row);
    const int part = (row - bottom >= 0.5 ? kParts : 0) + (col - left >= 0.5 ? 1 : 0);
    const auto turns = std::llround(yaw * (kYaws / (2.0 * kPi))) % kYaws;
    Stencil &stencil = stencils_[static_cast<std::size_t>((turns + (turns < 0 ? kYaws : 0)) * kParts * kParts + part)];
    if (stencil.rows == 0) make(stencil, 2.0 * kPi * static_cast<double>(turns) / kYaws, part);
    const std::int64_t first_row = static_cast<std::int64_t>(bottom) + stencil.row;
    const std::int64_t first_col = static_cast<std::int64_t>(left) + stencil.col;
    const std::int64_t last_row = first_row + stencil.rows - 1, last_col = first_col + stencil.cols - 1;
    if (first_row < 0 || first_col < 0 || last_row >= rows || last_col >= cols) return false;
    bits.pack(first_row, last_row, first_col, last_col);
    const Span *span = spans_.data() + stencil.spans;
    for (std::int64_t i = 0; i < stencil.rows; ++i) {
      if (bits.any(first_row + i, first_col + span[i].first, span[i].count)) return false;
    }
    return true;
  }

  std::size_t bytes() const { return stencils_.capacity() * sizeof(Stencil) + spans_.capacity() * sizeof(Span); }

 private:
  static constexpr int kYaws = 144, kParts = 2;

  // Of a row of cells, from the stencil's first column.
  struct Span {
    std::uint8_t first, count;
  };

  // From the cell of the pose.
  struct Stencil {
    std::int8_t row = 0, col = 0, rows = 0, cols = 0;
    std::uint32_t spans = 0;
  };

  void make(Stencil &stencil, double yaw, int part) {
    const double cos = std::cos(yaw) / resolution_, sin = std::sin(yaw) / resolution_;
    const double at_x = part % kParts == 0 ? 0.25 : 0.75, at_y = part < kParts ? 0.25 : 0.75;
    const std::size_t corners = outline_.size() / 2;
    const auto corner = [&](std::size_t i, double &x, double &y) {
      x = at_x + cos * outline_[2 * i] - sin * outline_[2 * i + 1];
      y = at_y + sin * outline_[2 * i] + cos * outline_[2 * i + 1];
    };
    double bottom = std::numeric_limits<double>::infinity(), top = -bottom;
    for (std::size_t i = 0; i < corners; ++i) {
      double x, y;
      corner(i, x, y);
      bottom = std::min(bottom, y), top = std::max(top, y);
    }
    const int first = static_cast<int>(std::floor(bottom - reach_)), last = static_cast<int>(std::floor(top + reach_));
    int left = 127, right = -127;
    std::vector<int> lefts, rights;
    for (int row = first; row <= last; ++row) {
      const double low = row - reach_, high = row + 1 + reach_;
      double least = std::numeric_limits<double>::infinity(), most = -least;
      for (std::size_t i = 0, j = corners - 1; i < corners; j = i++) {
        double ax, ay, bx, by;
        corner(j, ax, ay), corner(i, bx, by);
        if (ay > by) std::swap(ax, bx), std::swap(ay, by);
        if (by < low || ay > high) continue;
        const double slope = by > ay ? (bx - ax) / (by - ay) : 0.0;
        const double x = ay < low ? ax + (low - ay) * slope : ax, other = by > high ? ax + (high - ay) * slope : bx;
        least = std::min({least, x, other}), most = std::max({most, x, other});
      }
      lefts.push_back(static_cast<int>(std::floor(least - reach_)));
      rights.push_back(static_cast<int>(std::floor(most + reach_)));
      left = std::min(left, lefts.back()), right = std::max(right, rights.back());
    }
    stencil = {static_cast<std::int8_t>(first), static_cast<std::int8_t>(left), static_cast<std::int8_t>(last - first + 1),
               static_cast<std::int8_t>(right - left + 1), static_cast<std::uint32_t>(spans_.size())};
    for (std::size_t i = 0; i < lefts.size(); ++i) {
      spans_.push_back({static_cast<std::uint8_t>(lefts[i] - left), static_cast<std::uint8_t>(rights[i] - lefts[i] + 1)});
    }
  }

  std::vector<double> outline_;
  double resolution_ = 0.0, reach_ = 0.0;
  bool usable_ = false;
  std::vector<Stencil> stencils_;
  std::vector<Span> spans_;
};

}  // namespace trundle
