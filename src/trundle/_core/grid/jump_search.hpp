// Jump point search without corner cutting: D. Harabor, A. Grastien, "Improving Jump Point Search" (2014), with blocks
// of cells scanned together and without the intermediate points of diagonal jumps, JPS (B + P). Diagonal jumps are
// bounded as in N. Sturtevant, S. Rabin, "Canonical Orderings on Grids" (2016), where they lead away from the goal.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "grid/bit_grid.hpp"
#include "grid/point_table.hpp"
#include "shared/grid_steps.hpp"
#include "shared/open_list.hpp"

namespace trundle {

// Memory of one jump point search, kept for the next.
struct JumpMemory {
  struct Node {
    std::uint64_t reached;  // cost from the start
    GridCell at;
    std::uint32_t parent;
    std::int32_t arrival;  // direction of the last step
  };
  struct Open {
    std::uint64_t total, reached;
    std::uint32_t node;
    // The top is the smallest total, and the one that has come farthest of those.
    bool operator<(const Open &other) const {
      return total != other.total ? total > other.total : reached < other.reached;
    }
  };

  void clear() {
    nodes.clear();
    open.clear();
  }
  std::size_t bytes() const { return nodes.bytes() + open.bytes(); }

  PointTable<Node> nodes;
  OpenList<Open> open;
};

// Jumps by scanning the bits of a grid and of its transpose.
class Jumps {
 public:
  Jumps(const BitGrid &rows, const BitGrid &cols) : rows_(rows), cols_(cols) {}

  void prefetch(GridCell cell) const {
    rows_.prefetch(cell.row, cell.col);
    cols_.prefetch(cell.col, cell.row);
  }

  // Call `reach(cell, steps straight, steps diagonal, last direction)` for each jump point that is met in directions,
  // given as bits. A diagonal jump that has led so far away that the path to the goal costs more than `least` from here
  // is put off: where it got to is given as if it were a jump point, and most of those are never expanded.
  template <typename Reach>
  void jump(unsigned directions, GridCell from, GridCell goal, std::uint64_t least, Reach &&reach) const {
    const BitGrid::Rows rows = rows_.around(from.row), cols = cols_.around(from.col);
    for (unsigned left = directions; left != 0; left &= left - 1) {
      switch (__builtin_ctz(left)) {
        case 0: straight<0>(rows, from, goal, 0, reach); break;
        case 1: diagonal<1>(rows, cols, from, goal, least, reach); break;
        case 2: straight<2>(cols, from, goal, 0, reach); break;
        case 3: diagonal<3>(rows, cols, from, goal, least, reach); break;
        case 4: straight<4>(rows, from, goal, 0, reach); break;
        case 5: diagonal<5>(rows, cols, from, goal, least, reach); break;
        case 6: straight<6>(cols, from, goal, 0, reach); break;
        default: diagonal<7>(rows, cols, from, goal, least, reach);
      }
    }
  }

 private:
  static constexpr std::uint64_t kAtOnce = 16;  // diagonal steps; measured: 8 to 32 are alike

  // `lines` are the rows, or columns, around that of the cell. Returns whether the next cell is free.
  template <int Direction, typename Reach>
  static bool straight(const BitGrid::Rows &lines, GridCell from, GridCell goal, std::uint64_t diagonal, Reach &reach) {
    constexpr bool kAcross = Direction % 4 == 0;
    constexpr int kSign = kAcross ? kStepCol[Direction] : kStepRow[Direction];
    const std::int32_t here = kAcross ? from.col : from.row;
    const Stop stop = kSign > 0 ? BitGrid::scan_up(lines, here) : BitGrid::scan_down(lines, here);
    if (kAcross ? from.row == goal.row : from.col == goal.col) {
      const std::int32_t to_goal = ((kAcross ? goal.col : goal.row) - here) * kSign;
      if (to_goal > 0 && to_goal <= (stop.at - here) * kSign) {
        reach(goal, static_cast<std::uint64_t>(to_goal), diagonal, Direction);
        return true;
      }
    }
    if (stop.blocked) return stop.at != here + kSign;
    const GridCell cell = kAcross ? GridCell{from.row, stop.at} : GridCell{stop.at, from.col};
    reach(cell, static_cast<std::uint64_t>((stop.at - here) * kSign), diagonal, Direction);
    return true;
  }

  template <int Direction, typename Reach>
  void diagonal(BitGrid::Rows rows, BitGrid::Rows cols, GridCell from, GridCell goal, std::uint64_t least,
                Reach &reach) const {
    constexpr int kAlong = kStepCol[Direction] > 0 ? 0 : 4, kUp = kStepRow[Direction] > 0 ? 2 : 6;
    GridCell cell = from;
    bool free = !rows.blocked(cell.col + kStepCol[Direction]) && !cols.blocked(cell.row + kStepRow[Direction]);
    for (std::uint64_t steps = 1; free; ++steps) {
      cell = {cell.row + kStepRow[Direction], cell.col + kStepCol[Direction]};
      rows = rows_.onward<kStepRow[Direction]>(rows, cell.row);
      if (rows.blocked(cell.col)) return;
      cols = cols_.onward<kStepCol[Direction]>(cols, cell.col);
      if (steps % kAtOnce == 0 && steps * kDiagonalCost + octile_cost(cell, goal) > least) {
        reach(cell, 0, steps, Direction);
        return;
      }
      if (steps % 8 == 1) prefetch({cell.row + 12 * kStepRow[Direction], cell.col + 12 * kStepCol[Direction]});
      if (cell == goal) {
        reach(goal, 0, steps, Direction);
        return;
      }
      free = straight<kAlong>(rows, cell, goal, steps, reach);
      free = straight<kUp>(cols, cell, goal, steps, reach) && free;
    }
  }

  const BitGrid &rows_, &cols_;
};

// Directions worth going on in from a cell that was reached by a step of a direction, as bits.
inline unsigned onward_directions(const BitGrid &rows, GridCell cell, int arrival) {
  if (arrival == kFromNowhere) return 0xff;
  const auto bit = [](int direction) { return 1u << (direction & 7); };
  if (arrival & 1) return bit(arrival - 1) | bit(arrival) | bit(arrival + 1);
  const auto blocked = [&](int direction) {
    return rows.blocked(cell.row + kStepRow[direction & 7], cell.col + kStepCol[direction & 7]);
  };
  unsigned onward = bit(arrival);
  if (blocked(arrival + 3) && !blocked(arrival + 2)) onward |= bit(arrival + 1) | bit(arrival + 2);
  if (blocked(arrival - 3) && !blocked(arrival - 2)) onward |= bit(arrival - 1) | bit(arrival - 2);
  return onward;
}

// Start and goal are free and connected. The path is the octile optimum.
inline GridPath jump_search(const BitGrid &rows, const BitGrid &cols, GridCell start, GridCell goal,
                           const SearchLimits &limits, JumpMemory &memory) {
  constexpr std::uint32_t kPoll = 16;  // expansions between two looks at the clock
  const Jumps jumps(rows, cols);
  memory.clear();
  memory.nodes[memory.nodes.insert(start).first].arrival = kFromNowhere;
  memory.open.push({octile_cost(start, goal), 0, 0});
  constexpr std::uint64_t kNone = ~std::uint64_t{0};
  std::uint64_t best = start == goal ? 0 : kNone;  // cost of the cheapest path to the goal so far
  GridPath path;
  for (std::uint32_t expansions = 0; !memory.open.empty(); ++expansions) {
    if (expansions % kPoll == 0) {
      path.status = limits.check();
      if (path.status != SearchStatus::kFound) return path;
    }
    const JumpMemory::Open entry = memory.open.pop();
    const JumpMemory::Node node = memory.nodes[entry.node];
    if (entry.total >= best) break;
    if (node.reached != entry.reached) continue;  // reached more cheaply since
    const auto reach = [&](GridCell cell, std::uint64_t straight, std::uint64_t diagonal, int arrival) {
      const std::uint64_t reached = node.reached + straight * kStraightCost + diagonal * kDiagonalCost;
      const std::uint64_t total = reached + octile_cost(cell, goal);
      if (total >= best) return;
      const auto [index, is_new] = memory.nodes.insert(cell);
      JumpMemory::Node &known = memory.nodes[index];
      if (!is_new && known.reached <= reached) return;
      known = {reached, cell, entry.node, arrival};
      memory.open.push({total, reached, index});
      jumps.prefetch(cell);
      if (cell == goal) best = total;
    };
    jumps.jump(onward_directions(rows, node.at, node.arrival), node.at, goal, entry.total - entry.reached, reach);
  }
  path.status = best == kNone ? SearchStatus::kUnreachable : SearchStatus::kFound;
  if (path.status != SearchStatus::kFound) return path;
  for (std::uint32_t index = memory.nodes.insert(goal).first;; index = memory.nodes[index].parent) {
    const GridCell cell = memory.nodes[index].at;
    if (!path.corners.empty()) {  // a jump goes diagonally first, so backwards it ends so
      const GridCell last = path.corners.back();
      const std::int32_t rows_left = last.row - cell.row, cols_left = last.col - cell.col;
      const std::int32_t diagonal = std::min(std::abs(rows_left), std::abs(cols_left));
      const GridCell corner{cell.row + (rows_left > 0 ? diagonal : -diagonal),
                            cell.col + (cols_left > 0 ? diagonal : -diagonal)};
      if (diagonal > 0 && !(corner == last)) path.add(corner);
    }
    path.add(cell);
    if (cell == start) break;
  }
  std::reverse(path.corners.begin(), path.corners.end());
  return path;
}

}  // namespace trundle
