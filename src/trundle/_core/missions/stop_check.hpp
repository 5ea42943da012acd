// Whether a command leaves a robot room to stop, as `trundle.control.collision` says it.
#pragma once

#include "missions/braking.hpp"
#include "missions/ground.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace trundle::missions {

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
    drive_and_brake(limits_, pose, twist, command, dt, kTurnStep, poses_);
    return may_pass(ground, padded);
  }

 private:
  static constexpr double kSubstep = 0.05, kTurnStep = 2.0 * kDegree, kNearest = 0.1;

  // How far it comes at most while it drives and brakes.
  static double way(double speed, double target, double acceleration, double dt) {
    const double fastest = std::max(std::abs(speed), std::abs(target));
    return fastest * (dt + 2.0 * kSubstep) + fastest * fastest / (2.0 * acceleration);
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
