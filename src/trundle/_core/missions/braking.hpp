// What a robot drives until it stands, within its limits.
#pragma once

#include "missions/plane.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace trundle::missions {

struct SpeedLimits {
  double forward, reverse, turning, acceleration, angular_acceleration;

  Twist clamp(const Twist &twist) const {
    return {std::min(forward, std::max(-reverse, twist.v)), std::min(turning, std::max(-turning, twist.w))};
  }
};

// Driving a command for `dt`, and then braking to a stop: `trundle.control.collision.stopping_poses`, which see.
inline void drive_and_brake(const SpeedLimits &limits, const Pose &pose, const Twist &twist, const Twist &command,
                            double dt, double turn_step, std::vector<Pose> &poses) {
  constexpr double kSubstep = 0.05, kFastest = 1e6;
  constexpr int kMostSteps = 1000;
  poses.assign(1, pose);
  const double linear = limits.acceleration, angular = limits.angular_acceleration;
  Twist goal = limits.clamp(command);
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
    const double parts = std::max(1.0, std::ceil(std::min(std::abs(mean_w) * step / turn_step, 180.0)));
    for (int part = 0; part < static_cast<int>(parts); ++part) {
      at = integrate_twist(at, mean_v, mean_w, step / parts);
      poses.push_back(at);
    }
    v += change_v, w += change_w;
    driven += step;
    if (driven >= dt - 1e-12) {
      if (std::abs(v) < 1e-9 && std::abs(w) < 1e-9) break;
      goal = {0.0, 0.0};
    }
  }
}

}  // namespace trundle::missions
