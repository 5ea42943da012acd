// How a robot comes closer to a command with each step: within its accelerations, then within the speed of its wheels. As
// `CommandRamp` of `trundle.sim.ramp`.
#pragma once

#include <algorithm>
#include <cmath>

namespace trundle {

struct RampLimits {
  double linear_step, angular_step, wheel_radius, track_width, wheel_speed;
};

// The ramp before and after the wheels' limit, and how fast the wheels turn.
struct RampedMotion {
  double ramp_v = 0.0, ramp_w = 0.0, v = 0.0, w = 0.0, left_speed = 0.0, right_speed = 0.0;

  // Come closer by one step; whether the wheels would have to turn faster than they can.
  bool approach(double target_v, double target_w, const RampLimits &limits) {
    if (ramp_v == target_v && ramp_w == target_w) return false;
    ramp_v += std::min(limits.linear_step, std::max(-limits.linear_step, target_v - ramp_v));
    ramp_w += std::min(limits.angular_step, std::max(-limits.angular_step, target_w - ramp_w));
    v = ramp_v;
    w = ramp_w;
    const double across = w * limits.track_width / 2.0, most = limits.wheel_speed;
    left_speed = (v - across) / limits.wheel_radius;
    right_speed = (v + across) / limits.wheel_radius;
    if (!(std::abs(left_speed) > most || std::abs(right_speed) > most)) return false;
    left_speed = std::min(most, std::max(-most, left_speed));
    right_speed = std::min(most, std::max(-most, right_speed));
    v = limits.wheel_radius * (left_speed + right_speed) / 2.0;
    w = limits.wheel_radius * (right_speed - left_speed) / limits.track_width;
    return true;
  }
};

}  // namespace trundle
