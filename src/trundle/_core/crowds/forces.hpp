// How the members of a crowd react: the forces of the social force model, and the rules that override them.
//
// Helbing and Molnár, Social Force Model for Pedestrian Dynamics, Physical Review E 51 (1995), with their parameters.
// Whatever its forces push them to, members do not run into each other, or into a robot that they see.
#pragma once

#include "batch/sine.hpp"
#include "crowds/floor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

namespace trundle::crowds {

// How near those who see the robot come to it [m], and to the line that it drives in the next seconds [s]: more holds
// them up far from its path, less lets them touch it before either has braked.
inline constexpr double kMargin = 0.5, kLookS = 1.5;
// Kept from the robot's circle by what turns beside it [m]: the tail of a forklift swings out where its middle stands.
inline constexpr double kSwingMargin = 0.1;

// The parameters of the paper, by its symbols.
inline constexpr double kTau = 0.5;                       // relaxation time [s]
inline constexpr double kSocial = 2.1, kSocialM = 0.3;    // V0 [m²/s²] and sigma
inline constexpr double kBorder = 10.0, kBorderM = 0.2;   // U0 [m²/s²] and R
inline constexpr double kStepS = 2.0;                     // time of another's step, delta t
inline constexpr double kSeen = -0.1736481776669303;      // cosine of half of the angle of sight, 2 phi = 200°
inline constexpr double kUnseen = 0.5;                    // c: share of a force from behind
inline constexpr double kPedestrian = 0.3;  // radius [m]; distances to what is wider are shortened by how much it is

struct Robot {
  double x, y, vx, vy, radius;
};

struct Moving {
  Vec at, velocity;
  double radius;
};

// e to the power of a number of at most 0, to 1e-15 of it: 2 to a whole power, and Taylor's series for the rest.
inline double exp_of(double x) {
  if (!(x > -700.0)) return 0.0;
  const double whole = batch::floor_of(x * 1.4426950408889634 + 0.5);
  // The first part of ln 2 has 33 bits: its product with the power is exact.
  const double r = (x - whole * 0x1.62e42feep-1) - whole * 0x1.a39ef35793c76p-33;
  double sum = 1.0 / 6227020800.0;
  for (const double factor : {479001600.0, 39916800.0, 3628800.0, 362880.0, 40320.0, 5040.0, 720.0, 120.0, 24.0, 6.0}) {
    sum = sum * r + 1.0 / factor;
  }
  const double value = 1.0 + (r + r * r * (0.5 + r * sum));
  const std::uint64_t bits = static_cast<std::uint64_t>(static_cast<std::int64_t>(whole) + 1023) << 52;
  double power;
  std::memcpy(&power, &bits, sizeof power);
  return value * power;
}

// The force on someone away from another, by the elliptical potential that lies ahead of each (equations 3, 4 and 7).
inline Vec repulsion(Vec at, double radius, Vec direction, const Moving &other) {
  const Vec apart{at.x - other.at.x, at.y - other.at.y};
  const double distance = length_of(apart);
  if (distance < 1e-9) return {0.0, 0.0};
  const Vec step{other.velocity.x * kStepS, other.velocity.y * kStepS}, beyond{apart.x - step.x, apart.y - step.y};
  const double reached = length_of(beyond), whole = distance + reached;
  const double minor = std::sqrt(std::max(whole * whole - (step.x * step.x + step.y * step.y), 1e-6)) / 2.0;
  const double wide = std::max(0.0, radius + other.radius - 2.0 * kPedestrian);
  double strength = kSocial / kSocialM * exp_of(-std::max(0.0, minor - wide) / kSocialM);
  strength = std::min(strength * (whole / (4.0 * minor)), 1e3);
  const double far = std::max(reached, 1e-9);
  const Vec force{strength * (apart.x / distance + beyond.x / far), strength * (apart.y / distance + beyond.y / far)};
  // A force from behind counts less: the one who makes it is not seen.
  const bool ahead = -(force.x * direction.x + force.y * direction.y) >= kSeen * length_of(force);
  const double share = ahead ? 1.0 : kUnseen;
  return {force.x * share, force.y * share};
}

// The force away from the nearest solid (equation 5).
inline Vec border_force(double distance, Vec away, double radius) {
  const double gap = std::max(0.0, distance - (radius - kPedestrian));
  const double strength = kBorder / kBorderM * exp_of(-gap / kBorderM);
  return {strength * away.x, strength * away.y};
}

// The distance of a point from the line that the robot drives next, and the unit vector from there.
inline double gap_to_path(Vec p, const Robot &robot, Vec &away) {
  const Vec along{robot.vx * kLookS, robot.vy * kLookS}, from{p.x - robot.x, p.y - robot.y};
  const double square = std::max(along.x * along.x + along.y * along.y, 1e-12);
  const double share = std::clamp((from.x * along.x + from.y * along.y) / square, 0.0, 1.0);
  const Vec offset{p.x - (robot.x + share * along.x), p.y - (robot.y + share * along.y)};
  const double distance = length_of(offset), length = std::max(distance, 1e-9);
  away = {offset.x / length, offset.y / length};
  return distance;
}

// Whether someone would come too near to the robot, or to where it is about to be; who is near may go away from it.
inline bool enters_path(Vec p, Vec reached, double radius, const Robot &robot) {
  Vec away;
  const double then = gap_to_path(reached, robot, away);
  return then < radius + robot.radius + kMargin && then < gap_to_path(p, robot, away) - 1e-12;
}

// A velocity without what leads into the robot, or into where it is about to be.
inline Vec give_way(Vec p, Vec velocity, double radius, const Robot &robot, double dt) {
  if (!enters_path(p, {p.x + velocity.x * dt, p.y + velocity.y * dt}, radius, robot)) return velocity;
  Vec away;
  gap_to_path(p, robot, away);
  const double inward = std::min(0.0, velocity.x * away.x + velocity.y * away.y);
  return {velocity.x - inward * away.x, velocity.y - inward * away.y};
}

// The distance of the robot's centre from an outline, counter-clockwise, at a pose; 0 inside.
inline double from_outline(const std::vector<Vec> &outline, Vec at, double yaw, const Robot &robot) {
  const SinCos turn = batch::sin_cos(yaw);
  const double dx = robot.x - at.x, dy = robot.y - at.y;
  const Vec p{turn.cos * dx + turn.sin * dy, turn.cos * dy - turn.sin * dx};
  bool inside = true;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec &from = outline[i], &to = outline[(i + 1) % outline.size()];
    const Vec along{to.x - from.x, to.y - from.y}, offset{p.x - from.x, p.y - from.y};
    if (!(along.x * offset.y >= along.y * offset.x)) inside = false;
    const double square = along.x * along.x + along.y * along.y;
    const double share = std::clamp((offset.x * along.x + offset.y * along.y) / square, 0.0, 1.0);
    nearest = std::min(nearest, length_of({offset.x - share * along.x, offset.y - share * along.y}));
  }
  return inside ? 0.0 : nearest;
}

// Whether a body would come too near to the robot by turning. Beside a robot that is within its turning circle, a turn
// away from the middle may still meet a corner: none is made.
inline bool swings_into(Vec at, double yaw, double turned, const std::vector<Vec> &outline, const Robot &robot) {
  const double after = from_outline(outline, at, turned, robot);
  if (!(after < robot.radius + kSwingMargin)) return false;
  const double before = from_outline(outline, at, yaw, robot);
  return after < before || before < robot.radius;
}

}  // namespace trundle::crowds
