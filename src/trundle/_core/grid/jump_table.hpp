// JPS+: where every jump from every cell leads, in a table of 16 bytes a cell. D. Harabor, A. Grastien, "Improving Jump
// Point Search" (2014), section 5; the diagonal jumps pass over their intermediate points.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <vector>

#include "grid/bit_grid.hpp"
#include "shared/grid_steps.hpp"

namespace trundle {

class JumpTable {
 public:
  static constexpr std::int64_t kLongest = std::numeric_limits<std::int16_t>::max();

  // No line of the grid may be longer than `kLongest`.
  JumpTable(const BitGrid &rows, const BitGrid &cols)
      : cols_(rows.cols()), spans_(static_cast<std::size_t>(rows.rows() * rows.cols()) * 8, 0) {
    for (std::int32_t row = 1; row < rows.rows() - 1; ++row) {
      fill_line(rows, row, static_cast<std::size_t>(row * cols_) * 8, 8, 0, 4);
    }
    for (std::int32_t col = 1; col < rows.cols() - 1; ++col) {
      fill_line(cols, col, static_cast<std::size_t>(col) * 8, static_cast<std::size_t>(cols_) * 8, 2, 6);
    }
    for (std::int32_t row = 1; row < rows.rows() - 1; ++row) fill_diagonals(rows, row, 5, 7);
    for (auto row = static_cast<std::int32_t>(rows.rows() - 2); row > 0; --row) fill_diagonals(rows, row, 1, 3);
  }

  void prefetch(GridCell cell) const { __builtin_prefetch(spans(cell)); }

  std::size_t bytes() const { return spans_.size() * sizeof(std::int16_t); }

  // Call `reach(cell, steps straight, steps diagonal, last direction)` for each jump point that is met in directions,
  // given as bits.
  template <typename Reach>
  void jump(unsigned directions, GridCell from, GridCell goal, std::uint64_t, Reach &&reach) const {
    for (unsigned left = directions; left != 0; left &= left - 1) jump_along(__builtin_ctz(left), from, goal, reach);
  }

 private:
  template <typename Reach>
  void jump_along(int direction, GridCell from, GridCell goal, Reach &reach) const {
    if (direction % 2 == 0) {
      straight(direction, from, goal, 0, reach);
      return;
    }
    const int down = kStepRow[direction], right = kStepCol[direction];
    const int along = right > 0 ? 0 : 4, up = down > 0 ? 2 : 6;
    std::uint64_t steps = 0;
    for (GridCell cell = from;;) {
      const int span = spans(cell)[direction];
      const std::int32_t rows_left = (goal.row - cell.row) * down, cols_left = (goal.col - cell.col) * right;
      const std::int32_t to_line = std::min(rows_left, cols_left);  // to where the goal is in line
      if (to_line > 0 && to_line <= std::abs(span)) {
        const GridCell turn{cell.row + down * to_line, cell.col + right * to_line};
        const std::uint64_t diagonal = steps + static_cast<std::uint64_t>(to_line);
        const std::int32_t rest = std::max(rows_left, cols_left) - to_line;
        if (rest == 0) {
          reach(goal, 0, diagonal, direction);
          return;
        }
        const int last = cols_left > rows_left ? along : up;
        if (std::abs(spans(turn)[last]) >= rest) reach(goal, static_cast<std::uint64_t>(rest), diagonal, last);
      }
      if (span <= 0) return;
      cell = {cell.row + down * span, cell.col + right * span};
      steps += static_cast<std::uint64_t>(span);
      straight(along, cell, goal, steps, reach);
      straight(up, cell, goal, steps, reach);
    }
  }

  // By direction: the steps to the next jump point, or less the free steps to what blocks. In a diagonal direction a
  // jump point is a cell from which a straight jump leads to one.
  const std::int16_t *spans(GridCell cell) const {
    return spans_.data() + (static_cast<std::size_t>(cell.row) * static_cast<std::size_t>(cols_) +
                            static_cast<std::size_t>(cell.col)) * 8;
  }

  template <typename Reach>
  void straight(int direction, GridCell from, GridCell goal, std::uint64_t diagonal, Reach &reach) const {
    const int span = spans(from)[direction];
    const bool across = direction % 4 == 0;
    const int sign = across ? kStepCol[direction] : kStepRow[direction];
    const bool in_line = across ? from.row == goal.row : from.col == goal.col;
    const std::int32_t to_goal = (across ? goal.col - from.col : goal.row - from.row) * sign;
    if (in_line && to_goal > 0 && to_goal <= std::abs(span)) {
      reach(goal, static_cast<std::uint64_t>(to_goal), diagonal, direction);
    } else if (span > 0) {
      const GridCell cell{from.row + kStepRow[direction] * span, from.col + kStepCol[direction] * span};
      reach(cell, static_cast<std::uint64_t>(span), diagonal, direction);
    }
  }

  // One line of a grid: `first` is where its spans begin, and `stride` is from one cell to the next.
  void fill_line(const BitGrid &grid, std::int32_t line, std::size_t first, std::size_t stride, int up, int down) {
    const auto end = static_cast<std::int32_t>(grid.cols() - 1);
    const auto put = [&](std::int32_t at, int direction, std::int32_t steps, bool blocked) {
      spans_[first + static_cast<std::size_t>(at) * stride + static_cast<std::size_t>(direction)] =
          static_cast<std::int16_t>(blocked ? 1 - steps : steps);
    };
    for (std::int32_t at = 1; at < end;) {
      if (grid.blocked(line, at)) {
        ++at;
        continue;
      }
      const Stop stop = BitGrid::scan_up(grid.around(line), at);
      for (; at < stop.at; ++at) put(at, up, stop.at - at, stop.blocked);
    }
    for (std::int32_t at = end - 1; at > 0;) {
      if (grid.blocked(line, at)) {
        --at;
        continue;
      }
      const Stop stop = BitGrid::scan_down(grid.around(line), at);
      for (; at > stop.at; --at) put(at, down, at - stop.at, stop.blocked);
    }
  }

  // One row of two diagonal directions; the row that they lead to is filled.
  void fill_diagonals(const BitGrid &rows, std::int32_t row, int a, int b) {
    for (const int direction : {a, b}) {
      const int down = kStepRow[direction], right = kStepCol[direction];
      const int along = right > 0 ? 0 : 4, up = down > 0 ? 2 : 6;
      for (std::int32_t col = 1; col < cols_ - 1; ++col) {
        const GridCell cell{row, col}, next{row + down, col + right};
        if (rows.blocked(row, col) || rows.blocked(row, next.col) || rows.blocked(next.row, col) ||
            rows.blocked(next.row, next.col))
          continue;
        const std::int16_t *onward = spans(next);
        const std::int16_t further = onward[direction];
        const int span = onward[along] > 0 || onward[up] > 0 ? 1 : further > 0 ? further + 1 : further - 1;
        const_cast<std::int16_t *>(spans(cell))[direction] = static_cast<std::int16_t>(span);
      }
    }
  }

  std::int64_t cols_;
  std::vector<std::int16_t> spans_;
};

}  // namespace trundle
