// The cost of a point's path from a cell to the goal, computed backwards from the goal only as far as it is asked for.
//
// A* from the goal to one cell, the start, on cells of `factor` × `factor` cells of the map: a cell weighs the mean of
// its open cells, and is closed where it has none. No path crosses a side that is closed from end to end: a straight
// wall along rows or columns, at least `factor` cells of the map thick, lets none through, even where it fills no cell.
// The search stops as soon as the cell that is asked for is settled, and goes on from there for the next one. The queue
// is Dial's (1969), with buckets an eighth of the cheapest step wide: wider ones, which are last in, first out, run far
// ahead and expand cells again and again. Cells are made in blocks of 8 × 8, whose memory is stamped and never cleared.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <vector>

#include "shared/grid_steps.hpp"
#include "shared/zeroed_table.hpp"

namespace trundle {

class LazyCostToGo {
 public:
  static constexpr float kUnreachable = std::numeric_limits<float>::infinity();

  struct Cell {
    std::int64_t row, col;
  };

  // Forgets earlier queries. Cells of the map from 253 on are closed; the others weigh 1 + `per_cost` times their cost,
  // and cells of this grid next to one of `avoided` many times as much.
  void begin(const std::uint8_t *costs, std::int64_t rows, std::int64_t cols, int factor, float per_cost,
             const std::vector<Cell> &avoided = {}) {
    avoided_ = avoided;
    costs_ = costs, map_rows_ = rows, map_cols_ = cols, factor_ = factor, per_cost_ = per_cost;
    rows_ = (rows + factor - 1) / factor, cols_ = (cols + factor - 1) / factor;
    // With a border of closed cells.
    const std::int64_t block_rows = (rows_ + 2 + kBlock - 1) / kBlock;
    block_cols_ = (cols_ + 2 + kBlock - 1) / kBlock;
    stamps_.fit(static_cast<std::size_t>(block_rows * block_cols_));
    slots_.fit(static_cast<std::size_t>(block_rows * block_cols_ * kBlock * kBlock));
    if (++stamp_ == 0) stamps_.clear(), stamp_ = 1;  // after 2^32 queries
    const float highest = (1.0f + per_cost * (kInscribed - 1)) * (avoided.empty() ? 1.0f : kAvoided);
    std::size_t size = 4;
    while (static_cast<float>(size) < kFine * (1.5f * (highest + 1.0f)) + 3.0f) size *= 2;
    for (auto &bucket : buckets_) bucket.clear();
    buckets_.resize(size);
    queued_ = expanded_ = 0;
  }

  // The goal, and the cell from which the cost will mostly be asked; cells of this grid.
  void set_goal(std::int64_t row, std::int64_t col, std::int64_t towards_row, std::int64_t towards_col) {
    towards_row_ = towards_row, towards_col_ = towards_col;
    slots_[touch(row, col)].cost = 0.0f;
    current_ = static_cast<std::int64_t>(kFine * octile(row, col));
    push(row, col, 0.0f);
  }

  // The next cell from one whose cost is known; itself where that is the goal.
  Cell next(Cell here) {
    const std::size_t centre = touch(here.row, here.col);
    Cell best = here;
    float least = slots_[centre].cost;
    for (int rows = -1; rows <= 1; ++rows) {
      for (int cols = -1; cols <= 1; ++cols) {
        const Slot &slot = slots_[touch(here.row + rows, here.col + cols)];
        if (slot.cost == kClosed || !(slot.cost < least)) continue;
        if (is_barred(marks_of(slots_[centre].weight), marks_of(slot.weight), rows, cols)) continue;
        least = slot.cost, best = {here.row + rows, here.col + cols};
      }
    }
    return best;
  }

  std::uint64_t expanded() const { return expanded_; }
  std::size_t bytes() const { return stamps_.bytes() + slots_.bytes(); }

  // Cost from a cell to the goal, in cells of this grid of weight 1. `status` says why the search was stopped, if it
  // was.
  float at(std::int64_t row, std::int64_t col, const SearchLimits &limits, SearchStatus &status) {
    const Slot &slot = slots_[touch(row, col)];
    if (slot.cost == kClosed) return kUnreachable;
    const float distance = octile(row, col);
    while (queued_ > 0 && !(kFine * (slot.cost + distance) < static_cast<float>(current_))) {
      settle_one();
      if (expanded_ % 16384 == 0 && (status = limits.check()) != SearchStatus::kFound) break;
    }
    return slot.cost;
  }

 private:
  static constexpr std::uint8_t kInscribed = 253;
  static constexpr float kClosed = -kUnreachable;  // never reached cheaper
  static constexpr std::size_t kBlock = 8;
  static constexpr unsigned kUp = 1, kDown = 2, kLeft = 4, kRight = 8;  // sides; up is towards row 0
  static constexpr float kAvoided = 50.0f;  // factor of the weight of avoided cells
  static constexpr float kFine = 8.0f;  // buckets to a step of weight 1

  struct Slot {
    float cost, weight;  // the lowest bits of the weight are the closed sides
  };
  struct Entry {
    std::int32_t row, col;
    float cost;
  };

  // The slot of a cell, whose block is made where it is the first one of it; (-1, -1) is in the border.
  std::size_t touch(std::int64_t row, std::int64_t col) {
    const auto r = static_cast<std::size_t>(row + 1), c = static_cast<std::size_t>(col + 1);
    const auto block_cols = static_cast<std::size_t>(block_cols_);
    if (stamps_[r / kBlock * block_cols + c / kBlock] != stamp_) make_block(r / kBlock, c / kBlock);
    return r * block_cols * kBlock + c;
  }

  void make_block(std::size_t block_row, std::size_t block_col) {
    const auto block_cols = static_cast<std::size_t>(block_cols_);
    stamps_[block_row * block_cols + block_col] = stamp_;
    for (std::size_t r = block_row * kBlock; r < (block_row + 1) * kBlock; ++r) {
      for (std::size_t c = block_col * kBlock; c < (block_col + 1) * kBlock; ++c) {
        const auto row = static_cast<std::int64_t>(r) - 1, col = static_cast<std::int64_t>(c) - 1;
        const bool inside = row >= 0 && row < rows_ && col >= 0 && col < cols_;
        const float weight = inside ? weight_of(row, col) : 0.0f;
        slots_[r * block_cols * kBlock + c] = {weight > 0.0f ? kUnreachable : kClosed, weight};
      }
    }
  }

  float weight_of(std::int64_t row, std::int64_t col) const {
    const std::int64_t left = col * factor_, count = std::min<std::int64_t>(factor_, map_cols_ - left);
    const std::int64_t top = std::min((row + 1) * factor_, map_rows_);
    std::uint64_t sum = 0, open = 0;
    for (std::int64_t r = row * factor_; r < top; ++r) {
      const std::uint8_t *cells = costs_ + r * map_cols_ + left;
      std::int64_t c = 0;
      for (; c + 4 <= count; c += 4) add_four(cells + c, sum, open);
      for (; c < count; ++c) {
        if (cells[c] < kInscribed) sum += cells[c], ++open;
      }
    }
    if (open == 0) return 0.0f;
    float weight = 1.0f + per_cost_ * static_cast<float>(sum) / static_cast<float>(open);
    if (is_avoided(row, col)) weight *= kAvoided;
    const bool whole = open == static_cast<std::uint64_t>((top - row * factor_) * count);
    return marked(weight, whole ? 0 : closed_sides(row * factor_, top, left, left + count));
  }

  bool is_avoided(std::int64_t row, std::int64_t col) const {
    return std::any_of(avoided_.begin(), avoided_.end(), [&](const Cell &cell) {
      return std::abs(cell.row - row) <= 1 && std::abs(cell.col - col) <= 1;
    });
  }

  // Out of line: most cells are open all over, and the loop over them stays small.
  __attribute__((noinline)) unsigned closed_sides(std::int64_t top, std::int64_t bottom, std::int64_t left,
                                                  std::int64_t right) const {
    const std::uint8_t *const first = costs_ + top * map_cols_, *const last = costs_ + (bottom - 1) * map_cols_;
    unsigned closed = kUp | kDown | kLeft | kRight;
    for (std::int64_t c = left; c < right; ++c) {
      closed &= ~((first[c] < kInscribed ? kUp : 0) | (last[c] < kInscribed ? kDown : 0));
    }
    for (const std::uint8_t *cells = first; cells <= last; cells += map_cols_) {
      closed &= ~((cells[left] < kInscribed ? kLeft : 0) | (cells[right - 1] < kInscribed ? kRight : 0));
    }
    return closed;
  }

  static float marked(float weight, unsigned sides) {
    std::uint32_t bits;
    std::memcpy(&bits, &weight, 4);
    bits = (bits & ~15U) | sides;
    std::memcpy(&weight, &bits, 4);
    return weight;
  }

  static unsigned marks_of(float weight) {
    std::uint32_t bits;
    std::memcpy(&bits, &weight, 4);
    return bits & 15U;
  }

  // Whether closed sides bar a step. Past a corner they do where both cells' sides are closed, so that a step which the
  // map's own cells allow is never barred.
  static bool is_barred(unsigned here, unsigned there, int rows, int cols) {
    const unsigned ahead = rows > 0 ? kDown : rows < 0 ? kUp : 0U, back = rows > 0 ? kUp : rows < 0 ? kDown : 0U;
    const unsigned across = cols > 0 ? kRight : cols < 0 ? kLeft : 0U, home = cols > 0 ? kLeft : cols < 0 ? kRight : 0U;
    if (rows == 0 || cols == 0) return ((here & (ahead | across)) | (there & (back | home))) != 0;
    return ((here & ahead) != 0 && (there & back) != 0) || ((here & across) != 0 && (there & home) != 0);
  }

  static void add_four(const std::uint8_t *cells, std::uint64_t &sum, std::uint64_t &open) {
    std::uint32_t four;
    std::memcpy(&four, cells, 4);
    // The top bit of bytes that have it and whose other bits reach 125.
    const std::uint32_t closed = ((four & 0x7f7f7f7fU) + 0x03030303U) & four & 0x80808080U;
    four &= ~((closed >> 7) * 255U);
    const std::uint32_t pairs = (four & 0x00ff00ffU) + (four >> 8 & 0x00ff00ffU);
    sum += (pairs & 0xffffU) + (pairs >> 16);
    open += 4 - ((closed >> 7) * 0x01010101U >> 24);
  }

  float octile(std::int64_t row, std::int64_t col) const {
    const auto a = static_cast<float>(std::abs(row - towards_row_));
    const auto b = static_cast<float>(std::abs(col - towards_col_));
    return a < b ? b + 0.41421356f * a : a + 0.41421356f * b;
  }

  void push(std::int64_t row, std::int64_t col, float cost) {
    // A rounding must not put it behind the bucket that is being read.
    const std::int64_t bucket = std::max(current_, static_cast<std::int64_t>(kFine * (cost + octile(row, col))));
    buckets_[static_cast<std::size_t>(bucket) & (buckets_.size() - 1)].push_back(
        {static_cast<std::int32_t>(row), static_cast<std::int32_t>(col), cost});
    ++queued_;
  }

  void settle_one() {
    auto *bucket = &buckets_[static_cast<std::size_t>(current_) & (buckets_.size() - 1)];
    while (bucket->empty()) bucket = &buckets_[static_cast<std::size_t>(++current_) & (buckets_.size() - 1)];
    const Entry entry = bucket->back();
    bucket->pop_back();
    --queued_;
    const std::size_t here = touch(entry.row, entry.col);
    const Slot slot = slots_[here];
    // A cell is queued again each time that it is reached at less cost.
    if (!(entry.cost > slot.cost)) {
      ++expanded_;
      touch(entry.row - 1, entry.col - 1), touch(entry.row - 1, entry.col + 1);
      touch(entry.row + 1, entry.col - 1), touch(entry.row + 1, entry.col + 1);
      const std::int64_t stride = block_cols_ * static_cast<std::int64_t>(kBlock);
      Slot *const centre = slots_.data() + here;
      const unsigned sides = marks_of(slot.weight);
      const auto reach = [&](int rows, int cols, float half) {
        Slot &next = centre[rows * stride + cols];
        const float reached = slot.cost + half * (slot.weight + next.weight);
        if (!(reached < next.cost) || is_barred(sides, marks_of(next.weight), rows, cols)) return;
        next.cost = reached;
        push(entry.row + rows, entry.col + cols, reached);
      };
      constexpr float kHalf = 0.5f, kHalfDiagonal = 0.70710678f;
      reach(0, 1, kHalf), reach(1, 0, kHalf), reach(0, -1, kHalf), reach(-1, 0, kHalf);
      reach(1, 1, kHalfDiagonal), reach(1, -1, kHalfDiagonal), reach(-1, -1, kHalfDiagonal), reach(-1, 1, kHalfDiagonal);
    }
    skip_empty();
  }

  // Moves to the next bucket that is not empty, so that `current_` bounds what is settled.
  void skip_empty() {
    while (queued_ > 0 && buckets_[static_cast<std::size_t>(current_) & (buckets_.size() - 1)].empty()) ++current_;
  }

  const std::uint8_t *costs_ = nullptr;
  float per_cost_ = 0.0f;
  std::int64_t map_rows_ = 0, map_cols_ = 0, rows_ = 0, cols_ = 0, block_cols_ = 0;
  std::int64_t towards_row_ = 0, towards_col_ = 0, current_ = 0;
  int factor_ = 1;
  std::uint32_t stamp_ = 0;
  std::uint64_t queued_ = 0, expanded_ = 0;
  ZeroedTable<std::uint32_t> stamps_;
  ZeroedTable<Slot> slots_;
  std::vector<std::vector<Entry>> buckets_;
  std::vector<Cell> avoided_;
};

}  // namespace trundle
