// Which tile of a cost field has its turn next.
//
// Each tile that could gain by a settled neighbour waits, and the one that gains the least cost comes first, as in
// Dijkstra's algorithm but with a tile for a cell. Tiles that touch have no turn at the same time.
#pragma once

#include "field/tile.hpp"

#include <functional>
#include <queue>
#include <utility>

namespace trundle {

template <typename Number>
class Turns {
 public:
  Turns(std::int64_t tile_rows, std::int64_t tile_cols)
      : tile_rows_(tile_rows), tile_cols_(tile_cols), states_(static_cast<std::size_t>(tile_rows * tile_cols)) {}

  // A side of a tile brings a cost.
  void wait(std::int64_t tile, int side, Number cost) {
    State &state = states_[tile];
    state.told |= static_cast<std::uint8_t>(1 << side);
    if (cost >= state.waiting && state.waiting != kFar) return;
    state.waiting = cost;
    queue_.push({cost, tile});
  }

  // The next tile whose neighbours are all at rest, or −1. It is busy then.
  std::int64_t take() {
    std::int64_t found = -1;
    while (!queue_.empty() && found < 0) {
      const Waiting first = queue_.top();
      queue_.pop();
      if (states_[first.second].waiting != first.first) continue;  // it had its turn since, or waits for less
      if (busy_ > 0 && beside_busy(first.second)) {
        held_.push_back(first);
      } else {
        found = first.second;
      }
    }
    for (const Waiting &one : held_) queue_.push(one);
    held_.clear();
    if (found < 0) return found;
    ++busy_;
    states_[found].waiting = kFar;
    states_[found].busy = true;
    return found;
  }

  // Which sides brought a busy tile something since its last turn, a bit for each.
  std::uint32_t told(std::int64_t tile) { return std::exchange(states_[tile].told, std::uint8_t{0}); }

  // The turn of a tile is over, and its neighbours gain by it.
  void end(std::int64_t tile, const Number (&gain)[kSides]) {
    --busy_;
    states_[tile].busy = false;
    states_[tile].settled = true;
    for (int side = 0; side < kSides; ++side) {
      if (gain[side] < kFar) wait(tile + kSideRow[side] * tile_cols_ + kSideCol[side], opposite(side), gain[side]);
    }
  }

  bool any_busy() const { return busy_ > 0; }
  bool settled(std::int64_t tile) const { return states_[tile].settled; }

  // The tile on a side of another, or −1.
  std::int64_t beside(std::int64_t tile, int side) const {
    const std::int64_t row = tile / tile_cols_ + kSideRow[side], col = tile % tile_cols_ + kSideCol[side];
    return row >= 0 && row < tile_rows_ && col >= 0 && col < tile_cols_ ? row * tile_cols_ + col : -1;
  }

 private:
  static constexpr Number kFar = Scale<Number>::kFar;

  struct State {
    Number waiting = kFar;  // the least cost that a neighbour brings; kFar where none waits
    std::uint8_t told = 0;
    bool busy = false, settled = false;
  };

  using Waiting = std::pair<Number, std::int64_t>;

  bool beside_busy(std::int64_t tile) const {
    for (int side = 0; side < kSides; ++side) {
      const std::int64_t other = beside(tile, side);
      if (other >= 0 && states_[other].busy) return true;
    }
    return states_[tile].busy;
  }

  const std::int64_t tile_rows_, tile_cols_;
  std::vector<State> states_;
  std::priority_queue<Waiting, std::vector<Waiting>, std::greater<Waiting>> queue_;
  std::vector<Waiting> held_;
  int busy_ = 0;
};

}  // namespace trundle
