// The shortest any-angle path of a point between the centres of two cells: D. Harabor, A. Grastien, D. Öz, V.
// Aksakalli, "Optimal Any-Angle Pathfinding In Practice" (2016), Anya. The point may touch blocked cells, and never
// passes between two that touch at a corner.
//
// Points are (x, y) in half cells: the corners of cells have even numbers, their centres odd ones. A line of the grid
// is the border of two rows. A node is a cone: what a root, the start or a corner that the path turns at, sees of a
// line between two rays. It is projected from line to line through the free runs of the rows, and where it meets a
// corner that a shortest path can turn at, the corner becomes a root.
//
// Which ray passes a corner is decided exactly: a ray leads from its root through a corner of whole numbers, (dx, dy).
// It meets a line at x = root + dx · n / dy. With w cells across and h up, dx · n and x · dy are at most 4 w h < 2^35,
// so that the product is exact in a double, and the rounding of quotient and sum, at most 2^-52 · 2^35 / dy, is less
// than 1 / dy, by which x differs from a whole number that it does not equal. So x compares with whole numbers as if
// it were exact. Lengths are sums of square roots and good to about 1e-15 of themselves for each part.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "grid/bit_grid.hpp"
#include "grid/point_nodes.hpp"
#include "grid/row_scans.hpp"
#include "shared/grid_steps.hpp"
#include "shared/open_list.hpp"

namespace trundle {

class AnyAngleMemory {
 public:
  struct Ray {
    std::int32_t x, y;  // from the root
  };
  enum class Kind : std::uint8_t {
    kCone,
    kOver,   // a corner: between the path straight on and the line, over the blocked cell that was passed
    kPast,   // a corner: between the path straight on and the direction ahead, past the blocked cell in front
    kAlong,  // a corner at the end of a path along a line: between the line and the direction across it
  };
  struct Node {
    double left, right;  // of a cone, in half cells
    Ray left_ray, right_ray;
    std::uint32_t root;
    std::int32_t line;
    std::int8_t ahead;  // 1 towards higher rows, -1 towards lower ones
    std::int8_t side;   // of a corner: -1 towards lower columns, 1 towards higher ones
    Kind kind;
  };

  PointNodes roots;
  std::vector<Node> nodes;
  std::vector<std::uint32_t> spare;  // free slots of `nodes`
  OpenList<OpenPoint> open;

  void clear() {
    roots.clear();
    nodes.clear();
    spare.clear();
    open.clear();
  }
  std::size_t bytes() const {
    return roots.bytes() + nodes.capacity() * sizeof(Node) + spare.capacity() * sizeof(std::uint32_t) +
           open.bytes();
  }
};

class AnyAngleSearch {
 public:
  // Cells of the grid with its border; both are free and joined.
  AnyAngleSearch(const BitGrid &grid, GridCell start, GridCell goal, AnyAngleMemory &memory)
      : grid_(grid), goal_(goal), start_(start), target_{2 * goal.col + 1, 2 * goal.row + 1}, memory_(memory) {}

  PointPath run(const SearchLimits &limits) {
    constexpr std::uint32_t kPoll = 64;  // expansions between two looks at the clock
    memory_.clear();
    const std::uint32_t start = memory_.roots.reach({2 * start_.col + 1, 2 * start_.row + 1}, 0.0, 0);
    const Run own = run_of(start_.row, start_.col);
    carry_on(start, start_.row, 1, own, {-1, 0}, {1, 0});
    carry_on(start, start_.row + 1, -1, own, {-1, 0}, {1, 0});
    PointPath path;
    for (std::uint32_t expansions = 0; next(); ++expansions) {
      if (expansions % kPoll == 0) {
        path.status = limits.check();
        if (path.status != SearchStatus::kFound) return path;
      }
      const Node node = memory_.nodes[taken_];
      memory_.spare.push_back(taken_);
      if (memory_.roots.superseded(node.root)) continue;
      if (node.kind == Kind::kCone) {
        expand(node);
      } else {
        expand_corner(node);
      }
    }
    path.status = best_ < kNever ? SearchStatus::kFound : SearchStatus::kUnreachable;
    if (path.status == SearchStatus::kFound) memory_.roots.trace(best_root_, target_, path);
    return path;
  }

 private:
  using Node = AnyAngleMemory::Node;
  using Kind = AnyAngleMemory::Kind;
  using Ray = AnyAngleMemory::Ray;
  struct Run {
    std::int32_t begin, end;  // columns
  };
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  bool blocked(std::int32_t row, std::int32_t col) const { return grid_.blocked(row, col); }
  Run run_of(std::int32_t row, std::int32_t col) const {
    return {last_blocked(grid_, row, col) + 1, next_blocked(grid_, row, col)};
  }
  static std::int32_t row_ahead(const Node &node) { return node.ahead > 0 ? node.line : node.line - 1; }
  static std::int64_t cross(Ray a, Ray b) { return std::int64_t{a.x} * b.y - std::int64_t{a.y} * b.x; }

  // Takes a node of the smallest total, unless that is no less than the best path to the goal. The cheapest node that
  // the last one led to is held outside the heap: often it is next. A cone that is the only successor of another is
  // expanded next even if it costs up to 8 cells more: measured, that saves a third of the time, as in Anya's
  // intermediate pruning.
  bool next() {
    constexpr double kOnward = 16.0;
    OpenList<OpenPoint> &open = memory_.open;
    const bool onward = led_to_ == 1 && held_cone_;
    led_to_ = 0;
    if (held_ != kNone) {
      taken_ = held_;
      held_ = kNone;
      if (held_total_ < best_ && (open.empty() || held_total_ <= open.top().total + (onward ? kOnward : 0.0))) {
        return true;
      }
      open.push({held_total_, taken_});
    }
    if (open.empty()) return false;
    const OpenPoint top = open.pop();
    taken_ = top.node;
    return top.total < best_;
  }

  void push(double total, const Node &node) {
    if (total >= best_) return;
    ++led_to_;
    std::uint32_t slot;
    if (memory_.spare.empty()) {
      slot = static_cast<std::uint32_t>(memory_.nodes.size());
      memory_.nodes.push_back(node);
    } else {
      slot = memory_.spare.back();
      memory_.spare.pop_back();
      memory_.nodes[slot] = node;
    }
    if (held_ == kNone) {
      held_ = slot;
      held_total_ = total;
      held_cone_ = node.kind == Kind::kCone;
      return;
    }
    if (total < held_total_) {
      std::swap(held_, slot);
      std::swap(held_total_, total);
    }
    memory_.open.push({total, slot});
  }

  // Projects a root's cone between two rays from a line through a run of the row ahead, to the next line. A ray along the
  // line bounds nothing but the goal.
  void carry_on(std::uint32_t root, std::int32_t line, int ahead, Run run, Ray left_ray, Ray right_ray) {
    const PointNodes::Node &from = memory_.roots[root];
    const std::int32_t row = ahead > 0 ? line : line - 1;
    if (row == goal_.row && run.begin <= goal_.col && goal_.col < run.end) {
      const Ray to_goal{target_.x - from.at.x, target_.y - from.at.y};
      if (cross(left_ray, to_goal) * ahead <= 0 && cross(right_ray, to_goal) * ahead >= 0) {
        const double total = from.reached + length(to_goal.x, to_goal.y);
        if (total < best_) {
          best_ = total;
          best_root_ = root;
        }
      }
    }
    const std::int32_t rise = 2 * (line + ahead) - from.at.y;
    double left = 2.0 * run.begin, right = 2.0 * run.end;
    const double left_hit = left_ray.y == 0 ? -kNever : meet(from.at.x, left_ray, rise);
    const double right_hit = right_ray.y == 0 ? kNever : meet(from.at.x, right_ray, rise);
    if (left_hit < left) {
      left_ray = {2 * run.begin - from.at.x, rise};
    } else {
      left = left_hit;
    }
    if (right_hit > right) {
      right_ray = {2 * run.end - from.at.x, rise};
    } else {
      right = right_hit;
    }
    if (!(left < right)) return;  // what a single point sees, the corner that it touched sees as well
    const double up = std::abs(rise), down = std::abs(target_.y - 2 * (line + ahead));
    const double straight = from.at.x + (target_.x - from.at.x) * up / (up + down);
    const double through = std::min(std::max(straight, left), right);
    const double total = from.reached + length(through - from.at.x, up) + length(target_.x - through, down);
    push(total, {left, right, left_ray, right_ray, root, line + ahead, static_cast<std::int8_t>(ahead), 0, Kind::kCone});
  }

  static double length(double x, double y) { return std::sqrt(x * x + y * y); }
  static double meet(std::int32_t x, Ray ray, std::int32_t rise) {
    return x + static_cast<double>(ray.x) * static_cast<double>(rise) / static_cast<double>(ray.y);
  }

  void expand(const Node &node) {
    const std::int32_t row = row_ahead(node);
    const auto first = static_cast<std::int32_t>(std::floor(node.left / 2.0));
    const auto last = static_cast<std::int32_t>(std::ceil(node.right / 2.0)) - 1;
    if (node.left == 2.0 * first) meet_end(node, first, -1);
    for (std::int32_t col = first; col <= last;) {
      if (blocked(row, col)) {
        col = next_free(grid_, row, col, last + 1);
        if (col <= last) pass(node, col, 1);
        continue;
      }
      const Run run{col == first ? last_blocked(grid_, row, col) + 1 : col, next_blocked(grid_, row, col)};
      // Rays through the ends of the run on this line, where it is narrower than the cone.
      const PointNodes::Node &from = memory_.roots[node.root];
      const std::int32_t rise = 2 * node.line - from.at.y;
      const Ray left = 2.0 * run.begin > node.left ? Ray{2 * run.begin - from.at.x, rise} : node.left_ray;
      const Ray right = 2.0 * run.end < node.right ? Ray{2 * run.end - from.at.x, rise} : node.right_ray;
      carry_on(node.root, node.line, node.ahead, run, left, right);
      if (2.0 * run.end < node.right) pass(node, run.end, -1);
      col = run.end;
    }
    if (node.right == 2.0 * (last + 1)) meet_end(node, last + 1, 1);
  }

  // The cone's end on a line is a corner of cells.
  void meet_end(const Node &node, std::int32_t col, int side) {
    const std::int32_t row = row_ahead(node), behind = row - node.ahead;
    const bool left = blocked(row, col - 1), right = blocked(row, col);
    if (blocked(behind, side < 0 ? col - 1 : col)) {
      if (!left && !right) add_root(node.root, {2 * col, 2 * node.line}, node.ahead, side, Kind::kOver);
    } else if (left != right) {
      pass(node, col, left ? 1 : -1);
    }
  }

  // A blocked cell of the row ahead ends at a column, and the cell on this side of it is free.
  void pass(const Node &node, std::int32_t col, int side) {
    const std::int32_t along = 2 * col - memory_.roots[node.root].at.x;
    if (side > 0 ? along > 0 : along < 0) add_root(node.root, {2 * col, 2 * node.line}, node.ahead, side, Kind::kPast);
  }

  void add_root(std::uint32_t parent, HalfCell at, int ahead, int side, Kind kind) {
    const PointNodes::Node &from = memory_.roots[parent];
    const double reached = from.reached + length(at.x - from.at.x, at.y - from.at.y);
    const double total = reached + length(target_.x - at.x, target_.y - at.y);
    if (total >= best_) return;
    const std::uint32_t root = memory_.roots.reach(at, reached, parent);
    if (root == PointNodes::kSuperseded) return;
    push(total, {0.0, 0.0, {0, 0}, {0, 0}, root, at.y / 2, static_cast<std::int8_t>(ahead),
                 static_cast<std::int8_t>(side), kind});
  }

  // Projects the cone that a corner sees and the root before it does not.
  void expand_corner(const Node &node) {
    const PointNodes::Node &root = memory_.roots[node.root];
    const HalfCell before = memory_.roots[root.parent].at;
    const Ray on{root.at.x - before.x, root.at.y - before.y}, level{node.side, 0}, up{0, node.ahead};
    const std::int32_t col = root.at.x / 2, beside = node.side < 0 ? col - 1 : col;
    const Ray outer = node.kind == Kind::kAlong ? up : on, inner = node.kind == Kind::kPast ? up : level;
    // The blocked cell is beside the inner ray; past one in front it is on the other side.
    const bool inner_is_left = (node.kind == Kind::kPast) == (node.side > 0);
    const Run run = run_of(row_ahead(node), beside);
    const std::uint32_t index = node.root;
    carry_on(index, node.line, node.ahead, run, inner_is_left ? inner : outer, inner_is_left ? outer : inner);
    if (node.kind != Kind::kPast) follow_line(index, col, node.line, node.side);
  }

  // From a corner along a line to the next corner where a path can turn.
  void follow_line(std::uint32_t root, std::int32_t col, std::int32_t line, int side) {
    const std::int32_t beside = side < 0 ? col - 1 : col;
    if (blocked(line, beside) && blocked(line - 1, beside)) return;
    const std::int32_t stop = next_turn(grid_, line, beside, side);
    if (blocked(line, stop) || blocked(line - 1, stop)) return;  // closed, or between two blocks
    const int ahead = blocked(line, stop - side) ? 1 : -1;
    add_root(root, {2 * (side < 0 ? stop + 1 : stop), 2 * line}, ahead, side, Kind::kAlong);
  }

  const BitGrid &grid_;
  const GridCell goal_, start_;
  const HalfCell target_;
  AnyAngleMemory &memory_;
  double best_ = kNever, held_total_ = 0.0;
  std::uint32_t best_root_ = 0, held_ = kNone, taken_ = kNone;
  int led_to_ = 0;  // nodes that the last one led to
  bool held_cone_ = false;
};

}  // namespace trundle
