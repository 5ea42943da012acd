// The any-angle path of least cost between two points of a grid whose cells have a weight each: ∫ weight ds along its
// lines.
//
// Four steps. (1) A coarse grid gives a lower bound on the cost from anywhere to the goal (block_costs.hpp). (2) A
// wavefront spreads over the cells from the start, where its cost plus that bound is no more than the path costs
// (wavefront.hpp). (3) The path descends the wavefront's costs from the goal (descent.hpp). (4) Its vertices move to
// where the exact integral is less (line_relaxation.hpp).
//
// The result is not the exact optimum: the wavefront's costs are those of its triangles, and where the coarse grid
// overestimates the cheapest path by more than the margin, that path is missed.
#pragma once

#include <tuple>

#include "cost/block_costs.hpp"
#include "cost/descent.hpp"
#include "cost/line_relaxation.hpp"

namespace trundle {

struct LeastCostPath {
  SearchStatus status = SearchStatus::kUnreachable;
  std::vector<lines::Point> line;
  double cost = 0.0;
};

// Kept from one search to the next.
struct LeastCostMemory {
  BlockCosts blocks;
  Wavefront<float> wavefront;
  Wavefront<double> fine_wavefront;
  std::size_t bytes() const { return blocks.bytes() + wavefront.bytes() + fine_wavefront.bytes(); }
};

class LeastCostSearch {
 public:
  using Point = lines::Point;

  // A cell that is open, and a point in it.
  struct End {
    GridCell cell;
    Point point;
    auto order() const { return std::make_tuple(cell.row, cell.col, point.y, point.x); }
  };

  LeastCostSearch(const lines::WeightedGrid &grid, const SearchLimits &limits, LeastCostMemory &memory)
      : grid_(grid), limits_(limits), memory_(memory) {
    map_ = {grid.costs, grid.rows, grid.cols, {}, kFar, true};
    for (int cost = 0; cost < 256; ++cost) {
      const float weight = grid.weights[cost] > 0.0 ? static_cast<float>(grid.weights[cost]) : kFar;
      map_.quarter[cost] = weight / 4;
      map_.least = std::min(map_.least, weight);
      map_.rising = map_.rising && (cost == 0 || map_.quarter[cost] >= map_.quarter[cost - 1]);
    }
  }

  LeastCostPath find(const End &start, const End &goal) {
    LeastCostPath path;
    path.status = start.cell == goal.cell ? SearchStatus::kFound : search(start, goal);
    if (path.status != SearchStatus::kFound) return path;
    path.line = joined(start.point, goal.point);
    path.cost = lines::relax_line(grid_, path.line);
    // Where weights jump from cell to cell, triangles underestimate: there the best path by centres may be cheaper.
    const double to_centres = cost_to_centre(start) + cost_to_centre(goal);
    if (start.cell == goal.cell || path.cost <= cost_ * kTrusted + to_centres) return path;
    interpolate_ = false;
    path.status = propagate(memory_.fine_wavefront, start.cell, goal.cell);
    if (path.status != SearchStatus::kFound) return path;
    std::vector<Point> other = joined(start.point, goal.point);
    const double cost = lines::relax_line(grid_, other);
    if (cost < path.cost) path.line = std::move(other), path.cost = cost;
    return path;
  }

 private:
  static constexpr float kFar = std::numeric_limits<float>::infinity();
  static constexpr float kMargin = 1.01f;       // by which the coarse grid's cheapest path may be exceeded at first
  static constexpr float kWider = 1.1f;         // by which the bound grows while what is deferred may be cheaper
  static constexpr float kMostSteps = 1 << 18;  // of the least weight, which `float` adds up well enough
  static constexpr int kLeaveOut = 1;           // points of the descent between two that are kept
  static constexpr double kTrusted = 1.001;     // times the wavefront's cost: a path that costs more is not trusted

  double cost_to_centre(const End &end) const {
    return lines::distance(end.point, {end.cell.col + 0.5, end.cell.row + 0.5}) *
           grid_.weight(end.cell.row, end.cell.col);
  }

  // Finds points from the start to the goal.
  SearchStatus search(const End &start, const End &goal) {
    memory_.blocks.begin(map_, start.point, goal.point);
    const SearchStatus status = memory_.blocks.find_estimate(limits_);
    if (status != SearchStatus::kFound) return status;
    const float estimate = memory_.blocks.estimate();
    if (!(estimate < kFar)) return SearchStatus::kUnreachable;
    return estimate < kMostSteps * map_.least ? propagate(memory_.wavefront, start.cell, goal.cell)
                                              : propagate(memory_.fine_wavefront, start.cell, goal.cell);
  }

  // Spreads a wavefront from the start to the goal, and descends it. Tiles that no path within a bound leads through
  // are deferred; the bound is raised until no path that is left can be cheaper.
  template <typename Real>
  SearchStatus propagate(Wavefront<Real> &wavefront, GridCell start, GridCell goal) {
    const auto load = [&](std::int64_t row, std::int64_t col, Real *quarters) { load_tile(row, col, quarters); };
    BlockCosts &blocks = memory_.blocks;
    float bound = blocks.estimate() * kMargin + map_.least;
    const auto rank = [&](std::int64_t row, std::int64_t col, Real cost) {
      return cost + blocks.from_tile(row, col) <= bound ? cost : Wavefront<Real>::kFar;
    };
    SearchStatus status = blocks.find_within(bound, limits_);
    if (status != SearchStatus::kFound) return status;
    wavefront.begin(grid_.rows, grid_.cols, static_cast<Real>(map_.least), interpolate_);
    wavefront.make_ready(start.row, start.col, load);
    wavefront.make_ready(goal.row, goal.col, load);
    wavefront.seed(start.row, start.col, Real(0), rank);
    while (true) {
      const auto done = [&](Real cost) { return cost >= wavefront.cost(goal.row, goal.col); };
      status = wavefront.propagate(load, rank, done, limits_);
      if (status != SearchStatus::kFound) return status;
      cost_ = static_cast<float>(wavefront.cost(goal.row, goal.col));
      if (cost_ <= bound || !wavefront.has_deferred()) break;
      // What is deferred may be cheaper than what was found.
      bound = std::min(cost_, bound * kWider);
      status = blocks.find_within(bound, limits_);
      if (status != SearchStatus::kFound) return status;
      wavefront.retry_deferred(rank);
    }
    if (!(cost_ < kFar)) return SearchStatus::kUnreachable;
    centres_ = Descent<Real>(wavefront, grid_).trace(goal, start);
    std::reverse(centres_.begin(), centres_.end());
    return status;
  }

  // Quarters of the weights of 8 × 8 cells.
  template <typename Real>
  void load_tile(std::int64_t row, std::int64_t col, Real *quarters) const {
    constexpr std::int64_t kSide = Wavefront<Real>::kSide;
    const bool outside = row < 0 || col < 0;
    const std::int64_t rows = outside ? 0 : std::clamp<std::int64_t>(grid_.rows - row, 0, kSide);
    const std::int64_t cols = outside ? 0 : std::clamp<std::int64_t>(grid_.cols - col, 0, kSide);
    if (rows < kSide || cols < kSide) std::fill_n(quarters, Wavefront<Real>::kCells, Wavefront<Real>::kFar);
    if (cols == 0) return;
    const std::uint8_t *costs = grid_.costs + row * grid_.cols + col;
    for (std::int64_t r = 0; r < rows; ++r, costs += grid_.cols, quarters += kSide) {
      for (std::int64_t c = 0; c < cols; ++c) quarters[c] = static_cast<Real>(map_.quarter[costs[c]]);
    }
  }

  // The line from the start to the goal through some of the points between, and more of them where something blocks it.
  std::vector<Point> joined(Point start, Point goal) const {
    std::vector<Point> line{start};
    int left_out = 0;
    for (std::size_t i = 0; i < centres_.size(); ++i) {
      const Point next = i + 1 < centres_.size() ? centres_[i + 1] : goal;
      if (interpolate_ && left_out < kLeaveOut && lines::line_cost(grid_, line.back(), next, lines::kInfinity, 0.0) < lines::kInfinity) {
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
  const SearchLimits &limits_;
  LeastCostMemory &memory_;
  CostMap map_;
  bool interpolate_ = true;
  float cost_ = kFar;
  std::vector<Point> centres_;
};

}  // namespace trundle
