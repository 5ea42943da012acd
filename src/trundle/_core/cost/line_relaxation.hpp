// Lowers the cost ∫ weight ds of a polyline by moving its vertices sideways, off the cells' centres.
//
// The line is divided into pieces of a few cells, and every vertex may stay or go one step to either side, across the
// line: dynamic programming along the line finds the best choice of all of them at once, with the exact cost of every
// piece. That is repeated while it helps, then with shorter pieces and smaller steps. Staying is always a choice, so
// the cost never rises, and a piece that is blocked costs infinity, so the line stays free. It ends where no such step
// helps: the best line near the one that it began with, not the best of the map.
#pragma once

#include <array>
#include <vector>

#include "cost/line_cost.hpp"

namespace trundle::lines {

// Pieces of `spacing` cells, steps of `offset` cells, at most `passes` times.
struct Level {
  double spacing, offset;
  int passes;
};
inline constexpr Level kLevels[] = {{4.0, 0.4, 2}, {2.0, 0.2, 2}};

// A pass that gains less than this share is the last of its level; a vertex that gains less is left out at the end.
inline constexpr double kWorthwhile = 1e-5;

inline std::vector<Point> divide(const std::vector<Point> &line, double spacing) {
  std::vector<Point> finer{line[0]};
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Point a = line[i - 1], b = line[i];
    const int pieces = std::max(1, static_cast<int>(std::ceil(distance(a, b) / spacing - kOnBorder)));
    for (int k = 1; k < pieces; ++k) {
      const double t = static_cast<double>(k) / pieces;
      finer.push_back({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)});
    }
    finer.push_back(b);
  }
  return finer;
}

// Where vertex b may go: it stays, or moves across the line from a by b to c.
inline std::array<Point, 3> choices(const Point &a, const Point &b, const Point &c, double offset) {
  const double before = std::max(distance(a, b), kOnBorder), after = std::max(distance(b, c), kOnBorder);
  const double along_x = (b.x - a.x) / before + (c.x - b.x) / after;
  const double along_y = (b.y - a.y) / before + (c.y - b.y) / after;
  const double scale = offset / std::max(std::sqrt(along_x * along_x + along_y * along_y), kOnBorder);
  const double across_x = -along_y * scale, across_y = along_x * scale;
  return {b, {b.x + across_x, b.y + across_y}, {b.x - across_x, b.y - across_y}};
}

// Moves the vertices of a line of two pieces or more where that makes it cheaper. Costs of pieces are kept while their ends
// stay.
class MovingLine {
 public:
  MovingLine(const WeightedGrid &grid, std::vector<Point> &line, double offset)
      : grid_(grid), line_(line), offset_(offset), choices_(line.size()), pieces_(line.size()), before_(line.size()),
        moved_(line.size(), 1) {
    choices_.front().fill(line.front());
    choices_.back().fill(line.back());
  }

  // Every vertex stays or moves one step. Returns the cost of the line then.
  double move() {
    const std::size_t last = line_.size() - 1;
    bool was_new = false;  // whether the choices of the vertex before have changed
    std::array<double, kChoices> best{0.0, kInfinity, kInfinity};
    for (std::size_t i = 1; i <= last; ++i) {
      const bool is_new = i < last && (moved_[i - 1] || moved_[i] || moved_[i + 1]);
      if (is_new) choices_[i] = choices(line_[i - 1], line_[i], line_[i + 1], offset_);
      if (is_new || was_new) weigh(i);
      was_new = is_new;
      std::array<double, kChoices> next;
      next.fill(kInfinity);
      for (std::size_t here = 0; here < kChoices; ++here) {
        for (std::size_t there = 0; there < kChoices; ++there) {
          const double cost = best[there] + pieces_[i][here][there];
          if (cost < next[here]) next[here] = cost, before_[i][here] = static_cast<std::uint8_t>(there);
        }
      }
      best = next;
    }
    std::size_t choice = 0;
    for (std::size_t i = last; i > 0; --i) {
      line_[i] = choices_[i][choice];
      moved_[i] = choice != 0;
      choice = before_[i][choice];
    }
    moved_[0] = 0;
    return best[0];
  }

 private:
  static constexpr std::size_t kChoices = 3;

  // Costs of the pieces from the choices of the vertex before to those of a vertex. From one side to the other is left
  // out, and the line's ends have one choice.
  void weigh(std::size_t i) {
    for (std::size_t here = 0; here < kChoices; ++here) {
      for (std::size_t there = 0; there < kChoices; ++there) {
        const bool is_one = !(here + there == 3 || (i == 1 && there > 0) || (i + 1 == line_.size() && here > 0));
        pieces_[i][here][there] =
            is_one ? line_cost(grid_, choices_[i - 1][there], choices_[i][here], kInfinity, 0.0) : kInfinity;
      }
    }
  }

  const WeightedGrid &grid_;
  std::vector<Point> &line_;
  double offset_;
  std::vector<std::array<Point, kChoices>> choices_;
  std::vector<std::array<std::array<double, kChoices>, kChoices>> pieces_;  // by the choice here and the one before
  std::vector<std::array<std::uint8_t, kChoices>> before_;
  std::vector<std::uint8_t> moved_;
};

inline double cost_of(const WeightedGrid &grid, const std::vector<Point> &line) {
  double cost = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) cost += line_cost(grid, line[i - 1], line[i], kInfinity, 0.0);
  return cost;
}

// The line without the vertices that it hardly needs.
inline std::vector<Point> thin(const WeightedGrid &grid, const std::vector<Point> &line, double cheapest) {
  std::vector<Point> kept{line[0]};
  double with = 0.0;  // what the pieces since the last kept vertex cost
  for (std::size_t i = 1; i + 1 < line.size(); ++i) {
    with += line_cost(grid, line[i - 1], line[i], kInfinity, 0.0);
    const double limit = (with + line_cost(grid, line[i], line[i + 1], kInfinity, 0.0)) * (1.0 + kWorthwhile);
    if (line_cost(grid, kept.back(), line[i + 1], limit, cheapest) <= limit) continue;
    kept.push_back(line[i]);
    with = 0.0;
  }
  kept.push_back(line.back());
  return kept;
}

inline double relax_line(const WeightedGrid &grid, std::vector<Point> &line) {
  const double cheapest = cheapest_weight(grid.weights), cost = cost_of(grid, line);
  if (cost == kInfinity) return cost;
  std::vector<Point> moved = line;
  for (const Level &level : kLevels) {
    moved = divide(moved, level.spacing);
    if (moved.size() < 3) continue;
    double last = kInfinity;
    MovingLine moving(grid, moved, level.offset);
    for (int pass = 0; pass < level.passes; ++pass) {
      const double now = moving.move();
      if (!(now < last * (1.0 - kWorthwhile))) break;
      last = now;
    }
  }
  moved = thin(grid, moved, cheapest);
  const double now = cost_of(grid, moved);
  if (!(now < cost)) return cost;
  line = std::move(moved);
  return now;
}

}  // namespace trundle::lines
