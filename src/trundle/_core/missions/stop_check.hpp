// Whether a command leaves a robot room to stop, as `trundle.control.collision` says it.
#pragma once

#include "missions/ground.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace trundle::missions {

struct SpeedLimits {
  double forward, reverse, turning, acceleration, angular_acceleration;

  Twist clamp(const Twist &twist) const {
    return {std::min(forward, std::max(-reverse, twist.v)), std::min(turning, std::max(-turning, twist.w))};
  }
};

class StopCheck {
 public:
  StopCheck(const SpeedLimits &limits, const Outline &footprint) : limits_(limits), footprint_(footprint) {}

  // Whether it met what this check cannot judge: the footprint itself touches something.
  bool is_beyond = false;

  bool can_stop(const Ground &ground, const Pose &pose, const Twist &twist, const Twist &command, double dt,
                const Outline &padded) {
    const Twist target = limits_.clamp(command);
    const double moved = way(twist.v, target.v, limits_.acceleration, dt) + 0.01 * padded.radius() + 0.005;
    const double turned = way(twist.w, target.w, limits_.angular_acceleration, dt);
    if (ground.is_surely_free(pose, padded, moved, turned)) return true;
    drive_and_brake(pose, twist, command, dt);
    return may_pass(ground, padded);
  }

 private:
  static constexpr double kSubstep = 0.05, kTurnStep = 2.0 * kDegree, kFastest = 1e6, kNearest = 0.1;

  // How far it comes at most while it drives and brakes.
  static double way(double speed, double target, double acceleration, double dt) {
    const double fastest = std::max(std::abs(speed), std::abs(target));
    return fastest * (dt + 2.0 * kSubstep) + fastest * fastest / (2.0 * acceleration);
  }

  // Driving a command for `dt`, and then braking to a stop: the poses of `stopping_poses`, with the first one.
  void drive_and_brake(const Pose &pose, const Twist &twist, const Twist &command, double dt) {
    poses_.assign(1, pose);
    constexpr int kMostSteps = 1000;
    const double linear = limits_.acceleration, angular = limits_.angular_acceleration;
    Twist goal = limits_.clamp(command);
    double v = std::max(-kFastest, std::min(kFastest, twist.v)), w = std::max(-kFastest, std::min(kFastest, twist.w));
    double driven = 0.0;
    const double longest = std::max(std::max(dt, (std::abs(v) + std::abs(goal.v)) / linear),
                                    (std::abs(w) + std::abs(goal.w)) / angular);
    const double substep = std::max(kSubstep, longest / kMostSteps);
    Pose at = pose;
    for (int i = 0; i < 2 * kMostSteps; ++i) {
      const double step = driven >= dt ? substep : std::min(substep, dt - driven);
      const double change_v = std::min(linear * step, std::max(-linear * step, goal.v - v));
      const double change_w = std::min(angular * step, std::max(-angular * step, goal.w - w));
      const double mean_v = v + 0.5 * change_v, mean_w = w + 0.5 * change_w;
      const double parts = std::max(1.0, std::ceil(std::min(std::abs(mean_w) * step / kTurnStep, 180.0)));
      for (int part = 0; part < static_cast<int>(parts); ++part) {
        at = integrate_twist(at, mean_v, mean_w, step / parts);
        poses_.push_back(at);
      }
      v += change_v, w += change_w;
      driven += step;
      if (driven >= dt - 1e-12) {
        if (std::abs(v) < 1e-9 && std::abs(w) < 1e-9) break;
        goal = {0.0, 0.0};
      }
    }
  }

  bool touches(std::size_t i) { return touching_.sweep_touches(poses_[i], poses_[i + 1]); }

  bool may_pass(const Ground &ground, const Outline &padded) {
    touching_.begin_sweeps(ground, padded);
    std::size_t first = 0;
    while (first + 1 < poses_.size() && !touches(first)) ++first;
    if (first + 1 >= poses_.size()) return true;
    if (!touching_.collides(ground, padded, poses_[0])) return false;
    double least = footprint::kInfinity, now = 0.0;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      const double clearance = touching_.clearance(ground, footprint_, poses_[i], kNearest);
      if (i == 0) now = clearance;
      else least = std::min(least, clearance);
    }
    bool leaves = first == 0 && !touching_.collides(ground, padded, poses_[1]);
    for (std::size_t i = 1; leaves && i + 1 < poses_.size(); ++i) leaves = !touches(i);
    touching_.begin_sweeps(ground, footprint_);
    if (leaves) return !touches(0) || now == 0.0;
    if (now == 0.0) {
      is_beyond = true;
      return false;
    }
    if (std::min(now, least) == 0.0 || least < now - 1e-6) return false;
    for (std::size_t i = 0; i + 1 < poses_.size(); ++i) {
      if (touches(i)) return false;
    }
    return true;
  }

  const SpeedLimits &limits_;
  const Outline &footprint_;
  std::vector<Pose> poses_;
  Touching touching_;
};

}  // namespace trundle::missions
