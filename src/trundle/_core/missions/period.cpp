#include "missions/period.hpp"

#include "missions/plane.hpp"
#include "shared/checks.hpp"
#include "shared/ramp.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace trundle {

nb::tuple drive_period(In<double, 1> state, double v, double w, In<double, 1> limits, std::int64_t steps) {
  constexpr std::size_t kNumbers = 11;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  require(state.size() == kNumbers && limits.size() == 9, "a state has 11 numbers, and there are 9 limits");
  require(steps >= 1 && steps <= 10'000'000, "a control period has 1 to 10,000,000 steps");
  const double *s = state.data(), *l = limits.data();
  require(l[5] > 0.0 && l[6] > 0.0 && l[8] > 0.0, "wheels, track and steps must be positive");
  const RampLimits ramp{l[3], l[4], l[5], l[6], l[7]};
  const double timestep = l[8];
  const double target_v = std::min(l[0], std::max(-l[1], v)), target_w = std::min(l[2], std::max(-l[2], w));
  double x = s[0], y = s[1], yaw = s[2], left = s[3], right = s[4];
  RampedMotion motion{s[5], s[6], s[7], s[8], s[9], s[10]};
  double low_x = kInfinity, high_x = -kInfinity, low_y = kInfinity, high_y = -kInfinity;
  double last_v = std::nan(""), last_w = 0.0, by_length = 0.0;
  missions::ArcShares arc(0.0);
  bool is_cut = target_v != v || target_w != w;
  std::vector<double> rows(static_cast<std::size_t>(steps) * kNumbers);
  for (double *row = rows.data(), *end = row + rows.size(); row != end; row += kNumbers) {
    is_cut = motion.approach(target_v, target_w, ramp) || is_cut;
    if (motion.v != last_v || motion.w != last_w) {
      last_v = motion.v, last_w = motion.w;
      by_length = motion.v * timestep;
      arc = missions::ArcShares(motion.w * timestep);
    }
    const double cos = std::cos(yaw), sin = std::sin(yaw);
    x += by_length * (cos * arc.along - sin * arc.across);
    y += by_length * (sin * arc.along + cos * arc.across);
    yaw += motion.w * timestep;
    left += motion.left_speed * timestep;
    right += motion.right_speed * timestep;
    low_x = std::min(low_x, x), high_x = std::max(high_x, x);
    low_y = std::min(low_y, y), high_y = std::max(high_y, y);
    const double now[kNumbers] = {x,        y,        yaw,      left, right, motion.ramp_v, motion.ramp_w,
                                  motion.v, motion.w, motion.left_speed, motion.right_speed};
    std::copy(now, now + kNumbers, row);
  }
  return nb::make_tuple(to_numpy(std::move(rows), {static_cast<std::size_t>(steps), kNumbers}),
                        nb::make_tuple(low_x, high_x, low_y, high_y), is_cut);
}

}  // namespace trundle
