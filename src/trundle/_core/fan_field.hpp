// What it costs to come from some cells of a grid to the others in any direction, whose cells have a weight each.
//
// A front spreads over the cells' centres (Tsitsiklis, 1995; Sethian, 1996). A cell is reached from its eight neighbours,
// straight or diagonally, and through each of the eight triangles that it makes with two of them: between these the cost
// is taken as linear, so that the way may come from anywhere between (as in Field D*: Ferguson and Stentz, 2006). Eight
// triangles err less than the four between straight neighbours that are usual. A triangle
// needs its three cells open, so no corner is cut, but one may be touched.
//
// The queue is Dial's (1969). Whatever a way through a triangle gains, it costs 1/√2 of the least weight more than both of
// the two corners: buckets no wider than that may be emptied in any order, and cells are done when theirs is. Memory is
// kept from one field to the next and made ready in squares of 8 × 8 cells when the front comes to them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "grid_steps.hpp"
#include "lanes.hpp"
#include "lazy_cost_to_go.hpp"

namespace trundle {

template <typename Real>
class FanField {
 public:
  struct Cell {
    Real cost, weight;
  };

  static constexpr Real kFar = std::numeric_limits<Real>::infinity();  // cost where nothing came; weight where closed
  static constexpr std::int64_t kSquare = 8;

  // Forget everything. Open cells weigh `least` to `dearest` for a length of one cell. Without `between` ways go from
  // centre to centre alone, straight or diagonally, and touch no corner of a closed cell.
  void begin(std::int64_t rows, std::int64_t cols, Real least, Real dearest, bool between = true) {
    between_ = between;
    squares_across_ = (cols + kSquare - 1) / kSquare + 2;  // with a frame of closed squares
    stride_ = squares_across_ * kSquare;
    const std::int64_t squares = ((rows + kSquare - 1) / kSquare + 2) * squares_across_;
    cells_.fit(static_cast<std::size_t>(squares * kSquare * kSquare));
    stamps_.fit(static_cast<std::size_t>(squares));
    if (++stamp_ == 0) stamps_.clear(), stamp_ = 1;  // after 2^32 fields
    width_ = Real(0.7) * least, per_width_ = 1 / width_, worthwhile_ = least / 1024;
    std::size_t size = 4;
    while (size < kMostBuckets && static_cast<Real>(size) < Real(1.5) * dearest * per_width_ + 3) size *= 2;
    later_.clear();
    first_later_ = kNever;
    for (auto &bucket : buckets_) bucket.clear();
    buckets_.resize(size);
    bucket_ = 0, waiting_ = 0, settled_ = 0;
  }

  bool between() const { return between_; }
  std::int64_t stride() const { return stride_; }
  std::int64_t at(std::int64_t row, std::int64_t col) const { return (row + kSquare) * stride_ + col + kSquare; }
  Real cost(std::int64_t at) { return cells_[static_cast<std::size_t>(at)].cost; }
  Real weight(std::int64_t at) { return cells_[static_cast<std::size_t>(at)].weight; }
  std::uint64_t settled() const { return settled_; }
  std::size_t bytes() const {
    std::size_t sum = cells_.bytes() + stamps_.bytes() + later_.capacity() * sizeof(Entry);
    for (const auto &bucket : buckets_) sum += bucket.capacity() * sizeof(Entry);
    return sum;
  }

  // Whether costs and weights may be read there.
  bool is_ready(std::int64_t row, std::int64_t col) {
    return stamps_[static_cast<std::size_t>(((row >> 3) + 1) * squares_across_ + (col >> 3) + 1)] == stamp_;
  }
  Real cost_or_far(std::int64_t row, std::int64_t col) { return is_ready(row, col) ? cost(at(row, col)) : kFar; }

  // Make a cell and those around it ready. `fill(row, col, cells, stride)` writes those of a square of 8 × 8 cells
  // from (row, col) on, which may lie outside the grid.
  template <typename Fill>
  void make_ready(std::int64_t row, std::int64_t col, const Fill &fill) {
    touch((row >> 3) + 1, (col >> 3) + 1, fill);
    make_ready_around(row, col, fill);
  }

  // Where the front begins, at a cell that is ready.
  void seed(std::int64_t row, std::int64_t col, Real cost) {
    Real &known = cells_[static_cast<std::size_t>(at(row, col))].cost;
    if (!(cost < known)) return;
    known = cost;
    push(row, col, cost);
  }

  // Go on until nothing waits or `done(cost)` is true, asked when all cells that cost less are settled. A cell counts as
  // reached only if `admit(at, cost)`. Anything but found says that patience ended.
  template <typename Fill, typename Admit, typename Done>
  SearchStatus spread(const Fill &fill, const Admit &admit, const Done &done, const Patience &patience) {
    while (waiting_ > 0) {
      if (waiting_ == later_.size()) bucket_ = first_later_;
      if (bucket_ == first_later_) bring_near();
      if (done(static_cast<Real>(bucket_) * width_)) return SearchStatus::kFound;
      auto &entries = buckets_[static_cast<std::size_t>(bucket_) & (buckets_.size() - 1)];
      while (!entries.empty()) {
        const Entry entry = entries.back();
        entries.pop_back();
        --waiting_;
        if (entry.cost != cost(at(entry.row, entry.col))) continue;  // reached more cheaply since
        if (settled_++ % 4096 == 0) {
          const SearchStatus left = patience.left();
          if (left != SearchStatus::kFound) return left;
        }
        make_ready_around(entry.row, entry.col, fill);
        offer(entry, admit);
      }
      ++bucket_;
    }
    return SearchStatus::kFound;
  }

 private:
  using F = Four<Real>;
  using Lanes = typename F::Lanes;
  static constexpr std::size_t kMostBuckets = 4096;
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
  struct Entry {
    std::int32_t row, col;
    Real cost;
  };

  template <typename Fill>
  void touch(std::int64_t square_row, std::int64_t square_col, const Fill &fill) {
    std::uint32_t &stamp = stamps_[static_cast<std::size_t>(square_row * squares_across_ + square_col)];
    if (stamp == stamp_) return;
    stamp = stamp_;
    const std::int64_t first = square_row * kSquare * stride_ + square_col * kSquare;
    fill((square_row - 1) * kSquare, (square_col - 1) * kSquare, &cells_[static_cast<std::size_t>(first)], stride_);
  }

  // The same for a cell that is ready.
  template <typename Fill>
  void make_ready_around(std::int64_t row, std::int64_t col, const Fill &fill) {
    const std::int64_t in_row = row & 7, in_col = col & 7;
    const std::int64_t up = in_row == 7 ? 1 : in_row == 0 ? -1 : 0, right = in_col == 7 ? 1 : in_col == 0 ? -1 : 0;
    if ((up | right) == 0) return;
    const std::int64_t square_row = (row >> 3) + 1, square_col = (col >> 3) + 1;
    if (up != 0) touch(square_row + up, square_col, fill);
    if (right != 0) touch(square_row, square_col + right, fill);
    if (up != 0 && right != 0) touch(square_row + up, square_col + right, fill);
  }

  void push(std::int64_t row, std::int64_t col, Real cost) {
    const std::int64_t bucket = std::max(bucket_, static_cast<std::int64_t>(cost * per_width_));
    const Entry entry{static_cast<std::int32_t>(row), static_cast<std::int32_t>(col), cost};
    ++waiting_;
    if (bucket < bucket_ + static_cast<std::int64_t>(buckets_.size())) {
      buckets_[static_cast<std::size_t>(bucket) & (buckets_.size() - 1)].push_back(entry);
    } else {
      later_.push_back(entry);
      first_later_ = std::min(first_later_, bucket);
    }
  }

  // Move what waits for buckets that were too far off into those that are not.
  void bring_near() {
    std::vector<Entry> waiting;
    waiting.swap(later_);
    first_later_ = kNever;
    waiting_ -= waiting.size();
    for (const Entry &entry : waiting) push(entry.row, entry.col, entry.cost);
  }

  // Lower what third corners of triangles cost: the two others are a straight step from each other, one is a straight step
  // away and costs `more`, the other a diagonal one and costs `less`.
  static void lower(Lanes &known, const Lanes &more, const Lanes &less, const Lanes &weight) {
    const Lanes gap = more - less, squared = gap * gap, room = weight * weight;
    Lanes cost = room - squared;
    F::take_root(cost);
    cost += more;
    known = (gap > 0) & (squared + squared < room) & (cost < known) ? cost : known;
  }

  // Lower the neighbours' costs by all ways that begin at a cell or between it and a neighbour.
  template <typename Admit>
  void offer(const Entry &entry, const Admit &admit) {
    static constexpr std::int32_t kRow[8] = {0, 1, 0, -1, 1, 1, -1, -1}, kCol[8] = {1, 0, -1, 0, 1, -1, -1, 1};
    const std::int64_t here = at(entry.row, entry.col), s = stride_;
    const Cell *cell = &cells_[static_cast<std::size_t>(here)];
    const auto numbers = [cell](std::int64_t offset) { return &cell[offset].cost; };
    Lanes east, east_weight, corner, corner_weight, north, north_weight, south, south_weight;
    F::load_pairs(numbers(1), numbers(s), numbers(-1), numbers(-s), east, east_weight);
    F::load_pairs(numbers(s + 1), numbers(s - 1), numbers(-s - 1), numbers(-s + 1), corner, corner_weight);
    F::turn(east, north);
    F::turn(east_weight, north_weight);
    F::turn_back(east, south);
    F::turn_back(east_weight, south_weight);
    Lanes own;
    F::fill(own, entry.cost);
    const Real quarter = cell->weight * Real(0.25);
    const Lanes east_quarter = east_weight * Real(0.25), north_quarter = north_weight * Real(0.25);

    const Lanes straight_base = east_weight * Real(0.5) + quarter;
    Lanes straight = straight_base + (entry.cost + quarter);
    if (between_) {
      lower(straight, own, north, straight_base + north_quarter);
      lower(straight, own, south, straight_base + south_weight * Real(0.25));
    }

    const Lanes corner_base = corner_weight * Real(0.5) + quarter;
    Lanes diagonal = (corner_base + quarter) * Real(1.41421356237309505) + entry.cost;
    if (between_) {
      diagonal = (east_weight < kFar) | (north_weight < kFar) ? diagonal : diagonal + kFar;
      lower(diagonal, east, own, corner_base + east_quarter);
      lower(diagonal, north, own, corner_base + north_quarter);
    } else {
      diagonal = (east_weight < kFar) & (north_weight < kFar) ? diagonal : diagonal + kFar;
    }

    unsigned better = F::bits(straight + worthwhile_ < east) | F::bits(diagonal + worthwhile_ < corner) << 4;
    Real costs[8];
    std::memcpy(costs, &straight, sizeof straight);
    std::memcpy(costs + 4, &diagonal, sizeof diagonal);
    for (; better != 0; better &= better - 1) {
      const int k = __builtin_ctz(better);
      const std::int64_t there = here + kRow[k] * s + kCol[k];
      if (!admit(there, costs[k])) continue;
      cells_[static_cast<std::size_t>(there)].cost = costs[k];
      push(entry.row + kRow[k], entry.col + kCol[k], costs[k]);
    }
  }

  ZeroedTable<Cell> cells_;
  ZeroedTable<std::uint32_t> stamps_;
  std::uint32_t stamp_ = 0;
  bool between_ = true;
  std::vector<std::vector<Entry>> buckets_;
  std::vector<Entry> later_;
  std::int64_t first_later_ = kNever;
  std::int64_t squares_across_ = 0, stride_ = 0, bucket_ = 0;
  std::uint64_t waiting_ = 0, settled_ = 0;
  Real width_ = 1, per_width_ = 1, worthwhile_ = 0;
};

}  // namespace trundle
