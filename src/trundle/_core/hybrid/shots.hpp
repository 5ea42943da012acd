// Analytic expansions: curves from a pose straight to the goal, whatever is in between. Dubins and Reeds-Shepp curves,
// and for robots that turn in place a turn, a line and a turn.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "costmap/pose_checker.hpp"
#include "curves/curves.hpp"
#include "curves/reeds_shepp.hpp"

namespace trundle {

// How a robot moves, and what that costs; lengths in metres.
struct MotionModel {
  double radius;            // of the tightest arc; 0 for a robot that only turns in place
  bool reverse, in_place;   // whether it drives backwards, and turns in place
  double reverse_penalty;   // what a metre backwards costs, in metres; at least 1
  double change_cost;       // of a change between forward and backward
  double turn_cost;         // of a radian turned in place

  double length_cost(double length) const { return length < 0.0 ? -length * reverse_penalty : length; }

  // The least that any path to (x, y, phi) from (0, 0, 0) costs.
  //
  // A metre of an arc turns by at most 1 / radius, and a metre's cost in place by 1 / turn_cost, so no path of a robot
  // that turns in place is cheaper than the least time with |v| <= 1 and |w| <= 1 / rho, rho the smaller of the two:
  // the Reeds-Shepp curve of that radius, which stays the shortest with these inequalities instead of equalities
  // (Sussmann and Tang, "Shortest paths for the Reeds-Shepp car", 1991).
  double least_cost(double x, double y, double phi) const {
    const double rho = tightest(), distance = std::hypot(x, y);
    if (rho <= 1e-6 * (1.0 + distance)) return distance;
    if (in_place || reverse) {
      return rho * shortest_length([&](auto &&visit) { for_each_reeds_shepp(x / rho, y / rho, phi, visit); });
    }
    return rho * shortest_length([&](auto &&visit) { for_each_dubins(x / rho, y / rho, phi, visit); });
  }

  // The most by which that exceeds the straight line.
  //
  // In both directions: arcs L+ R- L+ turn by any angle a on the spot in rho a, and of turning, driving straight ahead
  // or straight back, and turning again, one of the two turns by pi at most in sum. Forward only: Savla, Frazzoli and
  // Bullo, "Traveling salesperson problems for the Dubins vehicle" (2008), theorem 3.1.
  double most_detour() const { return (in_place || reverse ? kPi : 2.658 * kPi) * tightest(); }

 private:
  double tightest() const { return !in_place ? radius : radius > 0.0 ? std::min(radius, turn_cost) : turn_cost; }
};

struct Shot {
  double cost = 0.0;  // where every cell costs 1
  int count = 0;
  Segment parts[5] = {};
};

// The curves from a pose to the goal that the robot's motions allow, the cheapest first.
class Shots {
 public:
  static constexpr int kYaws = 16;  // of a goal whose yaw is free

  explicit Shots(const MotionModel &model) : model_(model) {}

  // `direction` is how the robot came here: 1, -1 or 0. With `any_yaw` the goal's yaw is one of 16.
  const std::vector<Shot> &find(const PlanarPose &from, const PlanarPose &goal, bool any_yaw, int direction) {
    shots_.clear();
    const double dx = goal.x - from.x, dy = goal.y - from.y, cos = std::cos(from.yaw), sin = std::sin(from.yaw);
    const double x = cos * dx + sin * dy, y = cos * dy - sin * dx;
    for (int i = 0; i < (any_yaw ? kYaws : 1); ++i) {
      const double phi = wrap(std::remainder(goal.yaw - from.yaw + i * (2.0 * kPi / kYaws), 2.0 * kPi));
      if (model_.radius > 0.0) add_curves(x / model_.radius, y / model_.radius, phi, direction);
      if (model_.in_place) add_turns(x, y, phi, direction, any_yaw);
      if (any_yaw && model_.in_place && model_.radius <= 0.0) break;
    }
    const auto kept = shots_.begin() + static_cast<std::ptrdiff_t>(std::min(shots_.size(), kTries));
    std::partial_sort(shots_.begin(), kept, shots_.end(),
                      [](const Shot &a, const Shot &b) { return a.cost < b.cost; });
    shots_.erase(kept, shots_.end());
    return shots_;
  }

 private:
  static constexpr std::size_t kTries = 5;
  static constexpr double kNothing = 1e-9;

  void add_curves(double x, double y, double phi, int direction) {
    const auto keep = [&](const Curve &curve) {
      Shot shot;
      for (int i = 0; i < curve.count; ++i) {
        const CurvePiece &piece = curve.pieces[i];
        if (std::fabs(piece.length) < kNothing) continue;
        shot.parts[shot.count++] = {piece.length * model_.radius, piece.length * piece.steer};
      }
      push(shot, direction);
    };
    if (model_.reverse) {
      for_each_reeds_shepp(x, y, phi, keep);
    } else {
      for_each_dubins(x, y, phi, keep);
    }
  }

  // Each turn in either direction.
  void add_turns(double x, double y, double phi, int direction, bool any_yaw) {
    const double distance = std::hypot(x, y);
    for (const int sign : {1, -1}) {
      if (sign < 0 && !model_.reverse) break;
      const double first = distance < kNothing ? 0.0 : wrap(std::atan2(y, x) + (sign < 0 ? kPi : 0.0));
      const double last = any_yaw ? 0.0 : wrap(std::remainder(phi - first, 2.0 * kPi));
      for (int k = 0; k < 4; ++k) {
        const double a = (k & 1) != 0 ? other_direction(first) : first, b = (k & 2) != 0 ? other_direction(last) : last;
        if (((k & 1) != 0 && first == 0.0) || ((k & 2) != 0 && last == 0.0)) continue;
        Shot shot;
        if (std::fabs(a) > kNothing) shot.parts[shot.count++] = {0.0, a};
        if (distance > kNothing) shot.parts[shot.count++] = {sign * distance, 0.0};
        if (std::fabs(b) > kNothing) shot.parts[shot.count++] = {0.0, b};
        push(shot, direction);
      }
    }
  }

  static double other_direction(double turn) { return turn - std::copysign(2.0 * kPi, turn); }

  void push(Shot &shot, int direction) {
    for (int i = 0; i < shot.count; ++i) {
      const Segment &part = shot.parts[i];
      const int now = (part.length > 0.0) - (part.length < 0.0);
      shot.cost += now == 0 ? model_.turn_cost * std::fabs(part.turn) : model_.length_cost(part.length);
      if (now * direction < 0) shot.cost += model_.change_cost;
      direction = now;
    }
    shots_.push_back(shot);
  }

  const MotionModel model_;
  std::vector<Shot> shots_;
};

}  // namespace trundle
