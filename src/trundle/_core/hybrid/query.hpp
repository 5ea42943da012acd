// The settings, the query and the result of a hybrid A* search.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "costmap/pose_checker.hpp"
#include "hybrid/shots.hpp"
#include "shared/grid_steps.hpp"

namespace trundle {

// The resolution of states: cells `halves` times smaller than the settings say, and headings around a circle. With
// `close`, motions are as short as possible, and arcs of twice the radius are among them.
struct StateGrid {
  int halves, headings;
  bool close;
  double heading_step() const { return 2.0 * kPi / headings; }
};

inline constexpr StateGrid kStates{1, 72, false}, kHalfStates{2, 72, false}, kCloseStates{4, 216, true},
    kClosestStates{16, 216, true};
inline constexpr int kMostHeadings = 216;

struct HybridSettings {
  MotionModel model;
  double cost_weight;       // weight of a cell of cost 252, less that of a free cell, which is 1
  double heuristic_weight;  // at least 1
  double cell_size;         // of states and of the field [m]; at least a cell of the map

  // Cells of the map along a cell of states.
  int factor(double resolution) const {
    return std::max(1, static_cast<int>(std::lround(std::min(cell_size / resolution, 1e6))));
  }
};

struct HybridQuery {
  const std::uint8_t *costs;
  std::int64_t rows, cols;
  double resolution;
  const double *outline;
  std::size_t corners;
  PlanarPose start, goal;  // inside the grid; [m, m, rad] from its corner
  bool any_yaw;
  double step;             // how far a point of the outline may move between two checked poses [m]
  std::uint64_t max_expansions;
  const double *inner;     // the outline that has to be free, if that is not `outline`; or null
  bool thorough;           // whether to search in smaller cells and by shorter motions
  bool partial;            // whether a path to the nearest pose is wanted where none leads to the goal
};

struct HybridPath {
  SearchStatus status = SearchStatus::kUnreachable;
  bool spent = false;       // whether it stopped at the most expansions
  bool closed_off = false;  // whether there is no path even for the inscribed circle
  bool pocket = false;      // whether no motions lead to the goal from anywhere but nearby
  bool stuck = false;       // whether the motions hardly lead away from the start
  double cost = 0.0;
  std::uint64_t expansions = 0, field_cells = 0, exact_checks = 0;
  std::vector<Segment> parts;
  bool partial = false;  // whether the parts only lead near to the goal
};

}  // namespace trundle
