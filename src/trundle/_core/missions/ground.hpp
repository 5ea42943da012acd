// The costmap that a mission is driven on: costs, what an outline touches, and at a glance that nothing is near.
#pragma once

#include "costmap/footprint_distance.hpp"
#include "costmap/footprint_sweep.hpp"
#include "missions/plane.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace trundle::missions {

// A convex outline [m] in base_link, counter-clockwise: two numbers a corner.
class Outline {
 public:
  Outline() = default;
  explicit Outline(std::vector<double> corners) : corners_(std::move(corners)) {
    for (std::size_t i = 0; i < count(); ++i) {
      radius_ = std::max(radius_, std::hypot(corners_[2 * i], corners_[2 * i + 1]));
    }
    cover();
  }

  const double *data() const { return corners_.data(); }
  std::size_t count() const { return corners_.size() / 2; }
  double radius() const { return radius_; }
  // Discs of one radius that have all of the outline in them.
  const std::vector<Place> &discs() const { return discs_; }
  double disc_radius() const { return disc_radius_; }

  // Every edge moved outwards, as by `pad_outline`.
  Outline padded(double padding) const {
    const std::size_t n = count();
    std::vector<double> normals(2 * n), moved(2 * n);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t j = (i + 1) % n;
      const double ex = corners_[2 * j] - corners_[2 * i], ey = corners_[2 * j + 1] - corners_[2 * i + 1];
      const double edge = std::hypot(ex, ey);
      normals[2 * i] = ey / edge, normals[2 * i + 1] = -ex / edge;
    }
    for (std::size_t i = 0; i < n; ++i) {
      const double *before = normals.data() + 2 * ((i + n - 1) % n), *normal = normals.data() + 2 * i;
      const double scale = 1.0 + (before[0] * normal[0] + before[1] * normal[1]);
      moved[2 * i] = corners_[2 * i] + padding * ((before[0] + normal[0]) / scale);
      moved[2 * i + 1] = corners_[2 * i + 1] + padding * ((before[1] + normal[1]) / scale);
    }
    return Outline(std::move(moved));
  }

 private:
  void cover() {
    constexpr int kDiscs = 4;
    double left = footprint::kInfinity, right = -left, low = left, high = -left;
    for (std::size_t i = 0; i < count(); ++i) {
      left = std::min(left, corners_[2 * i]), right = std::max(right, corners_[2 * i]);
      low = std::min(low, corners_[2 * i + 1]), high = std::max(high, corners_[2 * i + 1]);
    }
    const double half = (right - left) / (2.0 * kDiscs), across = (high - low) / 2.0;
    disc_radius_ = std::hypot(half, across) * (1.0 + 1e-9);
    for (int i = 0; i < kDiscs; ++i) discs_.push_back({left + (2 * i + 1) * half, (low + high) / 2.0});
  }

  std::vector<double> corners_;
  std::vector<Place> discs_;
  double radius_ = 0.0, disc_radius_ = 0.0;
};

// Costs of an inflation, as a costmap has them.
struct Inflation {
  double inscribed_radius, scaling_factor, radius;
};

class Ground {
 public:
  // `free`: Chebyshev distance in cells of each cell to the nearest blocked one, 255 at most.
  Ground(const footprint::Costs &costs, const footprint::Frame &frame, const std::uint8_t *free,
         const Inflation &inflation)
      : costs(costs), frame(frame), inflation(inflation), free_(free) {}

  footprint::Costs costs;
  footprint::Frame frame;
  Inflation inflation;

  // Cost of the cell that holds a point; 255 outside the map.
  int cost_under(double x, double y) const {
    const double dx = x - frame.x, dy = y - frame.y;
    if (!(std::abs(dx) < 1e12 && std::abs(dy) < 1e12)) return 255;
    const double row = std::floor((frame.cos * dy - frame.sin * dx) / frame.resolution);
    const double col = std::floor((frame.cos * dx + frame.sin * dy) / frame.resolution);
    if (!(0.0 <= row && row < static_cast<double>(costs.rows) && 0.0 <= col && col < static_cast<double>(costs.cols))) {
      return 255;
    }
    return costs.data[static_cast<std::ptrdiff_t>(row) * costs.cols + static_cast<std::ptrdiff_t>(col)];
  }

  // Whether it is known at a glance that an outline touches nothing, nor leaves the map, while it moves from a pose by
  // `moved` [m] and turns by `turned` [rad] at most.
  bool is_surely_free(const Pose &pose, const Outline &outline, double moved, double turned) const {
    const double room = room_around(pose.x, pose.y);
    if (room >= moved + outline.radius()) return true;
    const double needed = moved + turned * outline.radius() + outline.disc_radius();
    if (room < 0.5 * needed) return false;
    const double cos = std::cos(pose.yaw), sin = std::sin(pose.yaw);
    for (const Place &disc : outline.discs()) {
      const double x = pose.x + cos * disc.x - sin * disc.y, y = pose.y + sin * disc.x + cos * disc.y;
      if (room_around(x, y) < needed) return false;
    }
    return true;
  }

 private:
  // The free square around a point reaches so far [m].
  double room_around(double x, double y) const {
    const double dx = x - frame.x, dy = y - frame.y;
    const double row = std::floor((frame.cos * dy - frame.sin * dx) / frame.resolution);
    const double col = std::floor((frame.cos * dx + frame.sin * dy) / frame.resolution);
    const double rows = static_cast<double>(costs.rows), cols = static_cast<double>(costs.cols);
    if (!(0.0 <= row && row < rows && 0.0 <= col && col < cols)) return -1.0;
    const double edge = std::min(std::min(row, rows - 1.0 - row), std::min(col, cols - 1.0 - col));
    const double cells = static_cast<double>(
        free_[static_cast<std::ptrdiff_t>(row) * costs.cols + static_cast<std::ptrdiff_t>(col)]);
    return (std::min(cells, edge + 1.0) - 1.0) * frame.resolution;
  }

  const std::uint8_t *free_;
};

// What a thread keeps to test outlines with.
struct Touching {
  std::vector<footprint::Point> polygon;
  footprint::Box box{};
  footprint::Spans spans;
  footprint::Sweep sweep;

  bool collides(const Ground &ground, const Outline &outline, const Pose &pose) {
    const double at[3] = {pose.x, pose.y, pose.yaw};
    return footprint::collides(ground.costs, ground.frame, outline.data(), outline.count(), at, polygon, box, spans);
  }

  double clearance(const Ground &ground, const Outline &outline, const Pose &pose, double cap) {
    if (collides(ground, outline, pose)) return 0.0;
    const double resolution = ground.frame.resolution;
    return std::min(cap, resolution * footprint::nearest(ground.costs, polygon, box, cap / resolution));
  }

  void begin_sweeps(const Ground &ground, const Outline &outline) {
    sweep.begin(ground.costs, ground.frame, outline.data(), outline.count());
  }

  // Of the outline that `begin_sweeps` took.
  bool sweep_touches(const Pose &from, const Pose &to) {
    const double first[3] = {from.x, from.y, from.yaw}, last[3] = {to.x, to.y, to.yaw};
    return sweep.free_share(first, last) < footprint::kInfinity;
  }
};

}  // namespace trundle::missions
