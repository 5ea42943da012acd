// A map of blocked and free cells, ready for searches from several threads at once.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <shared_mutex>
#include <utility>
#include <vector>

#include "grid/any_angle.hpp"
#include "grid/bit_grid.hpp"
#include "grid/bucket_search.hpp"
#include "grid/byte_view.hpp"
#include "grid/free_runs.hpp"
#include "grid/jump_search.hpp"
#include "shared/memory_pool.hpp"

namespace trundle {

enum class Method { kAuto, kJump, kBucket };

class BinaryGrid {
 public:
  // With more clutter than this, bucket A* is faster than jumps: there are so many detours of equal length.
  static constexpr double kCluttered = 0.08;

  BinaryGrid(const ByteView &blocked, int connectivity, Method method)
      : connectivity_(connectivity),
        asked_(method),
        by_rows_(blocked.rows + 2, blocked.cols + 2),
        by_cols_(blocked.cols + 2, blocked.rows + 2) {
    if (blocked.row_stride < blocked.col_stride) {
      pack(blocked.transposed(), by_cols_);
      by_rows_.transpose(by_cols_);
    } else {
      pack(blocked, by_rows_);
      by_cols_.transpose(by_rows_);
    }
    by_rows_.count(0, by_rows_.rows(), 0, by_rows_.words(), free_, euler_, corners_);
    runs_.label(by_rows_);
    choose_method();
  }

  std::int64_t rows() const { return by_rows_.rows() - 2; }
  std::int64_t cols() const { return by_rows_.cols() - 2; }
  bool inside(std::int64_t row, std::int64_t col) const { return row >= 0 && row < rows() && col >= 0 && col < cols(); }

  Method method() const {
    std::shared_lock lock(change_);
    return method_;
  }
  bool blocked(GridCell cell) const {
    std::shared_lock lock(change_);
    return by_rows_.blocked(cell.row + 1, cell.col + 1);
  }
  // The geometric mean of the number of obstacles that stand free and of their corners, per free cell. Corners alone
  // are as many in a maze, where jumps are fast; obstacles grow together and become few in dense clutter, where jumps
  // are slow.
  double clutter() const {
    std::shared_lock lock(change_);
    return clutter_now();
  }

  // Memory that is kept between searches, without what searches in other threads have taken out.
  std::size_t bytes() const {
    std::shared_lock lock(change_);
    const std::size_t map = by_rows_.bytes() + by_cols_.bytes() + runs_.bytes() + (masks_ ? masks_->size() : 0);
    return map + jump_pool_.bytes() + bucket_pool_.bytes() + any_angle_pool_.bytes();
  }

  // The free cell nearest to one inside, at most `reach` away, of those that `from` can reach if that is given.
  std::optional<GridCell> nearest(GridCell to, const GridCell *from, double reach) const {
    std::shared_lock lock(change_);
    std::uint32_t label = 0;
    if (from != nullptr) {
      if (by_rows_.blocked(from->row + 1, from->col + 1)) return {};
      label = runs_.at(from->row + 1, from->col + 1);
    }
    std::optional<GridCell> cell =
        runs_.nearest(by_rows_, {to.row + 1, to.col + 1}, from == nullptr ? nullptr : &label, reach);
    if (cell) leave_border(*cell);
    return cell;
  }

  // Whether two cells can reach each other: both are free, then.
  bool joined(GridCell a, GridCell b) const {
    std::shared_lock lock(change_);
    return span_of(a, b).has_value();
  }

  // Cells inside the map; unreachable where one is blocked. The path from a to b is that from b to a, backwards.
  GridPath find(GridCell start, GridCell goal, const SearchLimits &limits) const {
    std::shared_lock lock(change_);
    GridPath path;
    const std::optional<Span> span = span_of(start, goal);
    if (!span) return path;
    const auto [from, to, swapped] = *span;
    if (method_ == Method::kBucket) {
      auto memory = bucket_pool_.borrow();
      path = bucket_search(*masks_, connectivity_, from, to, limits, *memory);
      bucket_pool_.give_back(std::move(memory));
    } else {
      auto memory = jump_pool_.borrow();
      path = jump_search(by_rows_, by_cols_, from, to, limits, *memory);
      jump_pool_.give_back(std::move(memory));
    }
    restore_order(path.corners, swapped);
    return path;
  }

  // The shortest path of a point, in half cells. The same in both directions.
  PointPath find_point(GridCell start, GridCell goal, const SearchLimits &limits) const {
    std::shared_lock lock(change_);
    PointPath path;
    const std::optional<Span> span = span_of(start, goal);
    if (!span) return path;
    const auto [from, to, swapped] = *span;
    auto memory = any_angle_pool_.borrow();
    path = AnyAngleSearch(by_rows_, from, to, *memory).run(limits);
    any_angle_pool_.give_back(std::move(memory));
    restore_order(path.points, swapped);
    return path;
  }

  // New values for a rectangle that lies inside.
  void update(std::int64_t row, std::int64_t col, const ByteView &values) {
    if (values.rows == 0 || values.cols == 0) return;
    std::unique_lock lock(change_);
    const Window changed{row + 1, row + 1 + values.rows, col + 1, col + 1 + values.cols};
    const bool local = changed.grown().area() <= kLocal;
    const std::vector<std::uint32_t> before = local ? parts_of(by_rows_, changed.grown()) : std::vector<std::uint32_t>();
    recount(changed, -1);
    for (std::int64_t r = 0; r < values.rows; ++r) {
      for (std::int64_t c = 0; c < values.cols; ++c) {
        const bool blocked = values.at(r, c) != 0;
        by_rows_.set(row + r + 1, col + c + 1, blocked);
        by_cols_.set(col + c + 1, row + r + 1, blocked);
      }
    }
    recount(changed, 1);
    if (!local || !runs_.patch(by_rows_, changed, before)) runs_.label(by_rows_);
    if (masks_) masks_->fill(by_rows_, changed.row - 1, changed.row_end + 1);
    choose_method();
  }

 private:
  static constexpr std::size_t kLocal = 1 << 16;  // cells up to which labels are patched around a change

  // The ends of a search: cells of the grid with its border, the lower one first.
  struct Span {
    GridCell from, to;
    bool swapped;
  };

  // None where no path joins two cells inside the map.
  std::optional<Span> span_of(GridCell start, GridCell goal) const {
    GridCell from{start.row + 1, start.col + 1}, to{goal.row + 1, goal.col + 1};
    if (by_rows_.blocked(from.row, from.col) || by_rows_.blocked(to.row, to.col)) return {};
    if (runs_.at(from.row, from.col) != runs_.at(to.row, to.col)) return {};
    const bool swapped = to.row != from.row ? to.row < from.row : to.col < from.col;
    return swapped ? Span{to, from, true} : Span{from, to, false};
  }

  // From the start to the goal, and without the border.
  template <typename Point>
  static void restore_order(std::vector<Point> &points, bool swapped) {
    if (swapped) std::reverse(points.begin(), points.end());
    for (Point &point : points) leave_border(point);
  }
  static void leave_border(GridCell &cell) { --cell.row, --cell.col; }
  static void leave_border(HalfCell &at) { at.x -= 2, at.y -= 2; }

  // Takes the squares of 2 x 2 cells with changed ones out of the count, or adds them.
  void recount(const Window &changed, std::int64_t sign) {
    std::int64_t free = 0, euler = 0, corners = 0;
    by_rows_.count(changed.row - 1, changed.row_end, static_cast<std::size_t>(changed.col - 1) / 64,
                 static_cast<std::size_t>(changed.col_end - 1) / 64 + 1, free, euler, corners);
    free_ += sign * free, euler_ += sign * euler, corners_ += sign * corners;
  }

  double clutter_now() const {
    const std::int64_t obstacles = runs_.components() - euler_ / 4;
    const double product = static_cast<double>(obstacles) * static_cast<double>(corners_);
    return free_ > 0 ? std::sqrt(product) / static_cast<double>(free_) : 0.0;
  }

  void choose_method() {
    method_ = asked_;
    if (asked_ == Method::kAuto) method_ = clutter_now() > kCluttered ? Method::kBucket : Method::kJump;
    if (connectivity_ == 4) method_ = Method::kBucket;
    if (method_ != Method::kBucket) {
      masks_.reset();
      bucket_pool_.clear();
    } else if (!masks_) {
      masks_ = std::make_unique<StepMasks>(by_rows_);
    }
  }

  const int connectivity_;
  const Method asked_;
  Method method_ = Method::kJump;
  BitGrid by_rows_, by_cols_;  // rows, and columns
  FreeRuns runs_;
  // Cells, four times the Euler number of the free space, and corners of obstacles.
  std::int64_t free_ = 0, euler_ = 0, corners_ = 0;
  std::unique_ptr<StepMasks> masks_;
  mutable std::shared_mutex change_;
  mutable MemoryPool<JumpMemory> jump_pool_;
  mutable MemoryPool<BucketMemory> bucket_pool_;
  mutable MemoryPool<AnyAngleMemory> any_angle_pool_;
};

}  // namespace trundle
