// What a convex footprint sweeps over between two poses, against the blocked cells of a costmap.
//
// Between two poses the position and the yaw change evenly, so that a corner at distance r from the pose leaves the
// straight line between its two positions by r · turn² / 8 at most. The convex hull of the footprint at both poses,
// each widened by that, holds all that is swept: where no blocked cell is in it, the motion is free. Otherwise each
// half of the motion is tested separately. For a straight line the hull is exactly what is swept.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "costmap/oriented_footprint.hpp"
#include "shared/hull.hpp"

namespace trundle::footprint {

class Sweep {
 public:
  // `outline` [m], `corners` points, counter-clockwise; the cells and the outline must outlive its use.
  void begin(const Costs &costs, const Frame &frame, const double *outline, std::size_t corners) {
    costs_ = costs, frame_ = frame, outline_ = outline, corners_ = corners;
    radius_ = 0.0;
    for (std::size_t i = 0; i < corners; ++i) {
      radius_ = std::max(radius_, std::hypot(outline[2 * i], outline[2 * i + 1]));
    }
    shift_.resize(2 * corners);
    for (std::size_t i = 0; i < corners; ++i) {
      double before[2], after[2];
      normal_of((i + corners - 1) % corners, before);
      normal_of(i, after);
      const double scale = 1.0 / (1.0 + before[0] * after[0] + before[1] * after[1]);
      shift_[2 * i] = (before[0] + after[0]) * scale, shift_[2 * i + 1] = (before[1] + after[1]) * scale;
    }
  }

  // Share of the motion that is free: infinity where all of it is. It is at most what the fastest corner moves in
  // `kFinest` too little. `widened` [m] is kept free around the footprint.
  double free_share(const double *first, const double *last, double widened = 0.0) {
    for (int i = 0; i < 3; ++i) {
      if (!(std::fabs(first[i]) < kFarthest && std::fabs(last[i]) < kFarthest)) return 0.0;
      first_[i] = first[i], change_[i] = last[i] - first[i];
    }
    length_ = std::hypot(change_[0], change_[1]);
    turn_ = std::fabs(change_[2]);
    widened_ = widened;
    if (turn_ > kMostTurn) return 0.0;
    if (turn_ > 0.0 && length_ <= radius_ && is_circle_free()) return kInfinity;
    return search(0.0, 1.0);
  }

 private:
  static constexpr double kFinest = 1e-5;      // [m]; a hit is not refined further
  static constexpr double kWidestTurn = 0.25;  // [rad]; of larger turns the hull is too wide to be of use
  static constexpr double kFarthest = 1e9;     // [m, rad]; no map reaches so far
  static constexpr double kMostTurn = 100.0;   // [rad] of one motion

  // The normal of the edge from a corner to the next.
  void normal_of(std::size_t i, double *normal) const {
    const std::size_t j = (i + 1) % corners_;
    const double dx = outline_[2 * j] - outline_[2 * i], dy = outline_[2 * j + 1] - outline_[2 * i + 1];
    const double length = std::hypot(dx, dy);
    normal[0] = dy / length, normal[1] = -dx / length;
  }

  double search(double from, double to) {
    const double share = to - from, turn = turn_ * share;
    if (turn <= kWidestTurn && is_free(from, to, turn)) return kInfinity;
    const double middle = 0.5 * (from + to);
    if ((length_ + radius_ * turn_) * share <= kFinest || !(from < middle && middle < to)) return from;
    const double touch = search(from, middle);
    return touch < kInfinity ? touch : search(middle, to);
  }

  bool is_free(double from, double to, double turn) {
    const double wider = widened_ + radius_ * turn * turn / 8.0;
    points_.clear();
    add(from, wider);
    add(to, wider);
    for (const Point &p : points_) {
      if (!(std::isfinite(p.x) && std::isfinite(p.y))) return false;
    }
    convex_hull(points_, hull_);
    const double touch = kTouch / frame_.resolution;
    const Box box = bounds(hull_);
    return is_inside(costs_, box, touch) && !touches_cells(costs_, hull_, box, touch, spans_);
  }

  // The corners at a share of the motion.
  void add(double share, double wider) {
    const double dx = first_[0] + share * change_[0] - frame_.x, dy = first_[1] + share * change_[1] - frame_.y;
    const double px = frame_.cos * dx + frame_.sin * dy, py = frame_.cos * dy - frame_.sin * dx;
    const double yaw = first_[2] + share * change_[2] - frame_.yaw, cos = std::cos(yaw), sin = std::sin(yaw);
    for (std::size_t i = 0; i < corners_; ++i) {
      const double x = outline_[2 * i] + wider * shift_[2 * i], y = outline_[2 * i + 1] + wider * shift_[2 * i + 1];
      points_.push_back({(px + cos * x - sin * y) / frame_.resolution, (py + sin * x + cos * y) / frame_.resolution});
    }
  }

  // Whether the square around the circumscribed circle is free, as it mostly is.
  bool is_circle_free() const {
    const double dx = first_[0] + 0.5 * change_[0] - frame_.x, dy = first_[1] + 0.5 * change_[1] - frame_.y;
    const double col = (frame_.cos * dx + frame_.sin * dy) / frame_.resolution;
    const double row = (frame_.cos * dy - frame_.sin * dx) / frame_.resolution;
    const double reach = (radius_ + 2.0 * widened_ + 0.5 * length_) / frame_.resolution;
    if (!is_inside(costs_, {col - reach, row - reach, col + reach, row + reach}, 0.0)) return false;
    const auto first_col = static_cast<std::ptrdiff_t>(col - reach), first_row = static_cast<std::ptrdiff_t>(row - reach);
    const auto last_col = std::min(costs_.cols - 1, static_cast<std::ptrdiff_t>(col + reach));
    const auto last_row = std::min(costs_.rows - 1, static_cast<std::ptrdiff_t>(row + reach));
    for (std::ptrdiff_t r = first_row; r <= last_row; ++r) {
      if (next_blocked(costs_.data + r * costs_.cols, first_col, last_col) <= last_col) return false;
    }
    return true;
  }

  Costs costs_{};
  Frame frame_{};
  const double *outline_ = nullptr;
  std::size_t corners_ = 0;
  double radius_ = 0.0, length_ = 0.0, turn_ = 0.0, widened_ = 0.0;
  double first_[3] = {}, change_[3] = {};
  std::vector<double> shift_;  // of each corner, where all edges move outwards by 1
  std::vector<Point> points_, hull_;
  Spans spans_;
};

}  // namespace trundle::footprint
