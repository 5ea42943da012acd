// How long a way is at least, by the distances from a few landmarks: A. Goldberg, C. Harrelson, "Computing the Shortest
// Path: A* Search Meets Graph Theory" (2005). Of a cell only its block of 16 x 16 cells is known, by the least and the
// largest distance in it, so that a landmark takes 4 bytes a block.
//
// A bound holds on the map that was measured, and on any map with less free space, where ways are longer.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "grid/bit_grid.hpp"
#include "grid/free_runs.hpp"
#include "shared/grid_steps.hpp"

namespace trundle {

// The least that a way on a free map costs.
struct OctileEstimate {
  GridCell goal;
  std::uint64_t operator()(GridCell cell) const { return octile_cost(cell.row - goal.row, cell.col - goal.col); }
};

class Landmarks {
 public:
  // Room for so many; cells count the border.
  Landmarks(const BitGrid &grid, std::size_t count)
      : count_(count),
        across_((grid.cols() >> kShift) + 1),
        spans_(static_cast<std::size_t>((grid.rows() >> kShift) + 1) * static_cast<std::size_t>(across_) * count) {}

  const std::vector<GridCell> &cells() const { return cells_; }
  bool full() const { return cells_.size() == count_; }
  std::size_t bytes() const {
    return spans_.capacity() * sizeof(Span) + (measured_on_ ? measured_on_->bytes() : 0);
  }

  // Takes in a landmark and the way in cells from it to each cell of the map, without the border: infinite where there
  // is none, and right to 1e-6.
  void add(GridCell landmark, const float *lengths, std::int64_t rows, std::int64_t cols) {
    constexpr double kEndless = 1e12, kWrong = 1e-6, kMost = 65534.0;
    const std::size_t own = cells_.size();
    double longest = 1.0;
    for (std::int64_t i = 0; i < rows * cols; ++i) {
      if (lengths[i] < kEndless) longest = std::max<double>(longest, lengths[i]);
    }
    const double unit = longest * (1.0 + kWrong) / kMost;
    for (std::size_t i = own; i < spans_.size(); i += count_) spans_[i] = {0xffff, 0};
    for (std::int64_t row = 0; row < rows; ++row) {
      for (std::int64_t col = 0; col < cols; ++col, ++lengths) {
        if (!(*lengths < kEndless)) continue;
        const double length = std::max<double>(*lengths, 0.0);
        Span &span = spans_[index({static_cast<std::int32_t>(row + 1), static_cast<std::int32_t>(col + 1)}) + own];
        span.least = std::min(span.least, static_cast<std::uint16_t>(length * (1.0 - kWrong) / unit));
        span.most = std::max(span.most, static_cast<std::uint16_t>(std::ceil(length * (1.0 + kWrong) / unit)));
      }
    }
    for (std::size_t i = own; i < spans_.size(); i += count_) {
      if (spans_[i].least > spans_[i].most) spans_[i] = {0, 0xffff};  // no way there: nothing is known
    }
    cells_.push_back(landmark);
    units_.push_back(unit * static_cast<double>(kStraightCost));
  }

  // Whether the bounds still hold after a change: nothing is freed that was blocked when they were measured. `grid` is
  // the map before, and `frees(row, col)` says whether a cell of the window becomes free.
  template <typename Frees>
  bool hold(const BitGrid &grid, const Window &changed, Frees &&frees) {
    const BitGrid &then = measured_on_ ? *measured_on_ : grid;
    for (std::int64_t row = changed.row; row < changed.row_end; ++row) {
      for (std::int64_t col = changed.col; col < changed.col_end; ++col) {
        if (frees(row, col) && then.blocked(static_cast<std::int32_t>(row), static_cast<std::int32_t>(col))) return false;
      }
    }
    if (!measured_on_) {
      measured_on_ = std::make_unique<BitGrid>(grid.rows(), grid.cols());
      measured_on_->copy(grid);
    }
    return true;
  }

 private:
  friend class LandmarkEstimate;

  // From the least to the largest distance in a block, in a landmark's own unit.
  struct Span {
    std::uint16_t least, most;
  };
  static constexpr int kShift = 4;

  std::size_t index(GridCell cell) const {
    return static_cast<std::size_t>((cell.row >> kShift) * across_ + (cell.col >> kShift)) * count_;
  }

  std::size_t count_;
  std::int64_t across_;       // blocks
  std::vector<Span> spans_;   // of each block: one for each landmark
  std::vector<GridCell> cells_;
  std::vector<double> units_;             // of each landmark, as a cost
  std::unique_ptr<BitGrid> measured_on_;  // none where that is the map as it is
};

// Where to measure from, in the component with the most cells: at its edge all round, as landmarks tell most about ways
// that lead towards them or away. In each of `count` equal sectors, the first about the diagonal, it is the cell farthest
// from the middle, with both sides of the map taken for as long; none where a sector has no cell.
inline std::vector<GridCell> landmark_cells(const BitGrid &grid, const FreeRuns &runs, std::size_t count) {
  constexpr std::int32_t kStride = 16;  // not every cell of a run is looked at
  const double middle_row = 0.5 * static_cast<double>(grid.rows() - 1), middle_col = 0.5 * static_cast<double>(grid.cols() - 1);
  const double full_turn = 2.0 * std::acos(-1.0), sector = full_turn / static_cast<double>(count);
  std::vector<double> farthest(count, -1.0);
  std::vector<GridCell> found(count);
  runs.for_each_of_largest(grid, [&](std::int32_t row, std::int32_t begin, std::int32_t end) {
    for (std::int32_t next = begin; next < end + kStride; next += kStride) {
      const std::int32_t col = std::min(next, end - 1);
      const double y = (row - middle_row) / middle_row, x = (col - middle_col) / middle_col, away = x * x + y * y;
      const double turn = std::atan2(y, x) - full_turn / 8.0 + 0.5 * sector + full_turn;  // above 0
      const std::size_t i = static_cast<std::size_t>(turn / sector) % count;
      if (away > farthest[i]) farthest[i] = away, found[i] = {row, col};
    }
  });
  std::vector<GridCell> cells;
  for (std::size_t i = 0; i < count; ++i) {
    if (farthest[i] >= 0.0 && std::find(cells.begin(), cells.end(), found[i]) == cells.end()) cells.push_back(found[i]);
  }
  return cells;
}

// The best of the octile distance and of what four landmarks say, those that say most at the start. The goal lies in the
// part of the map that the landmarks do.
class LandmarkEstimate {
 public:
  LandmarkEstimate(const Landmarks &landmarks, GridCell start, GridCell goal)
      : landmarks_(landmarks), octile_{goal}, goal_(landmarks.spans_.data() + landmarks.index(goal)) {
    const Landmarks::Span *here = landmarks.spans_.data() + landmarks.index(start);
    for (std::size_t k = 0; k < landmarks.cells_.size(); ++k) {
      Guide guide{apart(here[k], goal_[k]) * landmarks.units_[k], k};
      for (std::size_t i = 0; i < guides_.size(); ++i) {
        if (i == used_ || guide.bound > guides_[i].bound) std::swap(guide, guides_[i]);
        if (i == used_) {
          ++used_;
          break;
        }
      }
    }
  }

  std::uint64_t operator()(GridCell cell) const {
    const Landmarks::Span *here = landmarks_.spans_.data() + landmarks_.index(cell);
    double bound = 0.0;
    for (std::size_t i = 0; i < used_; ++i) {
      const std::size_t k = guides_[i].landmark;
      bound = std::max(bound, apart(here[k], goal_[k]) * landmarks_.units_[k]);
    }
    return std::max(octile_(cell), static_cast<std::uint64_t>(bound));
  }

 private:
  struct Guide {
    double bound = 0.0;
    std::size_t landmark = 0;
  };

  static double apart(Landmarks::Span a, Landmarks::Span b) {
    return std::max(int{a.least} - int{b.most}, int{b.least} - int{a.most});
  }

  const Landmarks &landmarks_;
  OctileEstimate octile_;
  const Landmarks::Span *goal_;
  std::array<Guide, 4> guides_;
  std::size_t used_ = 0;
};

}  // namespace trundle
