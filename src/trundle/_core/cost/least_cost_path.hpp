// The cheapest way between two points of a grid whose cells have a weight each: ∫ weight ds along straight lines.
//
// What it costs at least to the goal, found on a coarse grid; a front over the cells from the start to the goal, where the
// sum of both is no more than the way costs; the way down its costs; and the vertices moved to where the exact integral is
// less. It is not the exact optimum: the front's costs are those of its triangles, and where the coarse grid takes the
// cheapest way for dearer than one that is found, it is missed.
#pragma once

#include <tuple>

#include "cost/block_costs.hpp"
#include "cost/descent.hpp"
#include "cost/line_relaxation.hpp"

namespace trundle {

struct CostWay {
  SearchStatus status = SearchStatus::kUnreachable;
  std::vector<lines::Point> line;
  double cost = 0.0;
};

// Kept from one search to the next.
struct CostWayMemory {
  BlockCosts blocks;
  FrontField<float> field;
  FrontField<double> fine_field;
  std::size_t bytes() const { return blocks.bytes() + field.bytes() + fine_field.bytes(); }
};

class CostWaySearch {
 public:
  using Point = lines::Point;

  // A cell that is open, and a point in it.
  struct End {
    GridCell cell;
    Point point;
    auto order() const { return std::make_tuple(cell.row, cell.col, point.y, point.x); }
  };

  CostWaySearch(const lines::WeightedGrid &grid, const Patience &patience, CostWayMemory &memory)
      : grid_(grid), patience_(patience), memory_(memory) {
    map_ = {grid.costs, grid.rows, grid.cols, {}, kFar, true};
    for (int cost = 0; cost < 256; ++cost) {
      const float weight = grid.weights[cost] > 0.0 ? static_cast<float>(grid.weights[cost]) : kFar;
      map_.quarter[cost] = weight / 4;
      map_.least = std::min(map_.least, weight);
      map_.rising = map_.rising && (cost == 0 || map_.quarter[cost] >= map_.quarter[cost - 1]);
    }
  }

  CostWay find(const End &start, const End &goal) {
    CostWay way;
    way.status = start.cell == goal.cell ? SearchStatus::kFound : search(start, goal);
    if (way.status != SearchStatus::kFound) return way;
    way.line = joined(start.point, goal.point);
    way.cost = lines::relax_line(grid_, way.line);
    // Where weights jump from cell to cell triangles promise too much: there the best way by centres may be cheaper.
    const double to_centres = cost_to_centre(start) + cost_to_centre(goal);
    if (start.cell == goal.cell || way.cost <= cost_ * kTrusted + to_centres) return way;
    between_ = false;
    way.status = spread(memory_.fine_field, start.cell, goal.cell);
    if (way.status != SearchStatus::kFound) return way;
    std::vector<Point> other = joined(start.point, goal.point);
    const double cost = lines::relax_line(grid_, other);
    if (cost < way.cost) way.line = std::move(other), way.cost = cost;
    return way;
  }

 private:
  static constexpr float kFar = std::numeric_limits<float>::infinity();
  static constexpr float kMargin = 1.01f;       // of the coarse grid's cheapest way
  static constexpr float kWider = 1.1f;         // how much dearer the ways may be that are looked at next
  static constexpr float kMostSteps = 1 << 18;  // as many of the least weight can be counted in `float`
  static constexpr int kLeaveOut = 1;           // points of the way down between two that are kept
  static constexpr double kTrusted = 1.001;     // of what the front's way costs

  double cost_to_centre(const End &end) const {
    return lines::distance(end.point, {end.cell.col + 0.5, end.cell.row + 0.5}) *
           grid_.weight(end.cell.row, end.cell.col);
  }

  // Finds points from the start to the goal.
  SearchStatus search(const End &start, const End &goal) {
    memory_.blocks.begin(map_, start.point, goal.point);
    const SearchStatus status = memory_.blocks.reach(patience_);
    if (status != SearchStatus::kFound) return status;
    const float estimate = memory_.blocks.estimate();
    if (!(estimate < kFar)) return SearchStatus::kUnreachable;
    return estimate < kMostSteps * map_.least ? spread(memory_.field, start.cell, goal.cell)
                                              : spread(memory_.fine_field, start.cell, goal.cell);
  }

  // The way over the cells, and what it costs by the front.
  template <typename Real>
  SearchStatus spread(FrontField<Real> &field, GridCell start, GridCell goal) {
    const auto fill = [&](std::int64_t row, std::int64_t col, Real *quarters) { fill_square(row, col, quarters); };
    BlockCosts &blocks = memory_.blocks;
    // Ways that cost more by what is known wait.
    float bound = blocks.estimate() * kMargin + map_.least;
    const auto order = [&](std::int64_t row, std::int64_t col, Real cost) {
      return cost + blocks.from_square(row, col) <= bound ? cost : FrontField<Real>::kFar;
    };
    SearchStatus status = blocks.reach(bound, patience_);
    if (status != SearchStatus::kFound) return status;
    field.begin(grid_.rows, grid_.cols, static_cast<Real>(map_.least), between_);
    field.make_ready(start.row, start.col, fill);
    field.make_ready(goal.row, goal.col, fill);
    field.seed(start.row, start.col, Real(0), order);
    while (true) {
      const auto done = [&](Real cost) { return cost >= field.cost(goal.row, goal.col); };
      status = field.spread(fill, order, done, patience_);
      if (status != SearchStatus::kFound) return status;
      cost_ = static_cast<float>(field.cost(goal.row, goal.col));
      if (cost_ <= bound || !field.holds()) break;
      // What waits may be cheaper than what was found.
      bound = std::min(cost_, bound * kWider);
      status = blocks.reach(bound, patience_);
      if (status != SearchStatus::kFound) return status;
      field.release(order);
    }
    if (!(cost_ < kFar)) return SearchStatus::kUnreachable;
    centres_ = Descent<Real>(field, grid_).trace(goal, start);
    std::reverse(centres_.begin(), centres_.end());
    return status;
  }

  // Quarters of the weights of 8 × 8 cells.
  template <typename Real>
  void fill_square(std::int64_t row, std::int64_t col, Real *quarters) const {
    constexpr std::int64_t kSide = FrontField<Real>::kSide;
    const bool outside = row < 0 || col < 0;
    const std::int64_t rows = outside ? 0 : std::clamp<std::int64_t>(grid_.rows - row, 0, kSide);
    const std::int64_t cols = outside ? 0 : std::clamp<std::int64_t>(grid_.cols - col, 0, kSide);
    if (rows < kSide || cols < kSide) std::fill_n(quarters, FrontField<Real>::kCells, FrontField<Real>::kFar);
    if (cols == 0) return;
    const std::uint8_t *costs = grid_.costs + row * grid_.cols + col;
    for (std::int64_t r = 0; r < rows; ++r, costs += grid_.cols, quarters += kSide) {
      for (std::int64_t c = 0; c < cols; ++c) quarters[c] = static_cast<Real>(map_.quarter[costs[c]]);
    }
  }

  // From the start to the goal by some of the points between, and by more where something is in the way.
  std::vector<Point> joined(Point start, Point goal) const {
    std::vector<Point> line{start};
    int left_out = 0;
    for (std::size_t i = 0; i < centres_.size(); ++i) {
      const Point next = i + 1 < centres_.size() ? centres_[i + 1] : goal;
      if (between_ && left_out < kLeaveOut && lines::line_cost(grid_, line.back(), next, lines::kInfinity, 0.0) < lines::kInfinity) {
        ++left_out;
        continue;
      }
      line.push_back(centres_[i]);
      left_out = 0;
    }
    line.push_back(goal);
    return line;
  }

  const lines::WeightedGrid &grid_;
  const Patience &patience_;
  CostWayMemory &memory_;
  CostMap map_;
  bool between_ = true;
  float cost_ = kFar;
  std::vector<Point> centres_;
};

}  // namespace trundle
