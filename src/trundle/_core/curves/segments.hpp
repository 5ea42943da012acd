// Sequences of arcs, straight lines and turns in place: merging parts that continue each other, and poses along them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "costmap/pose_checker.hpp"

namespace trundle {

// Whether a part is rounding noise: a curve of several pieces may have one of some nanometres.
inline bool is_rounding(const Segment &part) {
  constexpr double kLength = 1e-6, kTurn = 1e-5;  // [m], [rad]
  return std::fabs(part.length) < kLength && std::fabs(part.turn) < kTurn;
}

// Consecutive parts of the same kind and direction become one; rounding noise is left out.
inline std::vector<Segment> merged(const std::vector<Segment> &parts) {
  std::vector<Segment> out;
  for (const Segment &part : parts) {
    if (is_rounding(part)) continue;
    if (!out.empty()) {
      Segment &last = out.back();
      const bool same_way = last.length * part.length > 0.0 || (last.length == 0.0 && part.length == 0.0);
      // Of two turns in place those of one direction; of two arcs those of one curvature.
      const bool alike = part.length == 0.0 ? last.turn * part.turn > 0.0
                                            : std::fabs(last.turn * part.length - part.turn * last.length) <
                                                  1e-9 * std::fabs(part.length * last.length);
      if (same_way && alike) {
        last.length += part.length, last.turn += part.turn;
        continue;
      }
    }
    out.push_back(part);
  }
  return out;
}

// Visits poses along the parts, the first excepted, at most `spacing` apart and with less than half a turn between two,
// each with whether it is reached backwards. Returns the last one.
template <typename Visit>
PlanarPose for_each_pose(const PlanarPose &start, const std::vector<Segment> &parts, double spacing, Visit &&visit) {
  constexpr double kLongestTurn = 2.0;  // [rad]
  PlanarPose pose = start;
  for (const Segment &part : parts) {
    const double pieces = std::max(std::fabs(part.length) / spacing, std::fabs(part.turn) / kLongestTurn);
    const int count = std::max(1, static_cast<int>(std::ceil(std::min(pieces - 1e-9, 1e8))));
    for (int i = 1; i <= count; ++i) {
      const double share = static_cast<double>(i) / count;
      visit(Segment{part.length * share, part.turn * share}.from(pose), part.length < 0.0);
    }
    pose = part.from(pose);
  }
  return pose;
}

}  // namespace trundle
