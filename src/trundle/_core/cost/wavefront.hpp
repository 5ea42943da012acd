// What it costs to come from some cells of a grid to the others in any direction, whose cells have a weight each.
//
// A front spreads over the cells' centres, as in fast marching (Tsitsiklis, 1995; Sethian, 1996), but by whole squares of
// 8 × 8 cells: the one that the least cost comes to is settled with what its neighbours cost by then, and again when
// these get cheaper. Memory is kept from one field to the next, and squares are made ready when the front comes to them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#include "cost/wavefront_tile.hpp"
#include "shared/grid_steps.hpp"
#include "shared/zeroed_table.hpp"

namespace trundle {

template <typename Real>
class FrontField {
  using Work = FrontSquare<Real>;

 public:
  static constexpr Real kFar = Work::kFar;  // cost where nothing came; weight where closed
  static constexpr std::int64_t kSide = Work::kSide, kCells = kSide * kSide;

  // Forget everything. Open cells weigh `least` or more for a length of one cell. Without `between` ways go from centre to
  // centre alone, straight or diagonally, and touch no corner of a closed cell.
  void begin(std::int64_t rows, std::int64_t cols, Real least, bool between = true) {
    between_ = between;
    across_ = (cols + kSide - 1) / kSide + 2;  // with a frame of closed squares
    const auto count = static_cast<std::size_t>(((rows + kSide - 1) / kSide + 2) * across_);
    squares_.fit(count);
    states_.fit(count);
    if (++stamp_ == 0) states_.clear(), stamp_ = 1;  // after 2^32 fields
    work_.worthwhile = least / 1024;
    waiting_.clear();
    held_.clear();
    settled_ = 0;
  }

  bool between() const { return between_; }
  std::uint64_t settled() const { return settled_; }  // cells, as often as they were
  std::size_t bytes() const {
    const std::size_t lists = waiting_.capacity() * sizeof(Entry) + held_.capacity() * sizeof(std::int64_t);
    return squares_.bytes() + states_.bytes() + lists;
  }

  // Whether costs and weights may be read there: also of the cells around one that something came to.
  bool is_ready(std::int64_t row, std::int64_t col) { return states_[square_of(row, col)].stamp == stamp_; }
  Real cost(std::int64_t row, std::int64_t col) { return squares_[square_of(row, col)].cost[place_of(row, col)]; }
  Real weight(std::int64_t row, std::int64_t col) {
    return squares_[square_of(row, col)].quarter[place_of(row, col)] * 4;
  }
  Real cost_or_far(std::int64_t row, std::int64_t col) { return is_ready(row, col) ? cost(row, col) : kFar; }

  // Make a cell ready. `fill(row, col, quarters)` writes quarters of the weights of 8 × 8 cells from (row, col) on, row by
  // row; these may lie outside the grid.
  template <typename Fill>
  void make_ready(std::int64_t row, std::int64_t col, const Fill &fill) {
    touch(static_cast<std::int64_t>(square_of(row, col)), fill);
  }

  // Where the front begins, at a cell that is ready.
  template <typename Order>
  void seed(std::int64_t row, std::int64_t col, Real cost, const Order &order) {
    Real &known = squares_[square_of(row, col)].cost[place_of(row, col)];
    if (!(cost < known)) return;
    known = cost;
    tell(static_cast<std::int64_t>(square_of(row, col)), cost, Work::kAll, order);
  }

  // Go on until nothing waits or `done(rank)` is true, asked when all squares of a lower rank are settled.
  // `order(row, col, cost)` ranks the square from (row, col) on, which something comes to at `cost`; far holds it back.
  // Anything but found says that patience ended.
  template <typename Fill, typename Order, typename Done>
  SearchStatus spread(const Fill &fill, const Order &order, const Done &done, const Patience &patience) {
    while (!waiting_.empty()) {
      const Entry entry = waiting_.front();
      if (entry.rank == states_[static_cast<std::size_t>(entry.square)].rank) {
        if (done(entry.rank)) return SearchStatus::kFound;
        if (settled_ % (64 * kCells) == 0) {
          const SearchStatus left = patience.left();
          if (left != SearchStatus::kFound) return left;
        }
        settled_ += kCells;
        drop_first();
        settle(entry.square, fill, order);
      } else {
        drop_first();  // settled since, or it waits at a lower rank
      }
    }
    return SearchStatus::kFound;
  }

  // The lowest rank that waits.
  Real front() const { return waiting_.empty() ? kFar : waiting_.front().rank; }
  bool holds() const { return !held_.empty(); }

  // Rank anew what was held back.
  template <typename Order>
  void release(const Order &order) {
    std::vector<std::int64_t> held;
    held.swap(held_);
    for (const std::int64_t square : held) {
      State &state = states_[static_cast<std::size_t>(square)];
      const Real cost = state.cost;
      state.cost = kFar;
      tell(square, cost, 0, order);
    }
  }

 private:
  struct Square {
    Real cost[kCells], quarter[kCells];
  };
  struct State {
    std::uint32_t stamp;
    std::uint32_t pending;  // sweeps
    Real rank, cost;        // of the cheapest that came since it was settled
  };
  struct Entry {
    Real rank;
    std::int64_t square;
    bool operator<(const Entry &other) const { return rank > other.rank; }  // the least comes first
  };
  enum Side { kSouth, kNorth, kWest, kEast, kSouthWest, kSouthEast, kNorthWest, kNorthEast, kSides };

  std::size_t square_of(std::int64_t row, std::int64_t col) const {
    return static_cast<std::size_t>(((row >> 3) + 1) * across_ + (col >> 3) + 1);
  }
  static std::size_t place_of(std::int64_t row, std::int64_t col) {
    return static_cast<std::size_t>((row & 7) * kSide + (col & 7));
  }
  std::int64_t row_of(std::int64_t square) const { return (square / across_ - 1) * kSide; }
  std::int64_t col_of(std::int64_t square) const { return (square % across_ - 1) * kSide; }

  void drop_first() {
    std::pop_heap(waiting_.begin(), waiting_.end());
    waiting_.pop_back();
  }

  template <typename Fill>
  void touch(std::int64_t square, const Fill &fill) {
    State &state = states_[static_cast<std::size_t>(square)];
    if (state.stamp == stamp_) return;
    state = {stamp_, 0, kFar, kFar};
    Square &cells = squares_[static_cast<std::size_t>(square)];
    std::fill_n(cells.cost, kCells, kFar);
    fill(row_of(square), col_of(square), cells.quarter);
  }

  // Something comes to a square at `cost`, from where `pending` sweeps.
  template <typename Order>
  void tell(std::int64_t square, Real cost, unsigned pending, const Order &order) {
    State &state = states_[static_cast<std::size_t>(square)];
    if (!(cost < kFar)) return;
    state.pending |= pending;
    if (!(cost < state.cost)) return;
    const bool is_first = state.cost == kFar;
    state.cost = cost;
    const Real rank = order(row_of(square), col_of(square), cost);
    if (rank < state.rank) {
      state.rank = rank;
      waiting_.push_back({rank, square});
      std::push_heap(waiting_.begin(), waiting_.end());
    } else if (is_first && !(rank < kFar)) {
      held_.push_back(square);
    }
  }

  template <typename Fill, typename Order>
  void settle(std::int64_t square, const Fill &fill, const Order &order) {
    const std::int64_t s = across_;
    const std::int64_t around[kSides] = {square - s,     square + s,     square - 1,     square + 1,
                                         square - s - 1, square - s + 1, square + s - 1, square + s + 1};
    const Square *beside[kSides];
    for (int k = 0; k < kSides; ++k) {
      touch(around[k], fill);
      beside[k] = &squares_[static_cast<std::size_t>(around[k])];
    }
    Square &own = squares_[static_cast<std::size_t>(square)];
    frame(own, beside, &Square::cost, work_.upright.cost, work_.turned.cost);
    frame(own, beside, &Square::quarter, work_.upright.quarter, work_.turned.quarter);
    Work::turn(work_.upright.quarter, work_.turned.quarter);

    State &state = states_[static_cast<std::size_t>(square)];
    const unsigned pending = state.pending;
    state.pending = 0, state.rank = state.cost = kFar;
    Real gains[kSides];
    if (!between_) {
      run<false, true>(pending, gains);
    } else if (work_.has_walls()) {
      run<true, true>(pending, gains);
    } else {
      run<true, false>(pending, gains);
    }
    for (int row = 0; row < kSide; ++row) {
      std::memcpy(own.cost + kSide * row, &work_.upright.cost[row + 1][Work::kFrom], kSide * sizeof(Real));
    }
    constexpr unsigned kPending[kSides] = {Work::kDown,
                                           Work::kUp,
                                           Work::kLeft,
                                           Work::kRight,
                                           Work::kDown | Work::kLeft,
                                           Work::kDown | Work::kRight,
                                           Work::kUp | Work::kLeft,
                                           Work::kUp | Work::kRight};
    for (int k = 0; k < kSides; ++k) tell(around[k], gains[k], kPending[k], order);
  }

  // A square's cells and those around it, upright, and of the turned plane the frame alone.
  static void frame(const Square &own, const Square *const *beside, Real (Square::*part)[kCells],
                    typename Work::Rows &upright, typename Work::Rows &turned) {
    constexpr int kFirst = Work::kFrom, kBeyond = Work::kFrom + kSide, kTop = kSide + 1;
    constexpr std::size_t kRow = kSide * sizeof(Real), kLastRow = kCells - kSide;
    const auto at = [&](Side side) -> const Real * { return beside[side]->*part; };
    for (int row = 0; row < kSide; ++row) std::memcpy(&upright[row + 1][kFirst], own.*part + kSide * row, kRow);
    std::memcpy(&upright[0][kFirst], at(kSouth) + kLastRow, kRow);
    std::memcpy(&upright[kTop][kFirst], at(kNorth), kRow);
    for (int k = 0; k < kSide; ++k) {
      upright[k + 1][kFirst - 1] = turned[0][kFirst + k] = at(kWest)[kSide * k + kSide - 1];
      upright[k + 1][kBeyond] = turned[kTop][kFirst + k] = at(kEast)[kSide * k];
      turned[k + 1][kFirst - 1] = at(kSouth)[kLastRow + static_cast<std::size_t>(k)];
      turned[k + 1][kBeyond] = at(kNorth)[k];
    }
    upright[0][kFirst - 1] = turned[0][kFirst - 1] = at(kSouthWest)[kCells - 1];
    upright[0][kBeyond] = turned[kTop][kFirst - 1] = at(kSouthEast)[kLastRow];
    upright[kTop][kFirst - 1] = turned[0][kBeyond] = at(kNorthWest)[kSide - 1];
    upright[kTop][kBeyond] = turned[kTop][kBeyond] = at(kNorthEast)[0];
  }

  template <bool kBetween, bool kWalls>
  __attribute__((noinline)) void run(unsigned pending, Real *gains) {
    work_.template settle<kBetween, kWalls>(pending);
    gains[kSouth] = work_.template gain<kBetween, kWalls, -1>(work_.upright);
    gains[kNorth] = work_.template gain<kBetween, kWalls, 1>(work_.upright);
    gains[kWest] = work_.template gain<kBetween, kWalls, -1>(work_.turned);
    gains[kEast] = work_.template gain<kBetween, kWalls, 1>(work_.turned);
    gains[kSouthWest] = work_.template corner_gain<kBetween>(-1, -1);
    gains[kSouthEast] = work_.template corner_gain<kBetween>(-1, 1);
    gains[kNorthWest] = work_.template corner_gain<kBetween>(1, -1);
    gains[kNorthEast] = work_.template corner_gain<kBetween>(1, 1);
  }

  ZeroedTable<Square> squares_;
  ZeroedTable<State> states_;
  Work work_{};
  std::uint32_t stamp_ = 0;
  bool between_ = true;
  std::vector<Entry> waiting_;  // a heap; those that wait no more are left in it
  std::vector<std::int64_t> held_;
  std::int64_t across_ = 0;
  std::uint64_t settled_ = 0;
};

}  // namespace trundle
