// The open list of a cost field: which tile is settled next.
//
// A tile is open while a settled neighbour offers one of its cells less than that has. The tile with the least offer
// comes first, as in Dijkstra's algorithm with a tile for a cell. Several threads may have a tile each, but never two
// that touch: a settled tile's edges are its neighbours' frames.
#pragma once

#include "field/tile.hpp"

#include <functional>
#include <queue>
#include <utility>

namespace trundle {

template <typename Number>
class TileQueue {
 public:
  TileQueue(std::int64_t tile_rows, std::int64_t tile_cols)
      : tile_rows_(tile_rows), tile_cols_(tile_cols), states_(static_cast<std::size_t>(tile_rows * tile_cols)) {}

  // A cost comes to a tile from one of its sides.
  void offer(std::int64_t tile, int side, Number cost) {
    State &state = states_[tile];
    state.offering |= static_cast<std::uint8_t>(1 << side);
    if (cost >= state.least_offer && state.least_offer != kFar) return;
    state.least_offer = cost;
    open_.push({cost, tile});
  }

  // The tile of the least offer none of whose neighbours is busy, or −1. It is busy then.
  std::int64_t take() {
    std::int64_t found = -1;
    while (!open_.empty() && found < 0) {
      const Entry first = open_.top();
      open_.pop();
      const auto &[cost, tile] = first;
      if (states_[tile].least_offer != cost) continue;  // it was taken since, or has a lower offer
      if (busy_ > 0 && is_beside_busy(tile)) {
        set_aside_.push_back(first);
      } else {
        found = tile;
      }
    }
    for (const Entry &entry : set_aside_) open_.push(entry);
    set_aside_.clear();
    if (found < 0) return found;
    ++busy_;
    states_[found].least_offer = kFar;
    states_[found].busy = true;
    return found;
  }

  // The sides from which something was offered to a busy tile since it was taken before, a bit for each.
  std::uint32_t take_offering(std::int64_t tile) { return std::exchange(states_[tile].offering, std::uint8_t{0}); }

  // A busy tile is settled, and offers costs to its neighbours.
  void settle(std::int64_t tile, const Number (&offers)[kSides]) {
    --busy_;
    states_[tile].busy = false;
    states_[tile].settled = true;
    for (int side = 0; side < kSides; ++side) {
      if (offers[side] < kFar) {
        offer(tile + kSideRow[side] * tile_cols_ + kSideCol[side], opposite(side), offers[side]);
      }
    }
  }

  bool any_busy() const { return busy_ > 0; }
  bool is_settled(std::int64_t tile) const { return states_[tile].settled; }

  // The tile on a side of another, or −1.
  std::int64_t neighbour(std::int64_t tile, int side) const {
    const std::int64_t row = tile / tile_cols_ + kSideRow[side], col = tile % tile_cols_ + kSideCol[side];
    return row >= 0 && row < tile_rows_ && col >= 0 && col < tile_cols_ ? row * tile_cols_ + col : -1;
  }

 private:
  static constexpr Number kFar = Scale<Number>::kFar;

  struct State {
    Number least_offer = kFar;  // kFar where the tile is not open
    std::uint8_t offering = 0;
    bool busy = false, settled = false;
  };

  using Entry = std::pair<Number, std::int64_t>;

  bool is_beside_busy(std::int64_t tile) const {
    for (int side = 0; side < kSides; ++side) {
      const std::int64_t other = neighbour(tile, side);
      if (other >= 0 && states_[other].busy) return true;
    }
    return states_[tile].busy;
  }

  const std::int64_t tile_rows_, tile_cols_;
  std::vector<State> states_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> open_;  // with stale entries
  std::vector<Entry> set_aside_;
  int busy_ = 0;
};

}  // namespace trundle
