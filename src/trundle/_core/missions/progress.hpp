// Whether a robot makes progress: as `PathProgress`, `BlockWatch` and `ProgressChecker` judge it, and `FollowedPath`.
#pragma once

#include "missions/plane.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace trundle::missions {

// A path that is followed from its beginning: poses close together, three numbers each, and how far along each is.
class FollowedPath {
 public:
  FollowedPath(const double *poses, const double *along, std::size_t count)
      : poses_(poses), along_(along), count_(count) {}

  double left() const { return along_[count_ - 1] - along_[index_]; }

  void advance(double x, double y) {
    const double until = along_[index_] + 1.0;
    double nearest = std::numeric_limits<double>::infinity();
    std::size_t at = index_;
    for (std::size_t i = index_; i < count_ && !(along_[i] > until); ++i) {
      const double dx = poses_[3 * i] - x, dy = poses_[3 * i + 1] - y, squared = dx * dx + dy * dy;
      if (squared < nearest) nearest = squared, at = i;
    }
    index_ = at;
  }

 private:
  const double *poses_, *along_;
  std::size_t count_, index_ = 0;
};

// Whether a robot that drives 8 m or turns twice round has 0.5 m less of its path left.
class PathProgress {
 public:
  bool may_be_lost(double left, const Twist &twist, double dt) {
    if (!(left > least_ - 0.5)) {
      least_ = left;
      driven_ = turned_ = 0.0;
    }
    driven_ += std::abs(twist.v) * dt;
    turned_ += std::abs(twist.w) * dt;
    return !(driven_ < 8.0 && turned_ < 4.0 * kPi);
  }

 private:
  double least_ = std::numeric_limits<double>::infinity(), driven_ = 0.0, turned_ = 0.0;
};

// A sum of distances or angles, and how far from 0 it has been.
struct Sum {
  double total = 0.0, unsigned_total = 0.0, farthest = 0.0;

  void add(double part) {
    total += part;
    unsigned_total += std::abs(part);
    farthest = std::max(farthest, std::abs(total));
  }
  bool leads_on() const { return std::abs(total) >= 0.01 && std::abs(total) > 0.5 * unsigned_total; }
};

class BlockWatch {
 public:
  bool is_blocked(const Twist &command, const Twist &twist, double dt) {
    constexpr double kDistance = 0.005;
    seconds_ += dt;
    driven_.add(twist.v * dt);
    if (driven_.farthest >= kDistance) {
      *this = BlockWatch();
      return false;
    }
    turned_.add(twist.w * dt);
    asked_driven_.add(command.v * dt);
    asked_turned_.add(command.w * dt);
    if (seconds_ < 0.5 - 1e-9) return false;
    const bool turns = turned_.leads_on();
    const bool asked = asked_driven_.farthest >= kDistance || asked_turned_.leads_on();
    if (!turns && asked && seconds_ < 2.0 - 1e-9) return false;
    *this = BlockWatch();
    return !turns;
  }

 private:
  double seconds_ = 0.0;
  Sum driven_, turned_, asked_driven_, asked_turned_;
};

// For how long a robot has neither moved nor turned by so much.
class ProgressChecker {
 public:
  ProgressChecker(double radius, double angle) : radius_(radius), angle_(angle) {}

  void reset() { has_pose_ = false; }

  double standing(const Pose &pose, double time) {
    if (!has_pose_ || length(pose.x - last_.x, pose.y - last_.y) >= radius_ ||
        std::abs(wrap_angle(pose.yaw - last_.yaw)) >= angle_) {
      has_pose_ = true, last_ = pose, since_ = time;
    }
    return time - since_;
  }

 private:
  double radius_, angle_, since_ = 0.0;
  bool has_pose_ = false;
  Pose last_{};
};

}  // namespace trundle::missions
