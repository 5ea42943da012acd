// Curves of straight lines and arcs of radius 1, and the shortest of them between two poses without obstacles.
//
// A goal is given as (x, y, phi) from a start at (0, 0, 0).
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>

namespace trundle {

inline constexpr double kPi = 3.14159265358979323846;

// Driven length, negative backwards, with the wheels to the left (1), straight (0) or to the right (-1).
struct CurvePiece {
  double length;
  int steer;
};

struct Curve {
  int count = 0;
  CurvePiece pieces[5] = {};

  void add(double length, int steer) { pieces[count++] = {length, steer}; }
  double length() const {
    double sum = 0.0;
    for (int i = 0; i < count; ++i) sum += std::fabs(pieces[i].length);
    return sum;
  }
};

// An angle that is a few turns off at most, in (-pi, pi].
inline double wrap(double angle) {
  while (angle > kPi) angle -= 2.0 * kPi;
  while (angle <= -kPi) angle += 2.0 * kPi;
  return angle;
}

// The same in [0, 2 pi); an angle less than a rounding below a full turn becomes 0.
inline double full_turn(double angle) {
  while (angle < 0.0) angle += 2.0 * kPi;
  while (angle >= 2.0 * kPi) angle -= 2.0 * kPi;
  return angle > 2.0 * kPi - 1e-9 ? 0.0 : angle;
}

// The shortest curves forward: Shkel and Lumelsky, "Classification of the Dubins set" (2001), section 2, in the frame
// of the start. A turn, a straight line and a turn, or three turns of which the middle one is more than half a circle.
// Visits every curve of the six words that there is, or of the four without three turns.
template <bool kThreeTurns = true, typename Visit>
void for_each_dubins(double x, double y, double phi, Visit &&visit) {
  for (const int side : {1, -1}) {  // right turns first are left turns first seen in a mirror
    const double my = side * y, mphi = side * phi;
    // Centres of the circles: (0, 1) at the start; (x - sin, y + cos) left and (x + sin, y - cos) right of the goal.
    const double sin = std::sin(mphi), cos = std::cos(mphi);
    const double same_x = x - sin, same_y = my + cos - 1.0, same = std::hypot(same_x, same_y);
    const double other_x = x + sin, other_y = my - cos - 1.0, other = std::hypot(other_x, other_y);
    const auto emit = [&](double first, double middle, double last, int middle_steer, int last_steer) {
      Curve curve;
      curve.add(first, side);
      curve.add(middle, side * middle_steer);
      curve.add(last, side * last_steer);
      visit(curve);
    };
    {  // LSL
      const double along = same > 1e-12 ? std::atan2(same_y, same_x) : 0.0;
      const double t = full_turn(along);
      emit(t, same, full_turn(mphi - t), 0, 1);
    }
    if (other >= 2.0) {  // LSR
      const double straight = std::sqrt(other * other - 4.0);
      const double t = full_turn(std::atan2(other_y, other_x) + std::atan2(2.0, straight));
      emit(t, straight, full_turn(t - mphi), 0, -1);
    }
    if (kThreeTurns && same <= 4.0) {  // LRL
      const double middle = 2.0 * kPi - 2.0 * std::asin(same / 4.0);
      const double along = same > 1e-12 ? std::atan2(same_y, same_x) : 0.0;
      const double t = full_turn(along + middle / 2.0);
      emit(t, middle, full_turn(mphi - t + middle), -1, 1);
    }
  }
}

template <typename ForEach>
double shortest_length(ForEach &&for_each) {
  double best = std::numeric_limits<double>::infinity();
  for_each([&](const Curve &curve) { best = std::fmin(best, curve.length()); });
  return best;
}

}  // namespace trundle
