// What it costs a point to get from a cell to the goal, worked out backwards from the goal only as far as it is asked.
//
// A* from the goal towards one place, the start, on cells of `factor` × `factor` cells of the map: a cell costs what its
// open parts cost on the average, and is closed where it has none. It stops as soon as a cell that is asked for is settled,
// and goes on from there at the next question. The queue is Dial's (1969) with buckets one cheapest step wide; memory is
// stamped and never cleared.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <vector>

#include "grid_steps.hpp"
#include "zeroed_table.hpp"

namespace trundle {

class LazyCostToGo {
 public:
  static constexpr float kUnreachable = std::numeric_limits<float>::infinity();

  // Forget what was asked before. Cells of the map from `blocked` on are closed; the others cost `weights[cost]` >= 1.
  void begin(const std::uint8_t *costs, std::int64_t rows, std::int64_t cols, int factor, const float *weights) {
    costs_ = costs, map_rows_ = rows, map_cols_ = cols, factor_ = factor, weights_ = weights;
    rows_ = (rows + factor - 1) / factor, cols_ = (cols + factor - 1) / factor;
    slots_.fit(static_cast<std::size_t>(rows_ * cols_));
    if (++stamp_ == 0) slots_.clear(), stamp_ = 1;  // after 2^32 queries
    const float dearest = *std::max_element(weights, weights + 256);
    std::size_t size = 4;
    while (static_cast<float>(size) < 1.5f * (dearest + 1.0f) + 3.0f) size *= 2;
    for (auto &bucket : buckets_) bucket.clear();
    buckets_.resize(size);
    queued_ = expanded_ = 0;
  }

  // Where the way leads, and from where it will mostly be asked; cells of this grid.
  void set_goal(std::int64_t row, std::int64_t col, std::int64_t towards_row, std::int64_t towards_col) {
    towards_row_ = towards_row, towards_col_ = towards_col;
    Slot &slot = touch(row, col);
    slot.cost = 0.0f;
    current_ = static_cast<std::int64_t>(octile(row, col));
    push(row, col, octile(row, col));
  }

  std::int64_t rows() const { return rows_; }
  std::int64_t cols() const { return cols_; }
  std::uint64_t expanded() const { return expanded_; }
  std::size_t bytes() const { return slots_.bytes(); }

  // Cost from a cell to the goal, in cells of this grid of weight 1. Where patience ends `status` says so.
  float at(std::int64_t row, std::int64_t col, const Patience &patience, SearchStatus &status) {
    Slot &slot = touch(row, col);
    if (slot.weight == 0.0f) return kUnreachable;
    const float distance = octile(row, col);
    while (queued_ > 0 && !(slot.cost + distance < static_cast<float>(current_))) {
      settle_one();
      if (expanded_ % 16384 == 0 && (status = patience.left()) != SearchStatus::kFound) break;
    }
    return slot.cost;
  }

 private:
  struct Slot {
    std::uint32_t stamp;
    float cost, weight, settled_at;
  };
  struct Entry {
    std::int32_t row, col;
    float cost;
  };

  Slot &touch(std::int64_t row, std::int64_t col) {
    Slot &slot = slots_[static_cast<std::size_t>(row * cols_ + col)];
    if (slot.stamp != stamp_) slot = {stamp_, kUnreachable, weight(row, col), kUnreachable};
    return slot;
  }

  float weight(std::int64_t row, std::int64_t col) const {
    const std::int64_t bottom = row * factor_, left = col * factor_;
    const std::int64_t top = std::min(bottom + factor_, map_rows_), right = std::min(left + factor_, map_cols_);
    float sum = 0.0f;
    int free = 0;
    for (std::int64_t r = bottom; r < top; ++r) {
      for (std::int64_t c = left; c < right; ++c) {
        const float w = weights_[costs_[r * map_cols_ + c]];
        if (w > 0.0f) sum += w, ++free;
      }
    }
    return free > 0 ? sum / static_cast<float>(free) : 0.0f;
  }

  float octile(std::int64_t row, std::int64_t col) const {
    const auto a = static_cast<float>(std::abs(row - towards_row_));
    const auto b = static_cast<float>(std::abs(col - towards_col_));
    return a < b ? b + 0.41421356f * a : a + 0.41421356f * b;
  }

  void push(std::int64_t row, std::int64_t col, float sum) {
    // A rounding must not put it behind the bucket that is being read.
    const std::int64_t bucket = std::max(current_, static_cast<std::int64_t>(sum));
    buckets_[static_cast<std::size_t>(bucket) & (buckets_.size() - 1)].push_back(
        {static_cast<std::int32_t>(row), static_cast<std::int32_t>(col), touch(row, col).cost});
    ++queued_;
  }

  void settle_one() {
    auto *bucket = &buckets_[static_cast<std::size_t>(current_) & (buckets_.size() - 1)];
    while (bucket->empty()) bucket = &buckets_[static_cast<std::size_t>(++current_) & (buckets_.size() - 1)];
    const Entry entry = bucket->back();
    bucket->pop_back();
    --queued_;
    Slot &slot = touch(entry.row, entry.col);
    if (entry.cost > slot.cost || slot.settled_at <= entry.cost) {
      skip_empty();
      return;
    }
    slot.settled_at = entry.cost;
    ++expanded_;
    const float cost = slot.cost, weight = slot.weight;
    for (int k = 0; k < 8; ++k) {
      static constexpr int kRow[8] = {0, 1, 0, -1, 1, 1, -1, -1}, kCol[8] = {1, 0, -1, 0, 1, -1, -1, 1};
      const std::int64_t row = entry.row + kRow[k], col = entry.col + kCol[k];
      if (row < 0 || row >= rows_ || col < 0 || col >= cols_) continue;
      Slot &next = touch(row, col);
      if (next.weight == 0.0f) continue;
      const float reached = cost + (k < 4 ? 0.5f : 0.70710678f) * (weight + next.weight);
      if (!(reached < next.cost)) continue;
      next.cost = reached;
      push(row, col, reached + octile(row, col));
    }
    skip_empty();
  }

  // Go on to the next bucket that holds something, so that what is settled shows.
  void skip_empty() {
    while (queued_ > 0 && buckets_[static_cast<std::size_t>(current_) & (buckets_.size() - 1)].empty()) ++current_;
  }

  const std::uint8_t *costs_ = nullptr;
  const float *weights_ = nullptr;
  std::int64_t map_rows_ = 0, map_cols_ = 0, rows_ = 0, cols_ = 0, towards_row_ = 0, towards_col_ = 0, current_ = 0;
  int factor_ = 1;
  std::uint32_t stamp_ = 0;
  std::uint64_t queued_ = 0, expanded_ = 0;
  ZeroedTable<Slot> slots_;
  std::vector<std::vector<Entry>> buckets_;
};

}  // namespace trundle
