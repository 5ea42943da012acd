// A course beside a path's own that is cheaper and bends less: an elastic band.
//
// Points at even distances h on a stretch that is driven in one go, its ends and its directions there held fast, go down
// the slope of ∫ (w + b κ²) ds with the cells' weight w: Kass, Witkin and Terzopoulos, "Snakes: active contour models"
// (1988), whose inner forces are taken from the next step, which makes one system with five diagonals of it. The inner
// tension is w, so that it and the slope of w across the band balance exactly where the line integral has its least
// (Caselles, Kimmel and Sapiro, "Geodesic active contours", 1997).
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "smoothing_pieces.hpp"

namespace trundle::smoothing {

struct BandPoint {
  double x, y;
};

// The cells' weights as a smooth field.
class Slope {
 public:
  Slope(const PoseChecker &checker, double cost_weight, double resolution)
      : checker_(checker), scale_(cost_weight / 252.0), resolution_(resolution) {}

  struct Value {
    double weight, dx, dy;
  };

  Value at(double x, double y) const {
    const double left = cost(x - resolution_, y), right = cost(x + resolution_, y);
    const double below = cost(x, y - resolution_), above = cost(x, y + resolution_);
    const double half = 0.5 * scale_ / resolution_;
    return {1.0 + 0.25 * scale_ * (left + right + below + above), half * (right - left), half * (above - below)};
  }

 private:
  // Between the centres of four cells.
  double cost(double x, double y) const {
    const double col = x / resolution_ - 0.5, row = y / resolution_ - 0.5;
    const double left = std::floor(col), bottom = std::floor(row), u = col - left, v = row - bottom;
    const auto of = [&](int right, int up) {
      return static_cast<double>(
          std::min<int>(checker_.cost_at((left + 0.5 + right) * resolution_, (bottom + 0.5 + up) * resolution_), 254));
    };
    return (1.0 - v) * ((1.0 - u) * of(0, 0) + u * of(1, 0)) + v * ((1.0 - u) * of(0, 1) + u * of(1, 1));
  }

  const PoseChecker &checker_;
  double scale_, resolution_;
};

class Band {
 public:
  // Takes points a distance `h` apart; the first two and the last two stay.
  Band(std::vector<BandPoint> points, double h, double curve_weight, const Slope &slope, const PoseChecker &checker)
      : points_(std::move(points)), h_(h), stiffness_(2.0 * curve_weight / (h * h * h * h)), slope_(slope), checker_(checker) {}

  const std::vector<BandPoint> &relax(int steps) {
    for (int i = 0; i < steps && step() > kStill; ++i) {
    }
    return points_;
  }

 private:
  static constexpr double kStill = 1e-3, kFarthest = 0.1;  // a step [m]
  static constexpr double kHeld = 0.3, kHeldBySlope = 4.0;  // what holds a point where it is, alone and by the slope

  // Gives how far a point moved at most.
  double step() {
    const std::size_t count = points_.size(), inner = count - 4;
    diagonal_.assign(inner, 0.0), first_.assign(inner, 0.0), second_.assign(inner, 0.0);
    force_.assign(inner, {0.0, 0.0});
    values_.resize(count);
    for (std::size_t k = 0; k < count; ++k) values_[k] = slope_.at(points_[k].x, points_[k].y);
    for (std::size_t k = 1; k + 2 < count; ++k) add_tension(k, 0.5 * (values_[k].weight + values_[k + 1].weight) / (h_ * h_));
    for (std::size_t k = 1; k + 1 < count; ++k) add_bending(k);
    for (std::size_t i = 0; i < inner; ++i) add_slope(i);
    solve();
    double most = 0.0;
    for (const BandPoint &move : force_) most = std::max(most, std::hypot(move.x, move.y));
    const double share = most > kFarthest ? kFarthest / most : 1.0;
    for (std::size_t i = 0; i < inner; ++i) {
      const BandPoint next{points_[i + 2].x + share * force_[i].x, points_[i + 2].y + share * force_[i].y};
      if (checker_.cost_at(next.x, next.y) < PoseChecker::kInscribed) points_[i + 2] = next;
    }
    return share * most;
  }

  // The system is for the moves of the inner points: (held + tension + bending) move = -(what pulls now).
  void add(std::size_t row, std::size_t col, double value) {
    if (row < 2 || col < 2 || row + 2 >= points_.size() || col + 2 >= points_.size() || col < row) return;
    (col == row ? diagonal_ : col == row + 1 ? first_ : second_)[row - 2] += value;
  }
  void pull(std::size_t k, double x, double y) {
    if (k < 2 || k + 2 >= points_.size()) return;
    force_[k - 2].x += x, force_[k - 2].y += y;
  }

  void add_tension(std::size_t k, double tension) {
    const double x = tension * (points_[k + 1].x - points_[k].x), y = tension * (points_[k + 1].y - points_[k].y);
    pull(k, x, y), pull(k + 1, -x, -y);
    add(k, k, tension), add(k + 1, k + 1, tension), add(k, k + 1, -tension);
  }

  void add_bending(std::size_t k) {
    const BandPoint &a = points_[k - 1], &b = points_[k], &c = points_[k + 1];
    const double x = stiffness_ * (a.x - 2.0 * b.x + c.x), y = stiffness_ * (a.y - 2.0 * b.y + c.y);
    pull(k - 1, -x, -y), pull(k, 2.0 * x, 2.0 * y), pull(k + 1, -x, -y);
    add(k - 1, k - 1, stiffness_), add(k, k, 4.0 * stiffness_), add(k + 1, k + 1, stiffness_);
    add(k - 1, k, -2.0 * stiffness_), add(k, k + 1, -2.0 * stiffness_), add(k - 1, k + 1, stiffness_);
  }

  void add_slope(std::size_t i) {
    const Slope::Value &value = values_[i + 2];
    const BandPoint &before = points_[i + 1], &after = points_[i + 3];
    const double along_x = after.x - before.x, along_y = after.y - before.y;
    const double length = std::max(std::hypot(along_x, along_y), 1e-12);
    const double across = (along_x * value.dy - along_y * value.dx) / (length * length);
    pull(i + 2, across * along_y, -across * along_x);
    diagonal_[i] += kHeld + kHeldBySlope * std::hypot(value.dx, value.dy);
  }

  // L D Lᵀ of the five diagonals; the moves replace the forces.
  void solve() {
    const std::size_t n = force_.size();
    for (std::size_t i = 0; i < n; ++i) {
      const double once = first_[i] / diagonal_[i], twice = second_[i] / diagonal_[i];
      if (i + 1 < n) {
        diagonal_[i + 1] -= once * first_[i];
        first_[i + 1] -= once * second_[i];
        force_[i + 1].x -= once * force_[i].x, force_[i + 1].y -= once * force_[i].y;
      }
      if (i + 2 < n) {
        diagonal_[i + 2] -= twice * second_[i];
        force_[i + 2].x -= twice * force_[i].x, force_[i + 2].y -= twice * force_[i].y;
      }
    }
    for (std::size_t i = n; i-- > 0;) {
      double x = force_[i].x, y = force_[i].y;
      if (i + 1 < n) x -= first_[i] * force_[i + 1].x, y -= first_[i] * force_[i + 1].y;
      if (i + 2 < n) x -= second_[i] * force_[i + 2].x, y -= second_[i] * force_[i + 2].y;
      force_[i] = {x / diagonal_[i], y / diagonal_[i]};
    }
  }

  std::vector<BandPoint> points_;
  const double h_, stiffness_;
  const Slope &slope_;
  const PoseChecker &checker_;
  std::vector<double> diagonal_, first_, second_;
  std::vector<BandPoint> force_;
  std::vector<Slope::Value> values_;
};

// Where the bands of a path lead past those of its stations that they may move; the others have none.
inline std::vector<std::optional<PlanarPose>> lay_beside(const std::vector<Piece> &pieces,
                                                         const std::vector<Station> &stations, double spacing,
                                                         double curve_weight, const Slope &slope,
                                                         const PoseChecker &checker) {
  constexpr double kMoved = 1e-3;  // [m, rad]; less is not worth another course
  constexpr int kSteps = 40;
  std::vector<std::optional<PlanarPose>> beside(stations.size());
  for (std::size_t first = 0, last = 1; last < stations.size(); first = last++) {
    while (!stations[last].fixed) ++last;
    double length = 0.0;
    for (std::size_t i = stations[first].piece; i < stations[last].piece; ++i) {
      length += std::fabs(pieces[i].stretch.length);
    }
    const int parts = static_cast<int>(std::lround(length / spacing));
    if (last - first < 2 || parts < 6) continue;
    const double h = length / parts;
    std::vector<BandPoint> points;
    double done = 0.0;  // length of the pieces before
    for (std::size_t i = stations[first].piece; i < stations[last].piece; ++i) {
      const double along = std::fabs(pieces[i].stretch.length);
      while (static_cast<int>(points.size()) < parts && h * static_cast<double>(points.size()) < done + along) {
        const PlanarPose pose = pieces[i].at((h * static_cast<double>(points.size()) - done) / along);
        points.push_back({pose.x, pose.y});
      }
      done += along;
    }
    const PlanarPose &end = stations[last].pose;
    while (static_cast<int>(points.size()) <= parts) points.push_back({end.x, end.y});
    Band band(std::move(points), h, curve_weight, slope, checker);
    const std::vector<BandPoint> &moved = band.relax(kSteps);
    const double turned = pieces[stations[first].piece].direction() < 0 ? kPi : 0.0;
    double along = 0.0;
    for (std::size_t k = first + 1; k < last; ++k) {
      for (std::size_t i = stations[k - 1].piece; i < stations[k].piece; ++i) {
        along += std::fabs(pieces[i].stretch.length);
      }
      const double at = std::clamp(along / h, 1.0, static_cast<double>(parts) - 2.0);
      const auto index = static_cast<std::size_t>(at);
      const double share = at - static_cast<double>(index);
      const auto mix = [&](auto &&value) { return (1.0 - share) * value(index) + share * value(index + 1); };
      const double dx = mix([&](std::size_t i) { return moved[i + 1].x - moved[i - 1].x; });
      const double dy = mix([&](std::size_t i) { return moved[i + 1].y - moved[i - 1].y; });
      const PlanarPose pose{mix([&](std::size_t i) { return moved[i].x; }),
                            mix([&](std::size_t i) { return moved[i].y; }), std::atan2(dy, dx) + turned};
      const PlanarPose &now = stations[k].pose;
      if (std::hypot(pose.x - now.x, pose.y - now.y) > kMoved ||
          std::fabs(std::remainder(pose.yaw - now.yaw, 2.0 * kPi)) > kMoved) {
        beside[k] = pose;
      }
    }
  }
  return beside;
}

}  // namespace trundle::smoothing
