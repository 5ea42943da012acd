// The motion primitives of a hybrid A* search: straight lines, arcs to both sides, turns in place.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "hybrid/query.hpp"

namespace trundle {

struct HybridMotion {
  Segment segment;
  double cost;  // where cells cost 1
  int direction, bins;
};

// Every motion leads to another cell of the size `cell` [m] or to another heading. Arcs turn by whole headings: by as
// few as possible with `fine`, and otherwise by as many as lead to another cell.
inline std::vector<HybridMotion> hybrid_motions(const MotionModel &model, double cell, const StateGrid &states, bool fine) {
  std::vector<HybridMotion> motions;
  const auto add = [&](const Segment &segment, int direction, int bins) {
    const double cost = direction == 0 ? model.turn_cost * std::fabs(segment.turn) : model.length_cost(segment.length);
    motions.push_back({segment, cost, direction, bins});
  };
  const double least = 1.41422 * cell;
  const double step = states.heading_step();
  double straight = least;
  int bins = 0;
  if (model.radius > 0.0 && fine) {
    bins = states.close ? 2 : 1;
  } else if (model.radius > 0.0) {
    bins = std::clamp(static_cast<int>(std::ceil(std::min(least / (model.radius * step), 100.0))), 1, 18);
    straight = std::max(least, std::min(model.radius * bins * step, 4.0 * cell));
  }
  for (const int direction : {1, -1}) {
    if (direction < 0 && !model.reverse) break;
    add({direction * straight, 0.0}, direction, 0);
    for (int side = -1; side <= 1 && bins > 0; side += 2) {
      const double turn = bins * step;
      add({direction * model.radius * turn, direction * side * turn}, direction, direction * side * bins);
      if (!states.close) continue;
      add({direction * model.radius * turn, direction * side * 0.5 * turn}, direction, direction * side * bins / 2);
    }
  }
  const int turn_bins = fine ? 1 : 3;
  for (int side = -1; side <= 1 && model.in_place; side += 2) {
    add({0.0, side * turn_bins * step}, 0, side * turn_bins);
  }
  return motions;
}

}  // namespace trundle
