// Theta*: K. Daniel, A. Nash, S. Koenig, A. Felner, "Theta*: Any-Angle Path Planning on Grids" (2010), basic Theta*. A*
// over the centres of cells, where a cell's parent is its neighbour's parent if it can be seen from there.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "grid/bit_grid.hpp"
#include "grid/point_nodes.hpp"
#include "grid/row_scans.hpp"
#include "shared/grid_steps.hpp"
#include "shared/open_list.hpp"

namespace trundle {

// Whether a point can go straight between the centres of two free cells. It may touch blocked cells, and does not pass
// between two that touch at a corner. Exact, as any_angle.hpp explains.
inline bool sees(const BitGrid &grid, HalfCell a, HalfCell b) {
  if (b.y < a.y) std::swap(a, b);
  const std::int32_t first = a.y / 2, last = b.y / 2;
  const double across = b.x - a.x, up = b.y - a.y;
  double here = a.x;
  for (std::int32_t row = first; row <= last; ++row) {
    const double there = row == last ? b.x : a.x + across * (2 * (row + 1) - a.y) / up;
    const auto left = static_cast<std::int32_t>(std::floor((across < 0 ? there : here) / 2.0));
    const auto right = static_cast<std::int32_t>(std::ceil((across < 0 ? here : there) / 2.0));
    if (next_blocked(grid, row, left) < right) return false;
    const auto corner = static_cast<std::int32_t>(there) / 2;
    if (row < last && there == 2.0 * corner) {
      const std::int32_t low = across > 0 ? corner : corner - 1, high = across > 0 ? corner - 1 : corner;
      if (grid.blocked(row, low) && grid.blocked(row + 1, high)) return false;
    }
    here = there;
  }
  return true;
}

// Memory of one Theta* search, kept for the next.
struct ThetaStarMemory {
  void clear() {
    nodes.clear();
    open.clear();
  }
  std::size_t bytes() const { return nodes.bytes() + open.bytes(); }

  PointNodes nodes;
  OpenList<OpenPoint> open;
};

// Cells of the grid with its border; both are free and joined.
inline PointWay theta_star(const BitGrid &grid, GridCell start, GridCell goal, const Patience &patience,
                           ThetaStarMemory &memory) {
  constexpr std::uint32_t kPoll = 64;  // expansions between two looks at the clock
  auto &nodes = memory.nodes;
  auto &open = memory.open;
  memory.clear();
  const HalfCell target{2 * goal.col + 1, 2 * goal.row + 1};
  const auto distance = [](HalfCell a, HalfCell b) {
    const double x = b.x - a.x, y = b.y - a.y;
    return std::sqrt(x * x + y * y);
  };
  const auto push = [&](HalfCell at, double reached, std::uint32_t parent) {
    const std::uint32_t node = nodes.reach(at, reached, parent);
    if (node == PointNodes::kOutdone) return;
    open.push({reached + distance(at, target), node});
  };
  push({2 * start.col + 1, 2 * start.row + 1}, 0.0, 0);
  PointWay way;
  for (std::uint32_t turn = 0; !open.empty(); ++turn) {
    if (turn % kPoll == 0) {
      way.status = patience.left();
      if (way.status != SearchStatus::kFound) return way;
    }
    const std::uint32_t index = open.pop().node;
    if (nodes.outdone(index)) continue;
    const PointNodes::Node node = nodes[index], before = nodes[node.parent];
    if (node.at == target) {
      way.status = SearchStatus::kFound;
      nodes.trace(index, target, way);
      return way;
    }
    const std::int32_t row = node.at.y / 2, col = node.at.x / 2;
    for (int direction = 0; direction < 8; ++direction) {
      const std::int32_t up = kStepRow[direction], across = kStepCol[direction];
      if (grid.blocked(row + up, col + across) || grid.blocked(row + up, col) || grid.blocked(row, col + across)) {
        continue;
      }
      const HalfCell next{node.at.x + 2 * across, node.at.y + 2 * up};
      const double direct = before.reached + distance(before.at, next);
      if (nodes.reached_within(next, direct)) continue;  // no way is shorter than the direct one
      if (sees(grid, before.at, next)) {
        push(next, direct, node.parent);
      } else {
        push(next, node.reached + distance(node.at, next), index);
      }
    }
  }
  way.status = SearchStatus::kUnreachable;
  return way;
}

}  // namespace trundle
