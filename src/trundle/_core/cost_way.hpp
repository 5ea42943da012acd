// The cheapest way between two points of a grid whose cells have a weight each: ∫ weight ds along straight lines.
//
// A corridor found on a coarse grid; a front over its cells from the start to the goal; the way down its costs; and the
// vertices moved to where the exact integral is less. It is not the exact optimum: the front's costs are those of its
// triangles, and where the coarse grid takes the cheapest way for dearer than one that is found, it is missed.
#pragma once

#include <tuple>

#include "cost_corridor.hpp"
#include "descent.hpp"
#include "line_relaxation.hpp"

namespace trundle {

struct CostWay {
  SearchStatus status = SearchStatus::kUnreachable;
  std::vector<lines::Point> line;
  double cost = 0.0;
};

// Kept from one search to the next.
struct CostWayMemory {
  CostCorridor corridor;
  FanField<float> field;
  FanField<double> fine_field;
  std::size_t bytes() const { return corridor.bytes() + field.bytes() + fine_field.bytes(); }
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
    map_ = {grid.costs, grid.rows, grid.cols, {}, kFar, 0.0f};
    for (int cost = 0; cost < 256; ++cost) {
      const auto weight = static_cast<float>(grid.weights[cost]);
      map_.weight[cost] = weight > 0.0f ? weight : kFar;
      if (weight > 0.0f) map_.least = std::min(map_.least, weight), map_.dearest = std::max(map_.dearest, weight);
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
  static constexpr int kBlock = 4;              // cells along a block of the coarse grid
  static constexpr float kMargin = 1.005f;      // of the coarse grid's cheapest way
  static constexpr float kMostSteps = 1 << 18;  // as many of the least weight can be counted in `float`
  static constexpr int kLeaveOut = 3;           // points of the way down between two that are kept
  static constexpr double kTrusted = 1.001;     // of what the front's way costs

  double cost_to_centre(const End &end) const {
    return lines::distance(end.point, {end.cell.col + 0.5, end.cell.row + 0.5}) *
           grid_.weight(end.cell.row, end.cell.col);
  }

  // Finds the centres from the start to the goal.
  SearchStatus search(const End &start, const End &goal) {
    CostCorridor &corridor = memory_.corridor;
    float bound = 0.0f;
    // Where blocks hide that a way is closed, smaller ones show it.
    for (block_ = kBlock; block_ > 1; block_ /= 2) {
      corridor.begin(map_, block_, start.point, goal.point);
      SearchStatus status = corridor.reach(patience_);
      if (status != SearchStatus::kFound) return status;
      if (!(corridor.estimate() < kFar)) return SearchStatus::kUnreachable;
      bound = std::max(bound, corridor.estimate() * kMargin);
      status = spread_within(bound, start.cell, goal.cell);
      if (status != SearchStatus::kFound || cost_ <= bound) return status;
      // A way dearer than the corridor was made for may not be the cheapest: look at all that may be cheaper.
      if (cost_ < kFar) return spread_within(cost_, start.cell, goal.cell);
    }
    const SearchStatus status = spread(memory_.fine_field, start.cell, goal.cell);
    return status != SearchStatus::kFound || cost_ < kFar ? status : SearchStatus::kUnreachable;
  }

  SearchStatus spread_within(float bound, GridCell start, GridCell goal) {
    const SearchStatus status = memory_.corridor.widen(bound, patience_);
    if (status != SearchStatus::kFound) return status;
    return bound < kMostSteps * map_.least ? spread(memory_.field, start, goal)
                                           : spread(memory_.fine_field, start, goal);
  }

  // The way over the cells of the corridor, and what it costs by the front.
  template <typename Real>
  SearchStatus spread(FanField<Real> &field, GridCell start, GridCell goal) {
    using Cell = typename FanField<Real>::Cell;
    const auto fill = [&](std::int64_t row, std::int64_t col, Cell *cells, std::int64_t stride) {
      fill_square<Real>(row, col, cells, stride);
    };
    field.begin(grid_.rows, grid_.cols, static_cast<Real>(map_.least), static_cast<Real>(map_.dearest), between_);
    field.make_ready(start.row, start.col, fill);
    field.make_ready(goal.row, goal.col, fill);
    field.seed(start.row, start.col, Real(0));
    const std::int64_t target = field.at(goal.row, goal.col);
    const SearchStatus status = field.spread(
        fill, [](std::int64_t, Real) { return true; }, [&](Real reached) { return reached > field.cost(target); },
        patience_);
    cost_ = static_cast<float>(field.cost(target));
    if (status != SearchStatus::kFound || !(cost_ < kFar)) return status;
    centres_ = Descent<Real>(field, grid_).trace(goal, start);
    std::reverse(centres_.begin(), centres_.end());
    return status;
  }

  // Weights of 8 × 8 cells, closed outside the corridor. With blocks of one cell there is none.
  template <typename Real>
  void fill_square(std::int64_t row, std::int64_t col, typename FanField<Real>::Cell *cells, std::int64_t stride) {
    constexpr std::int64_t kSquare = FanField<Real>::kSquare;
    const std::int64_t step = block_ > 1 ? block_ : kSquare;
    for (std::int64_t r = row; r < row + kSquare; r += step) {
      for (std::int64_t c = col; c < col + kSquare; c += step) {
        const bool wanted = r >= 0 && c >= 0 && (block_ == 1 || memory_.corridor.contains(r / block_, c / block_));
        for (std::int64_t k = 0; k < step; ++k) {
          auto *to = cells + (r - row + k) * stride + (c - col);
          const std::int64_t width =
              wanted && r + k < grid_.rows ? std::clamp<std::int64_t>(grid_.cols - c, 0, step) : 0;
          const std::uint8_t *costs = width > 0 ? grid_.costs + (r + k) * grid_.cols + c : nullptr;
          for (std::int64_t n = 0; n < width; ++n) {
            to[n] = {FanField<Real>::kFar, static_cast<Real>(map_.weight[costs[n]])};
          }
          for (std::int64_t n = width; n < step; ++n) to[n] = {FanField<Real>::kFar, FanField<Real>::kFar};
        }
      }
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
  int block_ = kBlock;
  bool between_ = true;
  float cost_ = kFar;
  std::vector<Point> centres_;
};

}  // namespace trundle
