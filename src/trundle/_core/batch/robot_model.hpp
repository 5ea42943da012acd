// One robot: its limits at every substep, its footprint and lidars; the model that all robots of a batch share.
//
// The operations and their order are those of the kinematic simulator, but for sine and cosine.
#pragma once

#include "batch/scene.hpp"

#include "mppi/draws.hpp"
#include "shared/ramp.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace trundle::batch {

struct Limits {
  double forward, reverse, turning;
  RampLimits ramp;
  double timestep;
};

struct Lidar {
  Point mount;
  double range_min, reach;
  std::size_t first, end;  // of the beams
};

struct Touched {
  std::int64_t kind, first, second, substep;  // kind 0: nothing, 1: cell (row, col), 2: mover (index, 0)
};

struct Errors {
  double noise, dropouts;
  std::uint64_t key, scan;  // what the random numbers depend on, with the number of the beam
};

class RobotModel {
 public:
  Limits limits{};
  std::vector<Point> outline;
  double radius = 0.0;  // of the circle about base_link with the outline in it
  std::vector<Point> cover;  // discs of one radius that have all of the outline in them
  double cover_radius = 0.0;
  double resolution = 1.0;
  std::vector<Lidar> lidars;
  std::vector<Point> beams;  // unit vectors in base_link

  // Cover the outline's bounding box with discs along x: four fit within a few centimetres.
  void cover_outline() {
    constexpr int kDiscs = 4;
    double left = kFar, right = -kFar, low = kFar, high = -kFar;
    for (const Point &corner : outline) {
      left = std::min(left, corner.x), right = std::max(right, corner.x);
      low = std::min(low, corner.y), high = std::max(high, corner.y);
    }
    const double half = (right - left) / (2.0 * kDiscs), across = (high - low) / 2.0;
    cover_radius = std::sqrt(half * half + across * across) * (1.0 + 1e-9);
    for (int i = 0; i < kDiscs; ++i) cover.push_back({left + (2 * i + 1) * half, (low + high) / 2.0});
  }

  // The first thing that the footprint touches at a pose: a cell before movers, the movers by their numbers.
  // `map_is_free`: whether it is known to touch no cell.
  Touched touch(const Pose &pose, const Map &map, bool map_is_free, const Movers &movers, std::int64_t recording,
                double time, const Members &members, Spans &spans, std::vector<Point> &one,
                std::vector<Point> &other) const {
    if (!map_is_free) {
      const Point base = map.to_cells(pose.x, pose.y, resolution);
      place(sin_cos(pose.yaw - map.yaw), one);
      for (Point &corner : one) corner = {base.x + corner.x / resolution, base.y + corner.y / resolution};
      const Cell cell = first_overlap(map.field, one.data(), one.size(), kTouch / resolution, spans);
      if (cell.row >= 0) return {1, cell.row, cell.col, 0};
    }
    if (recording < 0) return {0, 0, 0, 0};
    const Recording &present = movers.recordings[static_cast<std::size_t>(recording)];
    bool placed = false;
    for (std::size_t index = present.first; index < present.end; ++index) {
      const Mover &mover = movers.all[index];
      const Pose at = movers.at(index, time, members);
      const double dx = at.x - pose.x, dy = at.y - pose.y, reach = radius + mover.radius;
      if (!(dx * dx + dy * dy < reach * reach)) continue;
      if (!placed) place(sin_cos(pose.yaw), one);
      placed = true;
      bool hit;
      if (mover.is_disc()) {
        hit = overlaps_disc(one.data(), one.size(), dx, dy, mover.radius);
      } else {
        const SinCos turn = sin_cos(at.yaw);
        other.resize(mover.corners.size());
        for (std::size_t i = 0; i < other.size(); ++i) {
          const Point &corner = mover.corners[i];
          other[i] = {dx + turn.cos * corner.x - turn.sin * corner.y, dy + turn.sin * corner.x + turn.cos * corner.y};
        }
        hit = is_joined(one.data(), one.size(), other.data(), other.size()) &&
              is_joined(other.data(), other.size(), one.data(), one.size());
      }
      if (hit) return {2, static_cast<std::int64_t>(index), 0, 0};
    }
    return {0, 0, 0, 0};
  }

  // How far [m] the footprint is from everything blocked, at least; below 0 where that does not show at a glance, by the
  // free squares around the centres of the discs that cover it.
  double room(const Pose &pose, const Map &map) const {
    const Point base = map.to_cells(pose.x, pose.y, resolution);
    const double around = free_at(base.x, base.y, map) - radius;
    if (around > cover_radius) return around;
    const SinCos turn = sin_cos(pose.yaw - map.yaw);
    double least = kFar;
    for (const Point &disc : cover) {
      const double x = base.x + (turn.cos * disc.x - turn.sin * disc.y) / resolution;
      const double y = base.y + (turn.sin * disc.x + turn.cos * disc.y) / resolution;
      least = std::min(least, free_at(x, y, map) - cover_radius);
      if (least < 0.0) break;
    }
    return std::max(around, least);
  }

  // One turn of every lidar. Ranges are infinite without a return.
  template <typename Range>
  void scan(const Pose &pose, const Map &map, const Movers &movers, std::int64_t recording, double time,
            const Members &members, const Errors &errors, std::vector<Point> &corners, Range *ranges) const {
    const SinCos turn = sin_cos(pose.yaw - map.yaw), heading = sin_cos(pose.yaw);
    const Point base = map.to_cells(pose.x, pose.y, resolution);
    for (const Lidar &lidar : lidars) {
      const double x = base.x + (turn.cos * lidar.mount.x - turn.sin * lidar.mount.y) / resolution;
      const double y = base.y + (turn.sin * lidar.mount.x + turn.cos * lidar.mount.y) / resolution;
      const double reach = lidar.reach / resolution;
      for (std::size_t i = lidar.first; i < lidar.end; ++i) {
        const Point &beam = beams[i];
        const double dx = turn.cos * beam.x - turn.sin * beam.y, dy = turn.sin * beam.x + turn.cos * beam.y;
        ranges[i] = static_cast<Range>(cast_jumping_ray(map.field, x, y, dx, dy, reach) * resolution);
      }
      if (recording >= 0) {
        const Recording &present = movers.recordings[static_cast<std::size_t>(recording)];
        for (std::size_t index = present.first; index < present.end; ++index) {
          see(movers.all[index], movers.at(index, time, members), pose, heading, lidar, corners, ranges);
        }
      }
      for (std::size_t i = lidar.first; i < lidar.end; ++i) ranges[i] = measure(ranges[i], lidar, errors, i);
    }
  }

 private:
  // How far [m] a point is from everything blocked, at least; below 0 in it, and beyond the map.
  double free_at(double x, double y, const Map &map) const {
    const double cols = static_cast<double>(map.field.cols), rows = static_cast<double>(map.field.rows);
    if (!(x >= 0.0 && y >= 0.0 && x < cols && y < rows)) return -kFar;
    const int free = map.field.at(static_cast<std::ptrdiff_t>(y), static_cast<std::ptrdiff_t>(x));
    return static_cast<double>(free - 1) * resolution;
  }

  void place(const SinCos &turn, std::vector<Point> &out) const {
    out.resize(outline.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i] = {turn.cos * outline[i].x - turn.sin * outline[i].y, turn.sin * outline[i].x + turn.cos * outline[i].y};
    }
  }

  // Shorten the ranges of the beams that meet a mover; all in base_link.
  template <typename Range>
  void see(const Mover &mover, const Pose &at, const Pose &pose, const SinCos &heading, const Lidar &lidar,
           std::vector<Point> &corners, Range *ranges) const {
    const double dx = at.x - pose.x, dy = at.y - pose.y;
    const double x = heading.cos * dx + heading.sin * dy - lidar.mount.x;
    const double y = heading.cos * dy - heading.sin * dx - lidar.mount.y;
    const double far = lidar.reach + mover.radius;
    if (!(x * x + y * y <= far * far)) return;
    const bool inside = x * x + y * y <= mover.radius * mover.radius;
    corners.resize(mover.corners.size());
    const SinCos turn = sin_cos(at.yaw - pose.yaw);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Point &corner = mover.corners[k];
      corners[k] = {x + turn.cos * corner.x - turn.sin * corner.y, y + turn.sin * corner.x + turn.cos * corner.y};
    }
    for (std::size_t i = lidar.first; i < lidar.end; ++i) {
      const Point &beam = beams[i];
      if (!inside && (beam.x * x + beam.y * y < 0.0 || std::abs(beam.x * y - beam.y * x) > mover.radius)) continue;
      const double distance = mover.is_disc()
                                  ? ray_to_disc(0.0, 0.0, beam.x, beam.y, x, y, mover.radius)
                                  : ray_to_polygon(0.0, 0.0, beam.x, beam.y, corners.data(), corners.size());
      if (distance < static_cast<double>(ranges[i])) ranges[i] = static_cast<Range>(distance);
    }
  }

  template <typename Range>
  Range measure(Range met, const Lidar &lidar, const Errors &errors, std::size_t beam) const {
    if (!(static_cast<double>(met) <= lidar.reach)) return static_cast<Range>(kFar);
    double range = static_cast<double>(met);
    if (errors.noise > 0.0 || errors.dropouts > 0.0) {
      const std::uint64_t index = errors.scan * beams.size() + beam;
      const double drawn = static_cast<double>(mppi::hashed(mppi::hashed(errors.key ^ 0x5ca1ab1eull) + index) >> 11);
      if (drawn * 0x1p-53 < errors.dropouts) return static_cast<Range>(kFar);
      if (errors.noise > 0.0) range += errors.noise * static_cast<double>(mppi::normal(errors.key, index));
    }
    return static_cast<Range>(std::min(std::max(range, lidar.range_min), lidar.reach));
  }
};

}  // namespace trundle::batch
