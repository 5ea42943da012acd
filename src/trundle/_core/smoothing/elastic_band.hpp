// An elastic band: a course beside a path's own that costs less and bends less.
//
// Points at even distances h along a part of the path without stops descend ∫ (w + b κ²) ds, with the cells' weight w;
// its ends and its directions there stay. Kass, Witkin and Terzopoulos, "Snakes: active contour models" (1988): the
// inner forces are implicit, taken at the next step, so that a step solves one system of five diagonals. The tension is
// w, so that it balances the slope of w across the band exactly where the line integral is least (Caselles, Kimmel and
// Sapiro, "Geodesic active contours", 1997).
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "smoothing/pieces.hpp"

namespace trundle::smoothing {

struct BandPoint {
  double x, y;
};

// The cells' weights as a smooth field: bilinear between the centres of four cells, with its slope from a cell to each
// side.
class Slope {
 public:
  Slope(const footprint::Costs &costs, const PoseChecker &checker, double cost_weight, double resolution)
      : costs_(costs),
        checker_(checker),
        scale_(cost_weight / 252.0),
        resolution_(resolution),
        per_metre_(1.0 / resolution) {}

  struct Value {
    double weight, dx, dy;
  };

  Value at(double x, double y) const {
    const double across = x * per_metre_ - 0.5, up = y * per_metre_ - 0.5;
    const double left = std::floor(across), bottom = std::floor(up), u = across - left, v = up - bottom;
    const bool inside = left >= 1.0 && bottom >= 1.0 && left < static_cast<double>(costs_.cols - 2) &&
                        bottom < static_cast<double>(costs_.rows - 2);
    if (!inside) {
      return mix(u, v, [&](int row, int col) {
        return checker_.cost_at((left + 0.5 + col) * resolution_, (bottom + 0.5 + row) * resolution_);
      });
    }
    const std::uint8_t *cell =
        costs_.data + static_cast<std::ptrdiff_t>(bottom) * costs_.cols + static_cast<std::ptrdiff_t>(left);
    return mix(u, v, [&](int row, int col) { return cell[row * costs_.cols + col]; });
  }

 private:
  // `cost(row, col)` counts from the cell whose centre lies shares u and v of a cell to the left and below.
  template <typename Cost>
  Value mix(double u, double v, Cost &&cost) const {
    const auto of = [&](int row, int col) { return static_cast<double>(std::min<int>(cost(row, col), 254)); };
    const auto between = [](double a, double b, double share) { return a + share * (b - a); };
    const double a = of(0, 0), b = of(0, 1), c = of(1, 0), d = of(1, 1);
    const double left = between(between(of(0, -1), of(1, -1), v), between(a, c, v), u);
    const double right = between(between(b, d, v), between(of(0, 2), of(1, 2), v), u);
    const double below = between(between(of(-1, 0), of(-1, 1), u), between(a, b, u), v);
    const double above = between(between(c, d, u), between(of(2, 0), of(2, 1), u), v);
    const double half = 0.5 * scale_ * per_metre_;
    return {1.0 + 0.25 * scale_ * (left + right + below + above), half * (right - left), half * (above - below)};
  }

  const footprint::Costs costs_;
  const PoseChecker &checker_;
  double scale_, resolution_, per_metre_;
};

class Band {
 public:
  // Takes points a distance `h` apart; the first two and the last two stay.
  Band(std::vector<BandPoint> points, double h, double curve_weight, const Slope &slope, const PoseChecker &checker)
      : points_(std::move(points)),
        rows_(points_.size() - 4),
        tension_(1.0 / (h * h)),
        stiffness_(2.0 * curve_weight * tension_ * tension_),
        slope_(slope),
        checker_(checker) {}

  const std::vector<BandPoint> &relax(int steps) {
    for (int i = 0; i < steps && step() > kStill; ++i) {
    }
    return points_;
  }

 private:
  static constexpr double kStill = 1e-3, kFarthest = 0.1;  // a step [m]
  static constexpr double kHeld = 0.3, kHeldBySlope = 4.0;  // what holds a point at its place, alone and by the slope

  // A row of the factors L D Lᵀ: its entries for the next row and the one after; and the moves of its point.
  struct Row {
    double once, twice, x, y;
  };

  // Solves (held + tension + bending) move = pull for the inner points. Returns how far a point moved at most.
  double step() {
    Row last{}, second_last{};  // with the right side in place of the moves
    double under_last = 0.0;    // the last row's factor before it was divided by the diagonal
    Slope::Value here = slope_.at(points_[2].x, points_[2].y);
    double behind = 0.5 * tension_ * (slope_.at(points_[1].x, points_[1].y).weight + here.weight);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const Slope::Value next = slope_.at(points_[i + 3].x, points_[i + 3].y);
      const double ahead = 0.5 * tension_ * (here.weight + next.weight);
      const double held = kHeld + kHeldBySlope * std::sqrt(here.dx * here.dx + here.dy * here.dy);
      const double diagonal = behind + ahead + 6.0 * stiffness_ + held - under_last * last.once - stiffness_ * second_last.twice;
      const double under = -ahead - 4.0 * stiffness_ - stiffness_ * last.once;
      const BandPoint pull = pull_at(i + 2, behind, ahead, here);
      const Row row{under / diagonal, stiffness_ / diagonal, pull.x - last.once * last.x - second_last.twice * second_last.x,
                    pull.y - last.once * last.y - second_last.twice * second_last.y};
      rows_[i] = {row.once, row.twice, row.x / diagonal, row.y / diagonal};
      second_last = last, last = row, under_last = under, behind = ahead, here = next;
    }
    return move();
  }

  BandPoint pull_at(std::size_t k, double behind, double ahead, const Slope::Value &slope) const {
    const BandPoint *p = &points_[k];
    const double along_x = p[1].x - p[-1].x, along_y = p[1].y - p[-1].y;
    const double across = (along_x * slope.dy - along_y * slope.dx) / std::max(along_x * along_x + along_y * along_y, 1e-24);
    const auto of = [&](double BandPoint::*c) {
      return ahead * (p[1].*c - p[0].*c) - behind * (p[0].*c - p[-1].*c) -
             stiffness_ * (p[-2].*c + p[2].*c - 4.0 * (p[-1].*c + p[1].*c) + 6.0 * p[0].*c);
    };
    return {of(&BandPoint::x) + across * along_y, of(&BandPoint::y) - across * along_x};
  }

  double move() {
    double x[2] = {}, y[2] = {}, most = 0.0;  // of the next row and the one after
    for (std::size_t i = rows_.size(); i-- > 0;) {
      Row &row = rows_[i];
      row.x -= row.once * x[0] + row.twice * x[1], row.y -= row.once * y[0] + row.twice * y[1];
      x[1] = x[0], x[0] = row.x, y[1] = y[0], y[0] = row.y;
      most = std::max(most, row.x * row.x + row.y * row.y);
    }
    most = std::sqrt(most);
    const double share = most > kFarthest ? kFarthest / most : 1.0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      BandPoint &point = points_[i + 2];
      const BandPoint next{point.x + share * rows_[i].x, point.y + share * rows_[i].y};
      if (checker_.cost_at(next.x, next.y) < PoseChecker::kInscribed) point = next;
    }
    return share * most;
  }

  std::vector<BandPoint> points_;
  std::vector<Row> rows_;
  const double tension_;  // over the weight
  const double stiffness_;
  const Slope &slope_;
  const PoseChecker &checker_;
};

// The poses at which the bands of a path pass its stations; none where a band does not move it.
inline std::vector<std::optional<PlanarPose>> band_poses(const std::vector<Piece> &pieces,
                                                         const std::vector<Station> &stations, double spacing,
                                                         double curve_weight, const Slope &slope,
                                                         const PoseChecker &checker) {
  constexpr double kMoved = 1e-3;  // [m, rad]; less is not worth a curve
  constexpr int kSteps = 12;
  std::vector<std::optional<PlanarPose>> band_pose(stations.size());
  for (std::size_t first = 0, last = 1; last < stations.size(); first = last++) {
    while (!stations[last].fixed) ++last;
    double length = 0.0;
    for (std::size_t i = stations[first].piece; i < stations[last].piece; ++i) {
      length += std::fabs(pieces[i].segment.length);
    }
    const int parts = static_cast<int>(std::lround(length / spacing));
    if (last - first < 2 || parts < 6) continue;
    const double h = length / parts;
    std::vector<BandPoint> points;
    double done = 0.0;  // length of the pieces before
    for (std::size_t i = stations[first].piece; i < stations[last].piece; ++i) {
      const double along = std::fabs(pieces[i].segment.length);
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
    const double reversed = pieces[stations[first].piece].direction() < 0 ? kPi : 0.0;
    double along = 0.0;
    for (std::size_t k = first + 1; k < last; ++k) {
      for (std::size_t i = stations[k - 1].piece; i < stations[k].piece; ++i) {
        along += std::fabs(pieces[i].segment.length);
      }
      const double at = std::clamp(along / h, 1.0, static_cast<double>(parts) - 2.0);
      const auto index = static_cast<std::size_t>(at);
      const double share = at - static_cast<double>(index);
      const auto mix = [&](auto &&value) { return (1.0 - share) * value(index) + share * value(index + 1); };
      const double dx = mix([&](std::size_t i) { return moved[i + 1].x - moved[i - 1].x; });
      const double dy = mix([&](std::size_t i) { return moved[i + 1].y - moved[i - 1].y; });
      const PlanarPose pose{mix([&](std::size_t i) { return moved[i].x; }),
                            mix([&](std::size_t i) { return moved[i].y; }), std::atan2(dy, dx) + reversed};
      const PlanarPose &now = stations[k].pose;
      if (std::hypot(pose.x - now.x, pose.y - now.y) > kMoved ||
          std::fabs(std::remainder(pose.yaw - now.yaw, 2.0 * kPi)) > kMoved) {
        band_pose[k] = pose;
      }
    }
  }
  return band_pose;
}

}  // namespace trundle::smoothing
