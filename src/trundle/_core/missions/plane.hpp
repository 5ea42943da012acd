// Lengths, angles and arcs in the plane, with the operations of `trundle.geometry` in their order.
#pragma once

#include <algorithm>
#include <cmath>

namespace trundle::missions {

inline constexpr double kPi = 3.141592653589793;
inline constexpr double kDegree = kPi / 180.0;

struct Place {
  double x, y;
};

struct Pose {
  double x, y, yaw;
};

struct Twist {
  double v, w;
  bool operator==(const Twist &other) const { return v == other.v && w == other.w; }
};

// The square of a number, and what rounding has taken from it (Dekker 1971).
struct Square {
  double value, rest;
  explicit Square(double x) {
    const double scaled = 134217729.0 * x, high = scaled - (scaled - x), low = x - high;
    value = x * x;
    rest = ((high * high - value) + 2.0 * high * low) + low * low;
  }
};

// √(x² + y²), rounded correctly but for a few in a million: Python's is, and the C library's is not.
inline double length(double x, double y) {
  x = std::abs(x), y = std::abs(y);
  if (x < y) std::swap(x, y);
  if (y == 0.0 || !(x < 1e100 && y > 1e-100)) return std::hypot(x, y);
  const Square along(x), across(y);
  const double sum = along.value + across.value;
  const double rest = ((along.value - sum) + across.value) + (along.rest + across.rest);
  const double root = std::sqrt(sum);
  const Square again(root);
  return root + ((sum - again.value) - again.rest + rest) / (2.0 * root);
}

// To (−π, π].
inline double wrap_angle(double angle) {
  const double wrapped = std::remainder(angle, 2.0 * kPi);
  return wrapped == -kPi ? kPi : wrapped;
}

// Shares of its length that an arc which turns by `turn` leads ahead and to the left.
struct ArcShares {
  double along, across;
  explicit ArcShares(double turn) {
    const bool is_small = std::abs(turn) < 1e-6;
    along = is_small ? 1.0 - turn * turn / 6.0 : std::sin(turn) / turn;
    across = is_small ? turn / 2.0 : (1.0 - std::cos(turn)) / turn;
  }
};

inline Pose integrate_twist(const Pose &pose, double v, double w, double dt) {
  const double turn = w * dt;
  const ArcShares arc(turn);
  const double cos = std::cos(pose.yaw), sin = std::sin(pose.yaw), step = v * dt;
  return {pose.x + step * (cos * arc.along - sin * arc.across), pose.y + step * (sin * arc.along + cos * arc.across),
          pose.yaw + turn};
}

}  // namespace trundle::missions
